"""A real hub with one instructor and two students, prepared and run as ``make hub`` does."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
import os
from pathlib import Path
import shutil
import signal
import socket
import subprocess
import sys
from typing import Any

import nbformat
from nbformat.v4 import new_code_cell, new_notebook
import psutil

from deploy.hub.prepare import home_of
from deploy.hub.settings import read, Settings
from deploy.routes import first_of_three_free_ports
from environment.install_files import KERNEL_NAME, KERNEL_TITLE

ROOT = Path(__file__).resolve().parents[2]
PICTURES = ROOT / 'docs' / 'pictures'
WINDOW = {'width': 1360, 'height': 900}
TEACHER, ANN, BOB = 'hubtest_teacher', 'hubtest_ann', 'hubtest_bob'
PREPARED_S, STOPPED_S, PAGE_MS = 1200.0, 90.0, 120_000


@dataclass
class Hub:
    """
    A running hub.

    :param settings: the hub's settings
    :param browser: a Chromium
    """

    settings: Settings
    browser: Any

    @property
    def address(self) -> str:
        """The address of the hub, with a slash at its end."""
        return f'http://127.0.0.1:{self.settings.port}/'

    def log_in(self, user: str, password: str = '') -> Any:
        """Type a name and a password, and return the page that follows."""
        page = self.browser.new_context(viewport=WINDOW).new_page()
        page.set_default_timeout(PAGE_MS)
        page.goto(self.address)
        page.fill('#username_input', user)
        page.fill('#password_input', password or f'the password of {user}')
        page.click('#login_submit')
        return page

    def lab_of(self, user: str) -> Any:
        """Log a user in, and return the page with this user's JupyterLab."""
        page = self.log_in(user)
        page.locator('.jp-NotebookPanel:visible').wait_for()
        return page


def take_picture(page: Any, name: str, height: int) -> None:
    """Write a screenshot of the top of a page for the documentation; its height is in pixels."""
    clip = {'x': 0, 'y': 0, 'width': WINDOW['width'], 'height': height}
    page.screenshot(path=PICTURES / f'{name}.png', clip=clip)


def wait_for_kernel(page: Any) -> None:
    """Wait until the kernel of the open notebook has started."""
    page.locator('#jp-main-statusbar', has_text='ROS 2 Jazzy | Idle').wait_for()


def open_notebook(hub: Hub, page: Any, user: str, path: str) -> None:
    """Open a notebook in a workspace without the previous notebook."""
    page.goto(f'{hub.address}user/{user}/lab/workspaces/another/tree/{path}?reset')
    page.locator('.jp-NotebookPanel').wait_for()
    wait_for_kernel(page)


def open_cells(hub: Hub, page: Any, user: str, *cells: str) -> None:
    """Write a notebook into a user's course folder, and open it."""
    work = home_of(user) / 'course' / 'live.ipynb'
    kernel = {'kernelspec': {'name': KERNEL_NAME, 'display_name': KERNEL_TITLE}}
    written = [new_code_cell(one) for one in cells]
    work.write_text(nbformat.writes(new_notebook(cells=written, metadata=kernel)))
    shutil.chown(work, user, user)
    open_notebook(hub, page, user, work.name)


def run_cell(page: Any, number: int, expected: str) -> None:
    """Run a cell of the open notebook, and wait for its output."""
    cell = page.locator('.jp-CodeCell').nth(number)
    cell.locator('.cm-content').click()
    page.keyboard.press('Shift+Enter')
    cell.locator('.jp-OutputArea-output', has_text=expected).wait_for()


def kernels_of(user: str) -> list[str]:
    """Return the process ids of a user's kernels."""
    found = as_user(user, 'pgrep', '--euid', user, '--full', 'ipykernel_launcher')
    return found.stdout.split()


def as_user(user: str, *command: str | Path, typed: str = '') -> subprocess.CompletedProcess[str]:
    """Run a command as a user, in the user's home folder and with the given input."""
    home = home_of(user)
    words = ['runuser', '-u', user, '--', 'env', f'HOME={home}', *map(str, command)]
    return subprocess.run(
        words, input=typed, capture_output=True, text=True, cwd=home, timeout=120
    )


@contextmanager
def running(folder: Path, idle_minutes: float) -> Iterator[Settings]:
    """Prepare a hub in a folder, run it, stop it like Ctrl-C, and assert that nothing is left."""
    _remove_work(folder)
    file = folder / 'hub.toml'
    file.write_text(
        f"folder = '{folder}'\nport = {first_of_three_free_ports()}\ninstructor = '{TEACHER}'\n"
        f"students = ['{ANN}', '{BOB}']\nmemory_mib = 3000\nidle_minutes = {idle_minutes}\n"
    )
    environ = {**os.environ, 'HUB': str(file)}
    command = [sys.executable, '-m', 'deploy.hub']
    subprocess.run([*command, 'prepare'], cwd=ROOT, env=environ, check=True, timeout=PREPARED_S)
    hub = subprocess.Popen(command, cwd=ROOT, env=environ, text=True, stdout=subprocess.PIPE)
    settings = read(file)
    try:
        _wait_until_it_answers(settings, hub)
        yield settings
    finally:
        hub.send_signal(signal.SIGINT)
        assert hub.wait(STOPPED_S) == 0
        if hub.stdout:
            hub.stdout.close()
    left = [one for one in psutil.process_iter() if one.username() in (TEACHER, ANN, BOB)]
    # A kernel ends by itself when its server is gone.
    assert psutil.wait_procs(left, timeout=STOPPED_S)[1] == []
    with socket.socket() as probe:
        assert probe.connect_ex(('127.0.0.1', settings.port)) != 0, 'the proxy is still running'


def _remove_work(folder: Path) -> None:
    """Remove what an earlier run in a kept folder left: deliveries, grades, open notebooks."""
    places = [folder / 'exchange']
    with suppress(KeyError):  # a new folder has no accounts yet
        places += [home_of(user) / 'course' for user in (ANN, BOB)]
        places += [home_of(ANN) / '.local' / 'share' / 'jupyter' / 'nbgrader_cache']
        places += [home_of(TEACHER) / 'course' / 'autograder' / '_work']
        places += [home_of(user) / '.jupyter' for user in (ANN, BOB, TEACHER)]
    for place in places:
        shutil.rmtree(place, ignore_errors=True)


def _wait_until_it_answers(settings: Settings, hub: subprocess.Popen[str]) -> None:
    if not any('Ctrl-C' in line for line in hub.stdout or ()):
        raise AssertionError((settings.run / 'hub.log').read_text()[-3000:])

"""
A course in a temporary folder, a JupyterLab server that serves it, and a headless Chromium.

Only the fixtures import Playwright, so that the other tests can be collected without it.
"""

from collections.abc import Iterator
from contextlib import contextmanager, ExitStack
from dataclasses import dataclass
import json
import os
from pathlib import Path
import re
import secrets
import shutil
import socket
import subprocess
import sys
import time
from typing import Any
from urllib.request import Request, urlopen

import pytest

from environment import install_files
from environment.places import Places
from tests.own_domain import own_domain

ROOT = Path(__file__).resolve().parents[2]
ASSIGNMENT = '07_temperature_monitor'
BROWSERS = ('chromium', 'chromium-browser', 'google-chrome')
# Without the network options, Chromium looks up Google's hosts at every start.
ARGUMENTS = (
    *('--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run'),
    *('--disable-background-networking', '--disable-component-update', '--disable-sync'),
)
FIRST_PAGE = re.compile(r'--LabApp\.default_url=\S+')
"""The option with which `make lab` chooses the page that JupyterLab opens."""
UNDER_TEST = 'PYTEST_CURRENT_TEST'
START_S = 60.0
POLL_S = 0.1


@dataclass(frozen=True)
class Lab:
    """
    A running JupyterLab.

    :param address: address of the server, with a slash at its end
    :param token: needed once; after that, a cookie identifies the browser
    :param course: the folder that JupyterLab serves
    :param log: file with its terminal output
    """

    address: str
    token: str
    course: Path
    log: Path

    def url(self, path: str = '') -> str:
        """Return the address at which JupyterLab opens only one file of the course."""
        return f'{self.address}lab/{f"tree/{path}" if path else ""}?token={self.token}&reset'


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo) -> Iterator[None]:
    """Take a last screenshot of a failed test, and report where its screenshots are."""
    report = yield
    used: dict[str, Any] = getattr(item, 'funcargs', {})
    if call.when == 'call' and report.failed and 'page' in used:
        used['page'].screenshot(path=used['shots'] / 'failed.png')
        report.sections.append(('Screenshots', str(used['shots'])))
    return report


@pytest.fixture
def shots(tmp_path: Path) -> Path:
    """Return the folder for screenshots; pytest keeps those of the last three runs."""
    folder = tmp_path / 'shots'
    folder.mkdir()
    return folder


@pytest.fixture(scope='session')
def course(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an instructor's course without submissions, with the solved lesson."""
    root = tmp_path_factory.mktemp('lab') / 'course'
    for folder in ('solutions', 'notebooks'):
        shutil.copytree(
            ROOT / folder,
            root / folder,
            ignore=shutil.ignore_patterns('ros_ws', '.ipynb_checkpoints'),
        )
    for name in ('course.toml', 'nbgrader_config.py'):
        shutil.copy(ROOT / name, root)
    shutil.copytree(root / 'solutions' / ASSIGNMENT, root / 'lesson')
    from autograder.gradebook.record import enter_assignment
    from autograder.layout import Layout

    (root / 'exams').symlink_to(ROOT / 'exams')
    (root / 'autograder' / '_work').mkdir(parents=True)
    enter_assignment(Layout(root), ASSIGNMENT)  # same result as a release, in half the time
    return root


@pytest.fixture(scope='session')
def lab(course: Path) -> Iterator[Lab]:
    """Return a JupyterLab without the user's own settings and open files."""
    with _running(course, course.parent) as running:
        yield running


@pytest.fixture
def own_kernels(lab: Lab) -> Iterator[None]:
    """End the kernels after each test, so that later pictures do not show their nodes."""
    yield
    token = {'Authorization': f'token {lab.token}'}
    with urlopen(Request(f'{lab.address}api/sessions', headers=token)) as answer:
        sessions = json.load(answer)
    for session in sessions:
        address = f'{lab.address}api/sessions/{session["id"]}'
        urlopen(Request(address, headers=token, method='DELETE')).close()


@pytest.fixture
def students_lab(course: Path, tmp_path: Path) -> Iterator[Lab]:
    """Return a JupyterLab with the settings of a students' copy."""
    places = Places.of('.venv', tmp_path)
    install_files.write_jupyter_settings(places)
    install_files.write_terminal(places)
    with _running(course, tmp_path, places.venv / 'etc' / 'jupyter') as running:
        yield running


@pytest.fixture
def gradual_lab(course: Path, tmp_path: Path) -> Iterator[Lab]:
    """Return a JupyterLab that draws the cells of a notebook one after another, its default."""
    with _running(course, tmp_path, at_once=False) as running:
        yield running


@contextmanager
def _running(
    course: Path, home: Path, config: Path | None = None, at_once: bool = True
) -> Iterator[Lab]:
    """
    Run a JupyterLab.

    :param home: folder for the files that JupyterLab keeps
    :param config: a folder with settings that override those of the environment
    :param at_once: draw all cells of a notebook when it opens
    """
    settings = home / 'settings' / '@jupyterlab' / 'notebook-extension'
    settings.mkdir(parents=True)
    if at_once:
        (settings / 'tracker.jupyterlab-settings').write_text('{"windowingMode": "none"}')
    # The style of this version; the environment may contain that of an earlier set-up.
    style = home / '.jupyter' / 'custom' / 'custom.css'
    style.parent.mkdir(parents=True)
    style.write_text(install_files.STYLE)
    # If UNDER_TEST is set, ipykernel does not capture the output of C code, such as log lines.
    inherited = {name: text for name, text in os.environ.items() if name != UNDER_TEST}
    if config is not None:
        inherited['JUPYTER_CONFIG_PATH'] = str(config)
    token = secrets.token_hex(8)
    log = home / 'jupyterlab.log'
    until = ExitStack()
    with log.open('w') as file:
        server = subprocess.Popen(
            [
                *(sys.executable, '-m', 'jupyterlab', '--no-browser', '--allow-root'),
                *(f'--ServerApp.root_dir={course}', '--ServerApp.ip=127.0.0.1'),
                *(f'--ServerApp.port={_free_port()}', f'--IdentityProvider.token={token}'),
                '--MultiKernelManager.default_kernel_name=ros2_jazzy',
                FIRST_PAGE.search((ROOT / 'Makefile').read_text(encoding='utf-8'))[0],
            ],
            cwd=course,
            env={
                **inherited,
                'HOME': str(home),
                'JUPYTER_RUNTIME_DIR': str(home / 'runtime'),
                'JUPYTERLAB_SETTINGS_DIR': str(home / 'settings'),
                # Messages of other kernels on this machine must not arrive.
                'ROS_DOMAIN_ID': str(own_domain(until)),
            },
            stdin=subprocess.DEVNULL,
            stdout=file,
            stderr=subprocess.STDOUT,
        )
    try:
        yield Lab(_address(server, home / 'runtime', log), token, course, log)
    finally:
        server.terminate()  # ends its kernels too
        try:
            server.wait(20)
        except subprocess.TimeoutExpired:
            server.kill()
            server.wait()
        until.close()


def _free_port() -> int:
    """Return a port that is free now; if it is taken meanwhile, Jupyter tries others."""
    with socket.socket() as probe:
        probe.bind(('127.0.0.1', 0))
        return probe.getsockname()[1]


def _address(server: subprocess.Popen, runtime: Path, log: Path) -> str:
    """Wait until the server answers, and return the address that it has chosen."""
    deadline = time.monotonic() + START_S
    while time.monotonic() < deadline and server.poll() is None:
        for described in runtime.glob('jpserver-*.json'):
            try:
                address = json.loads(described.read_text())['url']
                with urlopen(f'{address}api'):
                    return address
            except (OSError, ValueError):
                pass  # file incomplete, or server not listening yet
        time.sleep(POLL_S)
    raise AssertionError(f'JupyterLab did not start:\n{log.read_text()[-3000:]}')


@pytest.fixture(scope='session')
def browser() -> Iterator[Any]:
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    assert found, f'No browser ({", ".join(BROWSERS)}). Try: sudo apt-get install -y chromium'
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=found, args=list(ARGUMENTS))
        yield running
        running.close()


@pytest.fixture
def page(browser: Any, shots: Path) -> Iterator[Any]:
    """Return an empty page; exceptions of its scripts are in ``page.errors``."""
    context = browser.new_context(viewport={'width': 1360, 'height': 900})
    opened = context.new_page()
    opened.errors = []
    opened.on('pageerror', lambda error: opened.errors.append(str(error)))
    yield opened
    context.close()

"""The settings of a hub, and the files that give each kernel a separate ROS world."""

import asyncio
import json
import os
from pathlib import Path
import re
import runpy
import subprocess
import sys
from types import ModuleType, SimpleNamespace

import pytest
from traitlets.config import Config

from deploy.hub import memory, prepare, worlds
from deploy.hub.__main__ import forget_ended_proxy
from deploy.hub.settings import HERE, read, SETTING, SettingsError
from environment.install_files import KERNEL_MESSAGES

ROOT = Path(__file__).resolve().parents[2]
NOBODY = 65534
GOOD = {
    'folder': "'/srv/hub'",
    'port': '8000',
    'instructor': "'ann'",
    'students': "['bob', 'cem']",
}


def written(where: Path, **changed: str | None) -> Path:
    """Write a settings file in which some lines are changed, or left out if None."""
    lines = {**GOOD, **changed}
    file = where / 'hub.toml'
    file.write_text(''.join(f'{name} = {value}\n' for name, value in lines.items() if value))
    return file


def test_the_settings_of_the_course_can_be_read() -> None:
    """The file that `make hub` uses is complete."""
    settings = read(HERE / 'hub.toml')
    assert settings.users == (settings.instructor, *settings.students)


@pytest.mark.parametrize(
    ('changed', 'said'),
    [
        ({'folder': "'hub'"}, 'an absolute path'),
        ({'port': '80'}, 'from 1024 to'),
        ({'port': "'8000'"}, 'from 1024 to'),
        ({'students': "['bob', 'ann']"}, 'listed twice'),
        ({'students': "['bob; reboot']"}, 'not a system user name: bob; reboot'),
        ({'login': "'dummy'"}, 'first_use, pam'),
        ({'memory_mib': '100'}, 'at least 512'),
        ({'idle_minutes': '0.4'}, 'at least 0.5'),
        ({'instructor': None}, 'missing: instructor'),
        ({'color': "'red'"}, 'unknown: color'),
        ({'folder': "'/srv"}, 'hub.toml:'),
    ],
)
def test_a_value_that_cannot_be_used_is_named(
    tmp_path: Path, changed: dict[str, str | None], said: str
) -> None:
    with pytest.raises(SettingsError, match=said):
        read(written(tmp_path, **changed))


@pytest.mark.skipif(os.geteuid() != 0, reason='only root can read as another user')
def test_root_clones_the_repository_of_the_user_who_typed_sudo(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Git trusts no other user's repository, and ``make hub`` clones the project as root."""
    theirs = tmp_path / 'theirs'
    subprocess.run(['git', 'init', '--quiet', theirs], check=True)
    for path in (theirs, theirs / '.git'):
        os.chown(path, NOBODY, NOBODY)
    clone = ('git', 'clone', '--quiet', theirs, tmp_path / 'clone')
    monkeypatch.delenv('SUDO_UID', raising=False)
    with pytest.raises(prepare.HubError, match='dubious ownership'):
        prepare.run(*clone)

    monkeypatch.setenv('SUDO_UID', str(NOBODY))
    prepare.run(*clone)
    assert (tmp_path / 'clone' / '.git').is_dir()


def test_the_trial_of_a_world_reads_no_file_of_the_project(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A user may not be able to read the project, for example below /root."""
    commands: list[list[str]] = []

    def run(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        commands.append(command)
        return subprocess.CompletedProcess(command, 0, '', '')

    monkeypatch.setattr(worlds.subprocess, 'run', run)
    assert worlds.namespace_refusal('bob') == ''
    assert not any(str(HERE) in word for word in commands[0])


def test_the_set_up_reports_a_system_without_namespaces(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """On such a system, kernels share the network of the machine."""
    found: list[bool] = []

    def prepared(*_: str, cwd: Path) -> None:
        (cwd / '.venv' / 'etc' / 'jupyter').mkdir(parents=True)

    def refuse(command: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        return subprocess.CompletedProcess(command, 1, '', 'unshare: not permitted\n')

    monkeypatch.setattr(prepare, 'run', prepared)
    monkeypatch.setattr(prepare, '_add_server', lambda venv: None)
    monkeypatch.setattr(worlds, 'install', lambda venv, *, separate: found.append(separate))
    monkeypatch.setattr(worlds.subprocess, 'run', refuse)
    prepare._students_copy(read(written(tmp_path, folder=f"'{tmp_path}'")))
    assert found == [False]
    assert worlds.FALLBACK.format(reason='unshare: not permitted') in capsys.readouterr().out


def test_the_log_reports_a_system_without_memory_limits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The hub starts the server anyway; a stub replaces its package here."""

    class LocalProcessSpawner:
        async def start(self) -> tuple[str, int]:
            return '127.0.0.1', 8001

    hub, spawner = ModuleType('jupyterhub'), ModuleType('jupyterhub.spawner')
    vars(spawner)['LocalProcessSpawner'] = LocalProcessSpawner
    monkeypatch.setitem(sys.modules, 'jupyterhub', hub)
    monkeypatch.setitem(sys.modules, 'jupyterhub.spawner', spawner)
    monkeypatch.setenv(SETTING, str(written(tmp_path, memory_mib='512')))
    monkeypatch.setattr(memory, 'HIERARCHIES', ())
    names = runpy.run_path(str(HERE / 'jupyterhub_config.py'), {'get_config': Config})
    server, said = names['CourseSpawner'](), []
    server.user, server.pid = SimpleNamespace(name='bob'), os.getpid()
    server.log = SimpleNamespace(warning=said.append)
    assert asyncio.run(server.start()) == ('127.0.0.1', 8001)
    assert said == ['No memory limit: this system offers no control group for it.']


def test_a_kernel_starts_in_its_own_world_while_the_system_allows_it(tmp_path: Path) -> None:
    """The script precedes the kernel's command only once, and the server uses Unix sockets."""
    kernel = tmp_path / 'share' / 'jupyter' / 'kernels' / 'ros2_jazzy' / 'kernel.json'
    config = tmp_path / 'etc' / 'jupyter' / 'jupyter_server_config.json'
    script = tmp_path / 'bin' / worlds.SCRIPT
    command = ['python', '-m', 'kernel']
    for path, content in ((kernel, {'argv': command}), (config, {'A': 1})):
        path.parent.mkdir(parents=True)
        path.write_text(json.dumps(content))
    script.parent.mkdir()
    for separate, argv, messages in (
        (True, [str(script), *command], {'transport': 'ipc'}),
        (True, [str(script), *command], {'transport': 'ipc'}),  # a second start of the hub
        (False, command, KERNEL_MESSAGES),
    ):
        worlds.install(tmp_path, separate=separate)
        assert json.loads(kernel.read_text())['argv'] == argv
        assert json.loads(config.read_text()) == {'A': 1, 'KernelManager': messages}
    assert script.stat().st_mode & 0o111


def test_a_kernel_reached_by_tcp_keeps_the_network_of_the_machine(tmp_path: Path) -> None:
    """A command that starts its own kernel could not reach a kernel in a separate network."""
    connection = tmp_path / 'kernel.json'
    connection.write_text(json.dumps({'transport': 'tcp'}, indent=2))
    look = ['sh', '-c', 'readlink /proc/self/ns/net', 'sh', str(connection)]
    direct, through = (
        subprocess.run(command, capture_output=True, text=True, check=True).stdout
        for command in (look, ['sh', str(HERE / worlds.SCRIPT), *look])
    )
    assert direct == through


def test_only_the_pid_file_of_a_running_proxy_is_kept(tmp_path: Path) -> None:
    """After a power failure, the process id in the file may be that of a different process."""
    file = tmp_path / 'proxy.pid'
    waits = [sys.executable, '-c', 'print(flush=True); input()']
    pipe = subprocess.PIPE
    for command, kept in ((waits, False), ([*waits, 'configurable-http-proxy'], True)):
        with subprocess.Popen(command, stdin=pipe, stdout=pipe) as process:
            process.stdout.readline()  # the command line of the process can be read once it runs
            file.write_text(str(process.pid))
            forget_ended_proxy(file)
            assert file.exists() is kept
            process.communicate(b'\n')
    forget_ended_proxy(file)
    assert not file.exists()


def test_the_documentation_shows_the_screenshots_that_the_tests_of_the_hub_take() -> None:
    """Therefore, every screenshot comes from the last ``make test-hub``."""
    shown = {
        name
        for page in (ROOT / 'README.md', *(ROOT / 'docs').glob('*.md'))
        for name in re.findall(r'\]\((?:docs/)?pictures/(\w+)\.png\)', page.read_text('utf-8'))
    }
    tests = (ROOT / 'tests' / 'hub' / 'test_hub.py').read_text('utf-8')
    kept = {file.stem for file in (ROOT / 'docs' / 'pictures').iterdir()}
    assert kept == shown == set(re.findall(r"take_picture\(\w+, '(\w+)'", tests))

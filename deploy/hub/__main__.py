"""
``make hub``: prepare a JupyterHub for the course and run it until Ctrl-C.

    python -m deploy.hub           prepare and run
    python -m deploy.hub prepare   prepare only
    python -m deploy.hub update    update the students' copy while the hub runs
    python -m deploy.hub remove    remove the hub's folder; accounts and home folders are kept

The environment variable HUB names the settings file.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
import fcntl
import os
from pathlib import Path
import shutil
import signal
import subprocess
import sys
from urllib.request import urlopen

from deploy.hub.prepare import HubError, prepare, remove_old_copies, update
from deploy.hub.settings import HERE, read, SETTING, Settings, SettingsError
from environment.places import PROJECT

LOOK_S = 0.3
STOP_S = 60.0
"""Maximum time that the servers of all users may take to stop [s]."""


def main(arguments: Sequence[str]) -> int:
    """Run one command and return its exit code: 0, or 2 if something is wrong."""
    command = arguments[0] if arguments else 'run'
    if command not in ('run', 'prepare', 'update', 'remove'):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    path = Path(os.environ.get(SETTING) or HERE / 'hub.toml').resolve()
    try:
        settings = read(path)
        if command == 'remove':
            shutil.rmtree(settings.folder, ignore_errors=True)
            return 0
        if command == 'update':
            update(settings)
            return 0
        prepare(settings)
        if command == 'prepare':
            return 0
        with _lock_hub(settings):
            remove_old_copies(settings)
            forget_ended_proxy(settings.run / 'proxy.pid')
            return _run(settings, path)
    except (SettingsError, HubError) as error:
        print(f'hub: {error}', file=sys.stderr)
        return 2


@contextmanager
def _lock_hub(settings: Settings) -> Iterator[None]:
    """
    Hold the lock of a running hub: a second hub would end the proxy of the first.

    :raises HubError: if a hub in the same folder is already running
    """
    with (settings.run / 'lock').open('w') as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise HubError(
                f'{settings.folder}: this hub is already running. Try: stop it'
            ) from error
        yield


def forget_ended_proxy(pid_file: Path) -> None:
    """
    Remove the pid file of a proxy that no longer runs, for example after a power failure.

    JupyterHub would end the process with this pid, even if it is a different program by now.
    """
    with suppress(OSError):
        command = Path('/proc', pid_file.read_text().strip(), 'cmdline').read_bytes()
        if b'configurable-http-proxy' in command:
            return
    pid_file.unlink(missing_ok=True)


def _run(settings: Settings, path: Path) -> int:
    """Run the hub in the foreground; on a stop signal, also stop its servers and its proxy."""
    log = settings.run / 'hub.log'
    environ = {
        **os.environ,
        SETTING: str(path),
        'PATH': f'{settings.hub}/bin:/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin',
        'PYTHONPATH': str(PROJECT),
    }
    config = str(HERE / 'jupyterhub_config.py')
    command = [str(settings.hub / 'bin' / 'jupyterhub'), '-f', config]
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with log.open('a', encoding='utf-8') as file:
        hub = subprocess.Popen(
            command,
            cwd=settings.run,
            env=environ,
            stdout=file,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # Ctrl-C must not reach the hub: _stop() ends it
        )
    try:
        address = f'http://127.0.0.1:{settings.port}/'
        if _answers(hub, address):
            print(f'Open {address} and log in as {", ".join(settings.users)}.')
            if settings.login == 'first_use':
                print("The first password that a user types becomes this user's password.")
            print('Ctrl-C stops the hub, its proxy and all servers.', flush=True)
        code = hub.wait()
        print(f'hub: JupyterHub ended with code {code}. See {log}', file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print('Stopping the servers ...', flush=True)
        return _stop(hub)


def _answers(hub: subprocess.Popen[bytes], address: str) -> bool:
    """Wait until the hub answers; return False if it ends first."""
    while hub.poll() is None:
        try:
            with urlopen(f'{address}hub/login'):
                return True
        except OSError:  # the hub is not listening yet
            with suppress(subprocess.TimeoutExpired):
                hub.wait(LOOK_S)
    return False


def _stop(hub: subprocess.Popen[bytes]) -> int:
    """Wait until the hub has stopped its servers and its proxy."""
    hub.terminate()
    try:
        hub.wait(STOP_S)
    except subprocess.TimeoutExpired:
        os.killpg(hub.pid, signal.SIGKILL)
        hub.wait()
        return 2
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))

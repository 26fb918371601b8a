"""Install a hub: accounts, JupyterHub, its proxy, the students' copy, the instructor's clone."""

from collections.abc import Callable, Mapping
import json
import os
from pathlib import Path
import pwd
import shutil
import subprocess
import sys
import tempfile
import zipfile

from autograder.authoring.student_bundle import pack, TOP
from autograder.layout import Layout, lesson_files
from deploy.hub import worlds
from deploy.hub.settings import HERE, Settings
from environment.exchange import ROOT_MODE
from environment.places import PROJECT, stated, write_atomically
from environment.stamps import digest_of, digest_of_files, files_below

COPY = 'students-'
PASSED_ON = ('PIP_', 'NODE_EXTRA_CA_CERTS', 'SUDO_UID')
"""
Prefixes of the environment variables to pass on: settings of pip and npm, such as a proxy's
certificates, and the user who ran sudo, so that git run by root accepts this user's clone.
"""
SERVER_SETTINGS = 'jupyter_server_config.py'
COURSE_SETTINGS = """\
# Written by the hub's set-up, for the students' servers.
c = get_config()
c.CourseDirectory.course_id = {course!r}
c.Exchange.root = {exchange!r}
"""


class HubError(Exception):
    """Raised when a step of the installation fails; the message contains advice."""


def prepare(settings: Settings) -> None:
    """
    Carry out all steps that are not complete yet; if all are, this takes seconds.

    :raises HubError: if a step fails
    """
    _require_system()
    steps: tuple[tuple[str, Callable[[Settings], None]], ...] = (
        ('accounts', _accounts),
        ('JupyterHub and its proxy', _hub),
        ("students' copy", _students_copy),
        ("instructor's clone", _instructors_clone),
        ('exchange', _exchange),
    )
    os.umask(0o022)  # all users must be able to read the installed files
    for number, (title, step) in enumerate(steps, 1):
        print(f'[{number}/{len(steps)}] {title} ...', flush=True)
        step(settings)


def update(settings: Settings) -> None:
    """
    Update the students' copy while the hub runs; servers that start afterwards use it.

    :raises HubError: if a step fails
    """
    _require_system()
    if not settings.graded.is_file():
        raise HubError(f'{settings.folder}: no hub is installed here. Try: make hub')
    os.umask(0o022)
    _students_copy(settings)


def remove_old_copies(settings: Settings) -> None:
    """Remove students' copies except the current one; call this only while no server runs."""
    for path in settings.folder.glob(f'{COPY}*'):
        if path != settings.copy.resolve():
            shutil.rmtree(path, ignore_errors=True)


def home_of(user: str) -> Path:
    """Return a user's home folder."""
    return Path(pwd.getpwnam(user).pw_dir)


def run(*command: str | Path, cwd: Path = Path('/'), user: str = '') -> None:
    """
    Run one command, as another user if ``user`` is given.

    :raises HubError: if the command fails, with the last lines of its output
    """
    env: Mapping[str, str] = {
        'PATH': '/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin',
        'LANG': 'C.UTF-8',
        'HOME': str(home_of(user)) if user else str(Path.home()),
        'CI': 'true',  # do not update a progress line in place
        **{name: value for name, value in os.environ.items() if name.startswith(PASSED_ON)},
    }
    words = [*(('runuser', '-u', user, '--') if user else ()), *map(str, command)]
    done = subprocess.run(
        words, cwd=cwd, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    if done.returncode:
        last = '\n'.join(done.stdout.strip().splitlines()[-12:])
        raise HubError(f'{" ".join(words)}: ended with code {done.returncode}\n{last}')


def _require_system() -> None:
    if sys.version_info < (3, 11):
        raise HubError('JupyterHub needs Python 3.11 to 3.13. Try: make PYTHON=python3.11 hub')
    if os.geteuid() != 0:
        raise HubError('A hub starts servers for several users and needs root. Try: sudo make hub')
    needed = {'npm': 'npm', 'runuser': 'util-linux', 'useradd': 'passwd', 'pgrep': 'procps'}
    needed |= {'unshare': 'util-linux', 'ip': 'iproute2', 'git': 'git'}
    lacking = sorted({package for name, package in needed.items() if not shutil.which(name)})
    if lacking:
        raise HubError(f'Programs are missing. Try: apt-get install -y {" ".join(lacking)}')


def _accounts(settings: Settings) -> None:
    """Create accounts without a password, and make each home private to its owner."""
    for user in settings.users:
        try:
            pwd.getpwnam(user)
        except KeyError:
            run('useradd', '--create-home', '--shell', '/bin/bash', user)
        home_of(user).chmod(0o700)


def _hub(settings: Settings) -> None:
    settings.run.mkdir(parents=True, exist_ok=True)
    settings.run.chmod(0o700)
    wanted = (HERE / 'requirements.txt').read_text(encoding='utf-8')
    stamp = settings.hub / 'requirements.txt'
    if not stamp.is_file() or stamp.read_text(encoding='utf-8') != wanted:
        run(sys.executable, '-m', 'venv', '--clear', settings.hub)
        pip = (settings.hub / 'bin' / 'python', '-m', 'pip', 'install', '--quiet', '--no-deps')
        run(*pip, '-r', HERE / 'requirements.txt')
        write_atomically(stamp, wanted)
    settings.proxy.mkdir(exist_ok=True)
    for name in ('package.json', 'package-lock.json'):
        shutil.copyfile(HERE / name, settings.proxy / name)
    if not (settings.proxy / 'node_modules' / 'configurable-http-proxy').is_dir():
        run('npm', 'ci', '--omit=dev', '--no-audit', '--no-fund', cwd=settings.proxy)


def _students_copy(settings: Settings) -> None:
    """
    Unpack the bundle, prepare it, and make it the copy that servers use from their next start on.

    Running kernels are not disturbed: if an input of the set-up has changed, the environment is
    prepared in a new folder; otherwise each file is replaced atomically.
    """
    if settings.copy.is_dir() and not settings.copy.is_symlink():
        raise HubError(f'{settings.copy} is from an earlier version. Try: stop its hub, remove it')
    layout = Layout(PROJECT)
    with tempfile.TemporaryDirectory(dir=settings.folder) as scratch:
        bundle = Path(scratch) / 'bundle.zip'
        pack(layout, bundle)
        with zipfile.ZipFile(bundle) as archive:
            archive.extractall(scratch)
        unpacked = Path(scratch) / TOP
        copy = settings.folder / (COPY + _version_of(unpacked))
        _replace_files(unpacked, copy)
    run('make', 'prepare', cwd=copy)
    _add_server(copy / '.venv')
    course = COURSE_SETTINGS.format(course=layout.facts.name, exchange=str(settings.exchange))
    write_atomically(copy / '.venv' / 'etc' / 'jupyter' / 'nbgrader_config.py', course)
    if reason := _separate_networks(settings, copy / '.venv'):
        print(worlds.FALLBACK.format(reason=reason))
    graded = [path.parent.name for path in lesson_files(layout.notebooks) if _is_graded(path)]
    write_atomically(settings.graded, '\n'.join(graded) + '\n')
    link = settings.folder / 'students.new'
    link.unlink(missing_ok=True)
    link.symlink_to(copy.name)
    link.replace(settings.copy)


def _version_of(unpacked: Path) -> str:
    """Return a digest of what the set-up of a students' copy installs and builds."""
    parts = ('environment', 'autograder/clock', stated(PROJECT, 'package'))
    files = [path for part in parts if part for path in files_below(unpacked / part)]
    server = (HERE / 'requirements-server.txt').read_text(encoding='utf-8')
    return digest_of(server, digest_of_files(files, unpacked))[:12]


def _replace_files(unpacked: Path, copy: Path) -> None:
    copy.mkdir(exist_ok=True)
    for source in sorted(unpacked.rglob('*')):
        target = copy / source.relative_to(unpacked)
        if source.is_dir():
            target.mkdir(parents=True, exist_ok=True)
        elif not target.is_file() or target.read_bytes() != source.read_bytes():
            source.replace(target)  # atomically, because a kernel may be reading the file


def _is_graded(notebook: Path) -> bool:
    cells = json.loads(notebook.read_text(encoding='utf-8'))['cells']
    return any(cell['metadata'].get('nbgrader', {}).get('grade') for cell in cells)


def _instructors_clone(settings: Settings) -> None:
    user, clone = settings.instructor, settings.course_of(home_of(settings.instructor))
    if not clone.exists():
        run('git', 'clone', '--quiet', '--no-hardlinks', PROJECT, clone)
        _pull_from_origin(clone)
        run('chown', '-R', f'{user}:', clone)
    run('make', 'prepare', cwd=clone, user=user)
    _add_server(clone / '.venv', user)
    _separate_networks(settings, clone / '.venv')
    run('chown', '-R', f'{user}:', *(clone / '.venv' / name for name in ('etc', 'share', 'bin')))


def _pull_from_origin(clone: Path) -> None:
    """Let the instructor pull from the project's origin; only root may read this copy."""
    origin = ('git', '-C', PROJECT, 'remote', 'get-url', 'origin')
    if found := subprocess.run(origin, capture_output=True, text=True).stdout.strip():
        run('git', '-C', clone, 'remote', 'set-url', 'origin', found)


def _add_server(venv: Path, user: str = '') -> None:
    """Add the packages and settings that a hub's server needs; change no installed version."""
    pip = (venv / 'bin' / 'python', '-m', 'pip', 'install', '--quiet', '--no-deps')
    lines = (HERE / 'requirements-server.txt').read_text(encoding='utf-8').splitlines()
    # Do not pass the file: if this folder is in root's home, the user may not be able to read it.
    run(*pip, *(line for line in lines if not line.startswith('#')), user=user)
    shutil.copyfile(HERE / SERVER_SETTINGS, venv / 'etc' / 'jupyter' / SERVER_SETTINGS)


def _exchange(settings: Settings) -> None:
    settings.exchange.mkdir(exist_ok=True)
    settings.exchange.chmod(ROOT_MODE)
    shutil.chown(settings.exchange, settings.instructor)


def _separate_networks(settings: Settings, venv: Path) -> str:
    """Give each kernel of an environment its own network, or return why that is impossible."""
    reason = worlds.namespace_refusal(
        settings.students[0] if settings.students else settings.instructor
    )
    worlds.install(venv, separate=not reason)
    return reason

"""
Test every isolation mode with a hostile program and with honest ones.

To test the modes of a plain user, root first gives up its rights, in a mount namespace in which
every user can reach Python.
"""

import json
import os
from pathlib import Path
import select
import subprocess
import sys
import tempfile
import time

import pytest

from autograder.errors import SandboxUnavailable
from autograder.exam import catalog
from autograder.grading.examine import Engine
from autograder.inside.confine import family
from autograder.sandboxes import choose, isolation, landlock
from environment.ros import ros_environment

pytestmark = [pytest.mark.attacks, pytest.mark.ros]

ROOT = Path(__file__).resolve().parents[2]
AS_ROOT = os.geteuid() == 0
UID = '23456'
SLEEPER = b'86395'
# $1 is an empty folder, $2 a closed folder, and $3 the path below it that must be reachable.
OPENED = """
set -e
mount --bind "$3" "$1"
mount -t tmpfs -o mode=755 tmpfs "$2"
mkdir -p "$3"
mount --bind "$1" "$3"
shift 3
exec "$@"
"""


def prefix(mode: str, aside: Path) -> list[str]:
    """Return the prefix that makes a command run as the right user."""
    wanted = isolation.MODES[mode].root
    if not AS_ROOT:
        if wanted:
            pytest.skip(f'{mode} is only for root')
        return []
    argv = []
    for needed in ros_environment().read_only:
        if mode != 'bwrap-root' and (closed := landlock.closed_folder([needed])):
            aside.mkdir(exist_ok=True)
            argv += ['unshare', '-m', 'sh', '-c', OPENED, 'sh', str(aside), closed, needed]
            break
    if not wanted:
        argv += ['setpriv', '--reuid', UID, '--regid', UID, '--clear-groups']
    return argv


@pytest.fixture(scope='module')
def planted():
    """
    Return a folder that every user may access, but no graded program.

    The folder is not pytest's, because pytest closes its folders to other users.
    """
    with tempfile.TemporaryDirectory(prefix='secrets-') as base:
        Path(base).chmod(0o755)
        folder = Path(base, 'planted')
        folder.mkdir()
        folder.chmod(0o777)
        for name in ('gradebook.db', 'submission_of_another.ipynb'):
            (folder / name).write_text('CANARY', encoding='utf-8')
            (folder / name).chmod(0o666)
        yield folder


@pytest.fixture(scope='module', params=[name for name in isolation.MODES if name != 'none'])
def world(request, planted):
    """Return a mode and what happened in it."""
    if request.param.startswith('landlock'):
        refused, _ = landlock.refusal(root=request.param == 'landlock-uid')
        if refused:
            pytest.skip(refused)
    return request.param, run_world(request.param, planted), planted


def run_world(mode: str, folder: Path):
    done = subprocess.run(
        [*prefix(mode, folder.with_name(f'aside-{mode}')), sys.executable, '-B']
        + ['-m', 'tests.attacks.mode_world', mode, str(folder)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_a_hostile_program_reaches_nothing(world):
    """It reaches no file, memory, process or connection, and writes only to its own folder."""
    mode, seen, folder = world
    reached = [line for line in seen['hostile'] if 'REACHED' in line]
    known = ['signal REACHED'] if mode == 'landlock' and not kernel_scopes_signals() else []

    assert reached == known
    assert seen['hostile'][-1] == 'own write 1', seen['hostile']
    assert (folder / 'gradebook.db').read_text(encoding='utf-8') == 'CANARY'
    assert not (folder / 'mine').exists()


def kernel_scopes_signals() -> bool:
    """Return whether this kernel's Landlock can restrict signals."""
    from autograder.inside.confine import landlock_version

    return landlock_version() >= 6


def test_nothing_outlives_a_killed_grader(world):
    mode, _, folder = world
    with started(mode, folder, 'linger') as grader:
        assert grader.stdout.readline() == b'lingers\n'
        deadline = time.monotonic() + 60
        while not (found := sleeping()):  # it has been forked, and soon runs sleep
            assert time.monotonic() < deadline, 'there is no daemon'
        sleepers = [os.pidfd_open(pid) for pid in found]
        grader.kill()
    for pidfd in sleepers:
        assert select.select([pidfd], [], [], 60)[0], 'a process is still running'
        os.close(pidfd)


@pytest.mark.parametrize(('moment', 'processes'), [('held', 1), ('run', 3)])
@pytest.mark.parametrize('mode', isolation.MODES)
def test_no_process_of_a_run_outlives_a_killed_grader(mode, moment, processes, planted):
    """A program ends before its release, and with its probe and clock when time stands still."""
    if mode.startswith('landlock') and (refused := landlock.refusal(root=mode[8:] == '-uid')[0]):
        pytest.skip(refused)
    with started(mode, planted, moment) as grader:
        assert grader.stdout.readline() == b'up\n'
        found = [os.pidfd_open(pid) for pid in family(grader.pid) if pid != grader.pid]
        grader.kill()
    assert len(found) >= processes
    for pidfd in found:
        assert select.select([pidfd], [], [], 60)[0], 'a process is still running'
        os.close(pidfd)


def started(mode: str, folder: Path, what: str) -> subprocess.Popen[bytes]:
    """Start a grader that runs until it is killed."""
    argv = [*prefix(mode, folder.with_name(f'aside-{mode}')), sys.executable, '-B']
    argv += ['-m', 'tests.attacks.mode_world', mode, str(folder), what]
    return subprocess.Popen(argv, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE)


def test_nothing_outlives_the_run(world):
    assert sleeping() == []


def sleeping() -> list[int]:
    """Return the process ids of daemons of the hostile program."""
    found = []
    for folder in Path('/proc').glob('[0-9]*'):
        try:
            if SLEEPER in (folder / 'cmdline').read_bytes().split(b'\0'):
                found.append(int(folder.name))
        except OSError:
            continue
    return found


def test_honest_programs_get_their_points_and_results_say_the_mode(world):
    mode, seen, _ = world

    check_honest(mode, seen['results'])


def test_libraries_start_no_process_during_a_run(world):
    """Such a process would look like one that the program left behind."""
    assert world[1]['forks'] == '0'


def check_honest(mode: str, results) -> None:
    """Assert full points for one program that publishes and one that answers."""
    assert len(results) == 2
    for result in results:
        assert result['lacks'] == 0, result
        assert result['mode'] == mode
        assert bool(result['not_protected']) != mode.startswith('bwrap')
        assert result['flags'] == []


def test_hidden_exams_are_never_run_without_isolation():
    exam = catalog.load('harbour', hidden=True)

    with pytest.raises(SandboxUnavailable, match='never runs with isolation none'):
        Engine(choose.usable('none')).run(exam, {'harbour.py': ''})


def test_a_named_weak_mode_is_used_only_if_nothing_better_works():
    """Allowing a weak mode does not select it while a stronger mode works."""
    assert choose.strongest('none').facts.namespaces


def test_without_isolation_the_same_program_reaches_everything(planted):
    """The hostile program reaches files and ports if nothing confines it."""
    seen = run_world('none', planted)
    for path in planted.iterdir():
        path.unlink()

    reached = {'read REACHED', 'write REACHED', 'cut REACHED', 'tcp REACHED'}
    assert reached <= set(seen['hostile'])
    check_honest('none', seen['results'])

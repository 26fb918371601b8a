"""
Prepare the weaker isolation with Landlock: readable files, a free ROS domain, one run at a time.

:mod:`autograder.inside.confine` applies the rules.  A rule opens a whole folder.  To keep a path
in it closed (such as the course's own nodes, the solutions), the rules open all paths around it.
"""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
import fcntl
from glob import glob
import os
from pathlib import Path
import platform
import secrets

from autograder.errors import SandboxUnavailable
from autograder.inside import confine
from autograder.sandboxes.processes import FIRST_PORT, ports, PORTS_A_DOMAIN
from environment.ros import RosEnvironment
from environment.ros_domain import Claim, claim, DOMAINS

SYSTEM = ('/usr', '/bin', '/sbin', '/lib', '/lib64', '/etc/ld.so.cache', '/etc/alternatives')
DEVICES = ('/dev/null', '/dev/zero', '/dev/full', '/dev/random', '/dev/urandom')
SAME_USER_FROM = 3  # older versions let a program of the same user truncate the user's files
NO_FILTER = (
    f'There is no system-call filter for {platform.machine()}.',
    'Add it with autograder/sandboxes/seccomp/make_filters.py.',
)


def refusal(root: bool) -> tuple[str, str]:
    """Return why the kernel's Landlock cannot be used, and the fix; both empty if it can."""
    try:
        found = confine.landlock_version()
    except OSError as error:
        what = f'This kernel has no Landlock ({os.strerror(error.errno or 0)}).'
        fix = 'Add landlock to the kernel parameter lsm=..., or use kernel 6.2 or newer.'
        return what, fix
    if not root and found < SAME_USER_FROM:
        what = f'Landlock {found} cannot protect files from a program of the same user.'
        return what, 'Use kernel 6.2 or newer.'
    return '', ''


def filter_file() -> Path:
    """Return the file of the system-call filter for this processor."""
    return Path(__file__).parent / 'seccomp' / f'{platform.machine()}.bpf'


def closed_folder(paths: Iterable[str]) -> str:
    """Return the first folder above some paths that other users cannot enter, or ''."""
    for path in paths:
        for parent in reversed(Path(path).resolve().parents):
            if parent.is_dir() and not parent.stat().st_mode & 0o001:
                return str(parent)
    return ''


def own_nodes(ros: RosEnvironment, course_messages: bool) -> set[Path]:
    """
    Return the paths of the course's own nodes, which are the solutions of exercises.

    :param course_messages: whether the program may import the course's own message package; if
        not, the whole workspace is returned
    """
    workspace = Path(ros.workspace).parents[1]
    if not course_messages:
        return {workspace}
    package = f'{ros.workspace}/lib/python3*/site-packages/{ros.package}'
    modules = (*glob(f'{package}/*.py*'), *glob(f'{package}/__pycache__'))
    closed = {Path(module) for module in modules if not module.endswith('__init__.py')}
    closed |= {workspace / name for name in ('build', 'log', 'src')}
    return {*closed, Path(ros.workspace, 'lib', ros.package)}


def readable(ros: RosEnvironment, course_messages: bool) -> tuple[list[str], list[str]]:
    """Return the paths that a program may read, and the folders that it may only list."""
    closed = own_nodes(ros, course_messages)
    read = list(SYSTEM)
    names: list[str] = []
    for path in map(Path, ros.read_only):
        for opened, whole in _around(path, closed):
            (read if whole else names).append(str(opened))
    return read, names


def _around(path: Path, closed: set[Path]) -> Iterator[tuple[Path, bool]]:
    """
    Yield the paths to open so that everything below a path is open except the closed paths.

    The second value says whether a path may be read with all its contents, or only listed.
    """
    if path in closed:
        return
    if not any(path in one.parents for one in closed):
        yield path, True
        return
    yield path, False
    for child in sorted(path.iterdir()):
        yield from _around(child, closed)


def claim_free_domain() -> Claim:
    """
    Claim a random ROS domain that no notebook kernel has claimed and no program uses.

    :raises SandboxUnavailable: if no domain is free
    """
    used = {(port - FIRST_PORT) // PORTS_A_DOMAIN for port in ports()}
    free = sorted(set(DOMAINS) - used)
    secrets.SystemRandom().shuffle(free)
    claimed = claim(free)
    if claimed is None:
        raise SandboxUnavailable(
            f'Other programs use all {len(DOMAINS)} ROS domains of this machine.',
            'End other ROS programs, or use bubblewrap, which needs no free domain.',
        )
    return claimed


@contextmanager
def turn() -> Iterator[None]:
    """Wait until no other run of this user is active, because such runs share the network."""
    # All grading runs use the same lock file, although each has its own temporary folder.
    common = os.environ.get('TMPDIR') or '/tmp'
    path = Path(common, f'ros2-course-runs-{os.geteuid()}.lock')
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def threads_of_user() -> int:
    """Return the number of this user's threads, which count towards the process limit."""
    count = 0
    for folder in glob('/proc/[0-9]*'):
        try:
            if os.stat(folder).st_uid == os.geteuid():
                count += len(os.listdir(f'{folder}/task'))
        except OSError:
            continue  # the process has just ended
    return count

"""
Where student code runs: bubblewrap with namespaces of its own, or a refusal that says the fix.

===========  ==========================================================================
mode         what it is
===========  ==========================================================================
bwrap-user   the grader is a plain user: a user namespace, no capability, the user's own uid
bwrap-root   the grader is root (CI, containers): a throw-away uid and no user namespace
plain        no isolation at all: for visible checks on a learner's own machine, never for grading
===========  ==========================================================================

Both isolated modes give the student's process its own mount, pid, network, ipc and uts
namespaces, a read-only system, sized temporary folders, resource limits and a system-call filter.
Hidden exams, the gradebook and other submissions are not hidden there: they do not exist.
Bubblewrap starts with an empty environment, because its own process would show ours as
``/proc/1/environ`` inside.  This module only builds command lines and asks the kernel; the
namespaces themselves are bubblewrap's work.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
import fcntl
import functools
from glob import glob
import itertools
import json
import os
from pathlib import Path
import platform
import secrets
import shutil
import signal
import subprocess
import sys
from typing import Any

from autograder.errors import SandboxUnavailable
from environment.ros import ros_environment, RosEnvironment

HERE = Path(__file__).parent
NS_GET_USERNS = 0xB701  # ioctl_ns(2)
# A throw-away uid for each sandbox and probe of each grader: limits on processes are per uid.
_uids = itertools.count(1_000_000_000 + os.getpid() % 100_000 * 10_000)


@dataclass(frozen=True)
class Limits:
    """
    What one run may use before it is ended.

    :param wall_s: seconds on the wall clock
    :param cpu_s: processor seconds, all processes together
    :param memory: bytes of resident memory, all processes together
    :param processes: processes and threads
    :param folder: bytes in each writable folder
    :param inodes: files in the writable folders
    :param output: bytes printed
    """

    wall_s: float = 60.0
    cpu_s: int = 20
    memory: int = 1 << 30
    processes: int = 64
    folder: int = 64 << 20
    inodes: int = 20_000
    output: int = 8 << 20

    def argv(self) -> list[str]:
        """Return the prlimit prefix; sums over processes are the watchdog's business."""
        return [
            'prlimit',
            f'--nproc={self.processes}',
            f'--as={2 * self.memory}',
            f'--fsize={self.folder}',
            '--core=0',
            '--nofile=256',
            f'--cpu={self.cpu_s + 5}',  # the watchdog, which sums, comes first
            '--',
        ]


@dataclass(frozen=True)
class Program:
    """
    What to run and what it may see.

    :param argv: the command, in terms of the sandbox's own paths
    :param binds: read-only, host path to sandbox path
    :param course_messages: whether the course's own built messages are importable
    :param variables: added to the ROS environment
    """

    argv: Sequence[str]
    binds: Mapping[str, str] = field(default_factory=dict)
    course_messages: bool = True
    variables: Mapping[str, str] = field(default_factory=dict)


@dataclass
class Confined:
    """
    A started program and the handles on it.

    :param process: the outermost process
    :param pid: host pid of the sandbox's first process, or of the process itself in plain mode
    :param pidfd: descriptor of that process, safe against pid reuse
    :param namespaces: open descriptors ``net`` and, where there is one, ``user``
    """

    process: subprocess.Popen[bytes]
    pid: int
    pidfd: int
    namespaces: dict[str, int] = field(default_factory=dict)

    def release(self) -> None:
        """
        Let the program run; until then it waits, see :mod:`autograder.inside.gate`.

        Not bubblewrap's own ``--block-fd``: a sandbox held there outlives a killed grader, and
        runs.
        """
        assert self.process.stdin
        try:
            self.process.stdin.write(b'x')
            self.process.stdin.close()
        except BrokenPipeError:
            pass  # it has died already; its exit is noticed elsewhere
        self.process.stdin = None

    def kill(self) -> None:
        """End everything inside, then the launcher: killed first, that could leave orphans."""
        try:
            signal.pidfd_send_signal(self.pidfd, signal.SIGKILL)
        except ProcessLookupError:
            pass
        if not self.namespaces:  # plain mode: the whole process group
            try:
                os.killpg(self.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.process.kill()
        self.process.wait()
        for descriptor in (self.pidfd, *self.namespaces.values()):
            os.close(descriptor)
        self.namespaces = {}
        for stream in (self.process.stdout, self.process.stderr):
            if stream is not None:
                stream.close()
        if self.process.stdin is not None:
            try:
                self.process.stdin.close()
            except BrokenPipeError:
                pass


class Sandbox:
    """
    One way of confining programs.

    :param mode: ``'bwrap-user'``, ``'bwrap-root'`` or ``'plain'``
    """

    def __init__(self, mode: str, ros: RosEnvironment | None = None) -> None:
        """Look up the ROS environment once."""
        self.mode = mode
        self.ros = ros or ros_environment()

    @property
    def isolated(self) -> bool:
        """Tell whether hidden exams may be used with this mode."""
        return self.mode != 'plain'

    # -- command lines ---------------------------------------------------------------------

    def variables(self, program: Program, home: str, domain: int) -> dict[str, str]:
        """Return the whole environment of a confined program."""
        chosen = self.ros.variables if program.course_messages else self.ros.base_variables
        variables = {
            **chosen,
            'HOME': home,
            'ROS_LOG_DIR': f'{home}/log',
            'ROS_DOMAIN_ID': str(domain),
            'RMW_IMPLEMENTATION': 'rmw_fastrtps_cpp',
            'FASTRTPS_DEFAULT_PROFILES_FILE': self.profile,
            'RCUTILS_COLORIZED_OUTPUT': '0',
            'LANG': 'C.UTF-8',
            'OPENBLAS_NUM_THREADS': '1',
            'PYTHONDONTWRITEBYTECODE': '1',
            'PYTHONUNBUFFERED': '1',
            **program.variables,
        }
        # The loopback profile above replaces the rmw's own choice of peers and transports.
        variables.pop('ROS_AUTOMATIC_DISCOVERY_RANGE', None)
        return variables

    @property
    def profile(self) -> str:
        """Return where a confined program finds the Fast DDS profile."""
        return '/grader/fastdds.xml' if self.isolated else str(HERE / 'fastdds.xml')

    def bwrap(
        self, program: Program, limits: Limits, descriptors: Sequence[str], *, own_net: bool = True
    ) -> list[str]:
        """
        Return bubblewrap's options for a program.

        They are handed over through a pipe: its command line can be read inside the sandbox.

        :param descriptors: ``--info-fd N`` and the like
        :param own_net: False for the probe, which is put into the student's network before
        """
        root = self.mode == 'bwrap-root'
        argv = ['--unshare-ipc', '--unshare-pid', '--unshare-uts', '--unshare-cgroup-try']
        argv += ['--unshare-net'] if own_net else []
        argv += ['--cap-drop', 'ALL']
        if root:
            for capability in ('CAP_SETUID', 'CAP_SETGID', 'CAP_SETPCAP'):
                argv += ['--cap-add', capability]
        else:
            argv += ['--unshare-user', '--disable-userns']
        argv += ['--die-with-parent', '--new-session', '--hostname', 'box', '--clearenv']
        argv += self._mounts(program, limits)
        for name, value in self.variables(program, '/tmp/home', 0).items():
            argv += ['--setenv', name, value]
        argv += [*descriptors, '--chdir', '/tmp', '--remount-ro', '/dev', '--remount-ro', '/']
        return argv

    def command(self, program: Program, limits: Limits) -> list[str]:
        """Return what bubblewrap starts: the program behind its limits and, as root, its uid."""
        drop = []
        if self.mode == 'bwrap-root':
            uid = str(next(_uids))
            drop = ['setpriv', '--reuid', uid, '--regid', uid, '--clear-groups']
            drop += ['--inh-caps=-all', '--ambient-caps=-all', '--bounding-set=-all']
            drop += ['--no-new-privs', '--']
        return [*drop, *limits.argv(), *program.argv]

    def _mounts(self, program: Program, limits: Limits) -> list[str]:
        size = ['--perms', '1777', '--size', str(limits.folder), '--tmpfs']
        # /tmp comes before binds below it; the root and /dev are made read-only last.
        argv = [*size, '/tmp', '--ro-bind', '/usr', '/usr']
        for link in ('bin', 'lib', 'lib64', 'sbin'):
            if os.path.islink(f'/{link}'):
                argv += ['--symlink', os.readlink(f'/{link}'), f'/{link}']
            elif os.path.isdir(f'/{link}'):
                argv += ['--ro-bind', f'/{link}', f'/{link}']
        for file in ('/etc/ld.so.cache', '/etc/ld.so.conf', '/etc/alternatives'):
            argv += ['--ro-bind-try', file, file]
        binds = {path: path for path in self.ros.read_only}
        binds[str(HERE / 'fastdds.xml')] = '/grader/fastdds.xml'
        binds.update(program.binds)
        for host, inside in binds.items():
            argv += [*_parents(inside), '--ro-bind', host, inside]
        argv += self._masks(program)
        argv += ['--proc', '/proc', '--dev', '/dev', *size, '/dev/shm']
        return [*argv, '--perms', '1777', '--dir', '/tmp/home']

    def _masks(self, program: Program) -> list[str]:
        """
        Hide the course's own nodes, which would be the answer.

        Their message classes stay importable where the program needs them.
        """

        def hide(folder: str | Path) -> list[str]:
            # A mount of its own, so it needs its own size and its own "read-only".
            size = ['--perms', '0555', '--size', '4096', '--tmpfs', str(folder)]
            return [*size, '--remount-ro', str(folder)]

        if not program.course_messages:
            return hide(Path(self.ros.workspace).parents[1])
        argv = []
        build = Path(self.ros.workspace).parents[1] / 'build'
        for folder in (build, Path(self.ros.workspace, 'lib', 'temp_monitor_pkg')):
            argv += hide(folder) if folder.is_dir() else []
        for module in glob(f'{self.ros.workspace}/lib/python3*/site-packages/temp_monitor_pkg/*'):
            if module.endswith('__pycache__'):
                argv += hide(module)
            elif module.endswith('.py') and not module.endswith('__init__.py'):
                argv += ['--ro-bind', '/dev/null', module]
        return argv

    # -- starting --------------------------------------------------------------------------

    def start(self, program: Program, limits: Limits, home: Path) -> Confined:
        """
        Start a program of ours, which waits for :meth:`Confined.release`.

        Call it from a thread that lives longer than the program: the kernel ends the sandbox
        with the thread that started it.

        :param home: an existing empty folder; only plain mode writes there
        :raises SandboxUnavailable: if bubblewrap refuses
        """
        if not self.isolated:
            return self._start_plain(program, limits, home)
        info_read, info_write = os.pipe()
        rules = os.open(HERE / 'seccomp' / f'{platform.machine()}.bpf', os.O_RDONLY)
        descriptors = ['--info-fd', str(info_write), '--seccomp', str(rules)]
        try:
            options = self.bwrap(program, limits, descriptors)
            process = _popen([], options, self.command(program, limits), (info_write, rules))
        except OSError as error:
            os.close(info_read)
            raise SandboxUnavailable(f'bubblewrap did not start: {error}.', FIX_MISSING) from error
        finally:
            os.close(info_write)
            os.close(rules)
        with os.fdopen(info_read) as info:
            text = info.read()
        try:
            pid = json.loads(text)['child-pid']
            pidfd = os.pidfd_open(pid)
            net = os.open(f'/proc/{pid}/ns/net', os.O_RDONLY)
        except (ValueError, OSError) as error:
            process.kill()
            _, said = process.communicate()
            what = said.decode(errors='replace').strip() or str(error)
            raise SandboxUnavailable(f'bubblewrap refused: {what}.', _fix(what)) from error
        namespaces = {'net': net}
        if self.mode == 'bwrap-user':
            # Not nsenter -t PID: bubblewrap moves on to a nested user namespace.
            namespaces['user'] = fcntl.ioctl(net, NS_GET_USERNS)
        return Confined(process, pid, pidfd, namespaces)

    def _start_plain(self, program: Program, limits: Limits, home: Path) -> Confined:
        inside = {guest: host for host, guest in program.binds.items()}
        variables = {
            name: _outside(value, inside)
            for name, value in self.variables(program, str(home), self.domain).items()
        }
        process = subprocess.Popen(
            [*limits.argv()[:1], f'--cpu={limits.cpu_s}', '--core=0', '--']
            + [_outside(word, inside) for word in program.argv],
            env={**variables, 'TMPDIR': str(home)},
            cwd=home,
            start_new_session=True,
            **_PIPES,
        )
        return Confined(process, process.pid, os.pidfd_open(process.pid))

    @functools.cached_property
    def domain(self) -> int:
        """Return the domain id of plain mode: random in 1..101, so that checks rarely meet."""
        return 1 + secrets.randbelow(101)

    def start_probe(self, student: Confined, home: Path) -> subprocess.Popen[bytes]:
        """
        Start the probe in the student's network, apart from the student.

        As root it is confined by a sandbox of its own.  A plain user's probe joins the user
        namespace, in which no further one can be made: limits and a bare environment are all it
        has, so a fault in Fast DDS itself would be met with that user's rights.

        :param student: the held program
        """
        limits = Limits(processes=64, memory=1 << 30)
        binds = {str(HERE / 'probe.py'): '/grader/probe.py'}
        program = Program((self.ros.python, '/grader/probe.py'), binds)
        if not self.isolated:
            env = self.variables(program, str(home), self.domain)
            argv = [self.ros.python, str(HERE / 'probe.py')]
            return subprocess.Popen(argv, env=env, cwd=home, **_PIPES)  # type: ignore[call-overload, no-any-return]
        fds = tuple(student.namespaces.values())
        enter = ['nsenter', f'--net=/proc/self/fd/{student.namespaces["net"]}']
        if self.mode == 'bwrap-root':
            options = self.bwrap(program, limits, (), own_net=False)
            return _popen([*enter, '--'], options, self.command(program, limits), fds)
        enter += [f'--user=/proc/self/fd/{student.namespaces["user"]}', '--preserve-credentials']
        settings = self.variables(program, str(home), 0)
        settings['FASTRTPS_DEFAULT_PROFILES_FILE'] = str(HERE / 'fastdds.xml')
        assign = [f'{name}={value}' for name, value in settings.items()]
        run = [self.ros.python, str(HERE / 'probe.py')]
        argv = [*enter, '--', 'env', '-i', *assign, *limits.argv(), *run]
        return subprocess.Popen(argv, pass_fds=fds, env=BARE, **_PIPES)  # type: ignore[call-overload, no-any-return]


BARE = {'PATH': '/usr/bin:/bin'}
_PIPES: dict[str, Any] = {
    'stdin': subprocess.PIPE,
    'stdout': subprocess.PIPE,
    'stderr': subprocess.PIPE,
}


def _popen(
    enter: Sequence[str],
    options: Sequence[str],
    command: Sequence[str],
    fds: Sequence[int],
) -> subprocess.Popen[bytes]:
    """
    Start bubblewrap with its options in a pipe.

    :param enter: what comes before it on the command line
    :param fds: descriptors it inherits
    """
    listed, writing = os.pipe()
    try:
        # Some 8 KB; a pipe takes 64 KB without a reader.
        os.write(writing, b'\0'.join(option.encode() for option in options) + b'\0')
        os.close(writing)
        argv = [*enter, 'bwrap', '--args', str(listed), '--', *command]
        return subprocess.Popen(argv, pass_fds=(*fds, listed), env=BARE, **_PIPES)
    finally:
        os.close(listed)


def _parents(path: str) -> list[str]:
    """Return options that make a path's parents readable; bubblewrap's own are root's alone."""
    argv = []
    for parent in reversed(Path(path).parents):
        if str(parent) not in ('/', '/tmp', '/usr'):
            argv += ['--perms', '0755', '--dir', str(parent)]
    return argv


def _outside(text: str, inside: Mapping[str, str]) -> str:
    """Translate sandbox paths to host paths, for plain mode."""
    for guest, host in inside.items():
        if text == guest or text.startswith(f'{guest}/'):
            return host + text[len(guest) :]
    return text


# -- choosing ------------------------------------------------------------------------------

FIX_MISSING = 'Install bubblewrap 0.8 or newer: sudo apt-get install bubblewrap'
FIX_APPARMOR = (
    'This system forbids user namespaces to bubblewrap. Either once: sudo sysctl -w '
    'kernel.apparmor_restrict_unprivileged_userns=0, or for good an AppArmor profile for '
    '/usr/bin/bwrap; both are written out in environment.md, section "Grading refuses".'
)
FIX_CONTAINER = (
    'Inside a container, start it with --security-opt seccomp=unconfined --security-opt '
    'apparmor=unconfined; see environment.md, section "Grading refuses".'
)


def _fix(said: str) -> str:
    """Return the repair for what bubblewrap printed."""
    if 'uid map' in said or 'RTM_NEWADDR' in said:
        return FIX_APPARMOR
    if 'namespace' in said or 'pivot_root' in said:
        return FIX_CONTAINER
    if 'nknown option' in said:
        return FIX_MISSING
    return 'See environment.md, section "Grading refuses".'


@functools.lru_cache(maxsize=1)
def strongest() -> Sandbox:
    """
    Return the isolated sandbox that works here, found out by using it.

    :raises SandboxUnavailable: with the exact fix; nothing weaker is ever used for grading
    """
    if shutil.which('bwrap') is None:
        raise SandboxUnavailable('bubblewrap is not installed.', FIX_MISSING)
    if platform.machine() not in ('x86_64', 'aarch64'):
        raise SandboxUnavailable(
            f'There is no system-call filter for {platform.machine()}.',
            'Add it with autograder/seccomp/make_filters.py.',
        )
    # Never bubblewrap's user namespace as root: the kernel would still see uid 0 inside.
    sandbox = Sandbox('bwrap-root' if os.geteuid() == 0 else 'bwrap-user')
    _try_out(sandbox)
    return sandbox


def _try_out(sandbox: Sandbox) -> None:
    """Run a Python that imports rclpy inside, and join its network as the probe will."""
    program = Program((sandbox.ros.python, '-c', 'import rclpy; print("in")'))
    confined = sandbox.start(program, Limits(wall_s=20), Path('/'))
    try:
        fds = confined.namespaces
        enter = ['nsenter', f'--net=/proc/self/fd/{fds["net"]}']
        if 'user' in fds:
            enter += [f'--user=/proc/self/fd/{fds["user"]}', '--preserve-credentials']
        joined = subprocess.run(
            [*enter, '--', 'true'],
            pass_fds=tuple(fds.values()),
            capture_output=True,
            text=True,
            check=False,
        )
        if joined.returncode != 0:
            raise SandboxUnavailable(
                f'The probe cannot join the sandbox network: {joined.stderr.strip()}.',
                FIX_CONTAINER,
            )
        confined.release()
        try:
            said, error = confined.process.communicate(timeout=20)
        except subprocess.TimeoutExpired as late:
            raise SandboxUnavailable('rclpy did not import within 20 s.', 'make doctor') from late
        if said.strip() != b'in':
            tail = error.decode(errors='replace').strip().splitlines()[-1:]
            raise SandboxUnavailable(
                f'rclpy does not run inside the sandbox: {" ".join(tail)}.', 'Try: make doctor'
            )
    finally:
        confined.kill()


def plain() -> Sandbox:
    """Return the way without isolation, for visible checks on one's own code."""
    return Sandbox('plain')


if __name__ == '__main__':
    try:
        print(f'sandbox: {strongest().mode} works')
    except SandboxUnavailable as refusal:
        sys.exit(f'sandbox: {refusal}')

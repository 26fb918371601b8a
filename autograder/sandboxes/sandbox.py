"""
Confine student code with bubblewrap in separate namespaces, or with weaker isolation.

:mod:`autograder.sandboxes.isolation` lists the modes by strength, and what each does not protect.
The two modes with full isolation give the student's process its own mount, pid, network, ipc and
uts namespaces, a read-only system, temporary folders of limited size, resource limits and a
system-call filter.  Hidden exams, the gradebook and other submissions do not exist in these
namespaces.  Bubblewrap starts with an almost empty environment, because programs in the sandbox
can read it from ``/proc/1/environ``.

This module builds the command lines and starts bubblewrap, which creates the namespaces.
"""

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
import fcntl
import json
import os
from pathlib import Path
import secrets
import socket
import subprocess
from typing import Any

from autograder.errors import SandboxUnavailable
from autograder.sandboxes import isolation, landlock
from autograder.sandboxes.confinement import ConfinedProgram, end_group, Limits, Program
from autograder.sandboxes.isolation import fix_for
from environment.ros import ros_environment, RosEnvironment

HERE = Path(__file__).parents[1]
NS_GET_USERNS = 0xB701  # ioctl_ns(2)
HOME = '/tmp/home'
READY = ('sh', '-c', 'echo >&0; exec "$@"', 'sh')
"""Prefix of a command: report that the file systems and the network are set up, then run it."""
READY_S = 120.0  # timeout, ten thousand times the usual duration
FIRST_UID, UIDS = 1_000_000_000, 1_000_000_000


class Sandbox:
    """One way to confine programs: a mode of :data:`autograder.sandboxes.isolation.MODES`."""

    def __init__(self, mode: str, ros: RosEnvironment | None = None) -> None:
        """Use the given ROS environment, or read the prepared one."""
        self.mode = mode
        self.facts = isolation.MODES[mode]
        self.ros = ros or ros_environment()

    @property
    def keeps_secrets(self) -> bool:
        """Return whether hidden exams may be used with this mode."""
        return self.facts.keeps_secrets

    def turn(self) -> AbstractContextManager[None]:
        """Return the lock that serialises runs on a shared network."""
        return nullcontext() if self.facts.namespaces else landlock.turn()

    # -- command lines ---------------------------------------------------------------------

    def variables(self, program: Program, home: str, domain: int) -> dict[str, str]:
        """Return all environment variables of a confined program."""
        profile = '/grader/fastdds.xml' if self.facts.namespaces else str(HERE / 'fastdds.xml')
        chosen = self.ros.variables if program.course_messages else self.ros.base_variables
        variables = {
            **chosen,
            'HOME': home,
            'ROS_LOG_DIR': f'{home}/log',
            'ROS_DOMAIN_ID': str(domain),
            'RMW_IMPLEMENTATION': 'rmw_fastrtps_cpp',
            'FASTRTPS_DEFAULT_PROFILES_FILE': profile,
            'RCUTILS_COLORIZED_OUTPUT': '0',
            'LANG': 'C.UTF-8',
            'OPENBLAS_NUM_THREADS': '1',
            'PYTHONDONTWRITEBYTECODE': '1',
            'PYTHONUNBUFFERED': '1',
            **program.variables,
        }
        # This variable must be unset: the profile sets peers and transports.
        variables.pop('ROS_AUTOMATIC_DISCOVERY_RANGE', None)
        return variables

    def bwrap(
        self,
        program: Program,
        limits: Limits,
        descriptors: Sequence[str],
        capabilities: Sequence[str] = (),
    ) -> list[str]:
        """
        Return bubblewrap's options for a program.

        :func:`start_bwrap` passes them through a pipe, because a program inside the sandbox can
        read the command line.

        :param descriptors: options with descriptors, such as ``--info-fd N``
        :param capabilities: those that root keeps, in addition to those for giving up its rights
        """
        argv = ['--unshare-ipc', '--unshare-pid', '--unshare-uts', '--unshare-cgroup-try']
        argv += ['--unshare-net', '--cap-drop', 'ALL']
        if self.facts.root:
            for capability in ('CAP_SETUID', 'CAP_SETGID', 'CAP_SETPCAP', *capabilities):
                argv += ['--cap-add', capability]
        else:
            argv += ['--unshare-user', '--disable-userns']
        argv += ['--die-with-parent', '--new-session', '--hostname', 'box', '--clearenv']
        argv += self._mounts(program, limits)
        for name, value in self.variables(program, HOME, 0).items():
            argv += ['--setenv', name, value]
        argv += [*descriptors, '--chdir', '/tmp', '--remount-ro', '/dev', '--remount-ro', '/']
        return argv

    def command(self, program: Program, limits: Limits) -> list[str]:
        """Return the command for bubblewrap: the program with its limits and, for root, a uid."""
        drop = []
        if self.facts.root:
            uid = str(throw_away_uid())
            drop = ['setpriv', '--reuid', uid, '--regid', uid, '--clear-groups']
            drop += ['--inh-caps=-all', '--ambient-caps=-all', '--bounding-set=-all']
            drop += ['--no-new-privs', '--']
        return [*drop, *limits.argv(), *program.argv]

    def _mounts(self, program: Program, limits: Limits) -> list[str]:
        size = ['--perms', '1777', '--size', str(limits.folder), '--tmpfs']
        # Mount /tmp before binds below it; the root and /dev are made read-only last.
        argv = [*size, '/tmp', '--ro-bind', '/usr', '/usr']
        for link in ('bin', 'lib', 'lib64', 'sbin'):
            if os.path.islink(f'/{link}'):
                argv += ['--symlink', os.readlink(f'/{link}'), f'/{link}']
            elif os.path.isdir(f'/{link}'):
                argv += ['--ro-bind', f'/{link}', f'/{link}']
        for file in ('/etc/ld.so.cache', '/etc/ld.so.conf', '/etc/alternatives'):
            argv += [*_parents(file), '--ro-bind-try', file, file]
        binds = {path: path for path in self.ros.read_only}
        binds[str(HERE / 'fastdds.xml')] = '/grader/fastdds.xml'
        binds.update(program.binds)
        for host, inside in binds.items():
            argv += [*_parents(inside), '--ro-bind', host, inside]
        argv += self._masks(program)
        argv += ['--proc', '/proc', '--dev', '/dev', *size, '/dev/shm']
        return [*argv, '--perms', '1777', '--dir', HOME]

    def _masks(self, program: Program) -> list[str]:
        """Return the options that hide the course's own nodes behind empty folders and files."""
        argv = []
        for path in sorted(landlock.own_nodes(self.ros, program.course_messages)):
            if path.is_dir():
                # This is a separate mount, so it needs a size and must be made read-only itself.
                argv += ['--perms', '0555', '--size', '4096', '--tmpfs', str(path)]
                argv += ['--remount-ro', str(path)]
            elif path.exists():
                argv += ['--ro-bind', '/dev/null', str(path)]
        return argv

    # -- starting --------------------------------------------------------------------------

    def start(
        self, program: Program, limits: Limits, home: Path, inherited: Sequence[int] = ()
    ) -> ConfinedProgram:
        """
        Start a confined program, which waits for :meth:`ConfinedProgram.release`.

        Call this method from a thread that outlives the program, because the kernel ends the
        sandbox when the thread that started it ends.

        :param home: an existing empty folder, used by modes without separate file systems
        :param inherited: descriptors that the program inherits with the same numbers
        :raises SandboxUnavailable: if bubblewrap fails, or no ROS domain is free
        """
        if not self.facts.namespaces:
            return self._start_weak(program, limits, home, inherited)
        gate, theirs = socket.socketpair()
        reading, writing = os.pipe()
        with os.fdopen(reading) as info:
            with (
                theirs,
                os.fdopen(writing, 'w') as told,
                landlock.filter_file().open('rb') as rules,
            ):
                held = [told.fileno(), rules.fileno()]
                descriptors = ['--info-fd', str(held[0]), '--seccomp', str(held[1])]
                options = self.bwrap(program, limits, descriptors)
                command = [*READY, *self.command(program, limits)]
                try:
                    process = start_bwrap(options, command, [*held, *inherited], stdin=theirs)
                except OSError as error:
                    gate.close()
                    what = f'bubblewrap did not start: {error}.'
                    raise SandboxUnavailable(what, isolation.FIX_MISSING) from error
            text = info.read()
        try:
            gate.settimeout(READY_S)
            if not gate.recv(1):
                raise OSError('the sandbox ended')
            pid = json.loads(text)['child-pid']
            pidfd = os.pidfd_open(pid)
            net = open_namespace(pid, 'net')
        except (ValueError, OSError) as error:
            gate.close()
            end_group(process)
            _, said = process.communicate()
            what = said.decode(errors='replace').strip() or str(error)
            raise SandboxUnavailable(f'bubblewrap refused: {what}.', fix_for(what)) from error
        namespaces = {'net': net}
        if not self.facts.root:
            # Do not use nsenter -t PID: bubblewrap's process enters a nested user namespace later.
            namespaces['user'] = fcntl.ioctl(net, NS_GET_USERNS)
        return ConfinedProgram(process, gate, pid, pidfd, namespaces)

    def _start_weak(
        self, program: Program, limits: Limits, home: Path, inherited: Sequence[int]
    ) -> ConfinedProgram:
        claimed = landlock.claim_free_domain()
        argv, variables = self.host_command(program, home, claimed.domain, limits)
        if self.facts.landlock:
            rules = {**self.landlock_rules(program, str(home)), 'inherited': list(inherited)}
            if rules['uid']:
                os.chown(home, rules['uid'], rules['uid'])
            launcher = str(HERE / 'inside' / 'confine.py')
            # Ignore site-packages and PYTHON*: the launcher needs only the standard library.
            argv = [self.ros.python, '-E', '-s', '-S', launcher, json.dumps(rules), *argv]
        gate, theirs = socket.socketpair()
        with theirs:
            process = subprocess.Popen(
                argv, pass_fds=inherited, env=variables, cwd=home, **{**PIPES, 'stdin': theirs}
            )
        pidfd = os.pidfd_open(process.pid)
        confined = ConfinedProgram(process, gate, process.pid, pidfd, home=home)
        confined.supervised, confined.claimed = self.facts.landlock, claimed
        return confined

    def host_command(
        self, program: Program, home: Path, domain: int, limits: Limits | None = None
    ) -> tuple[list[str], dict[str, str]]:
        """Return a program's command line and environment variables, with host paths."""
        inside = {guest: host for host, guest in program.binds.items()}
        variables = {
            name: _host_path(value, inside)
            for name, value in self.variables(program, str(home), domain).items()
        }
        prefix = ['setpriv', '--pdeathsig', 'KILL', '--']  # end the program if the grader ends
        prefix += limits.argv(self.processes()) if limits else []
        argv = [*prefix, *(_host_path(word, inside) for word in program.argv)]
        return argv, {**variables, 'TMPDIR': str(home)}

    def processes(self) -> int:
        """Return how many processes and threads the uid of a run already has."""
        return 0 if self.facts.root else landlock.threads_of_user()

    def rules(self) -> dict[str, Any]:
        """Return the rules without Landlock for ``inside/confine.py``, which describes both."""
        uid = throw_away_uid() if self.facts.root else 0
        return {'uid': uid, 'filter': str(landlock.filter_file())}

    def landlock_rules(self, program: Program, *write: str) -> dict[str, Any]:
        """Return the rules with Landlock; a program may write only to devices and some paths."""
        read, names = landlock.readable(self.ros, program.course_messages)
        return {
            **self.rules(),
            'read': [*read, *program.binds, str(HERE / 'fastdds.xml')],
            'list': names,
            'write': [*write, *landlock.DEVICES],
        }


def throw_away_uid() -> int:
    """
    Return a temporary uid for one sandbox or probe, because the process limit is per uid.

    The uid is random and not derived from the grader's pid: graders in two containers may have
    the same pid and share a kernel, which counts the processes of both.
    """
    return FIRST_UID + secrets.randbelow(UIDS)


def open_namespace(pid: int, kind: str) -> int:
    """Return an open descriptor of a process's namespace."""
    return os.open(f'/proc/{pid}/ns/{kind}', os.O_RDONLY)


BARE = {'PATH': '/usr/bin:/bin'}
PIPES: dict[str, Any] = {
    'stdin': subprocess.PIPE,
    'stdout': subprocess.PIPE,
    'stderr': subprocess.PIPE,
    # A separate process group can be killed as a whole, even while the sandbox is being set up.
    'start_new_session': True,
}


def start_bwrap(
    options: Sequence[str],
    command: Sequence[str],
    fds: Sequence[int],
    **pipes: Any,
) -> subprocess.Popen[bytes]:
    """
    Start bubblewrap, and pass its options through a pipe.

    :param pipes: arguments of :class:`subprocess.Popen` that replace those in :data:`PIPES`
    """
    listed, writing = os.pipe()
    try:
        # The options take about 8 KB, and a pipe holds 64 KB without a reader.
        os.write(writing, b'\0'.join(option.encode() for option in options) + b'\0')
        os.close(writing)
        argv = ['bwrap', '--args', str(listed), '--', *command]
        return subprocess.Popen(argv, pass_fds=(*fds, listed), env=BARE, **{**PIPES, **pipes})
    finally:
        os.close(listed)


def _parents(path: str) -> list[str]:
    """Return options that create a path's parents with mode 0755, so that every user can enter."""
    argv = []
    for parent in reversed(Path(path).parents):
        if str(parent) not in ('/', '/tmp', '/usr'):
            argv += ['--perms', '0755', '--dir', str(parent)]
    return argv


def _host_path(text: str, inside: Mapping[str, str]) -> str:
    """Translate a sandbox path to a host path, for modes without separate file systems."""
    for guest, host in inside.items():
        if text == guest or text.startswith(f'{guest}/'):
            return host + text[len(guest) :]
    return text

"""
Confine student code: with bubblewrap in separate namespaces, or in a weaker way.

:mod:`autograder.sandboxes.isolation` lists the modes by strength, and what each does not protect.
The two isolated modes give the student's process its own mount, pid, network, ipc and uts
namespaces, a read-only system, temporary folders of limited size, resource limits and a
system-call filter.  Hidden exams, the gradebook and other submissions do not exist there.
Bubblewrap starts with an empty environment, because a program inside can read it as
``/proc/1/environ``.

This module only builds command lines and queries the kernel; bubblewrap creates the namespaces.
"""

from __future__ import annotations

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
from autograder.sandboxes.confined import Confined, end_group, Limits, Program
from autograder.sandboxes.isolation import fix_for
from environment.ros import ros_environment, RosEnvironment

HERE = Path(__file__).parents[1]
NS_GET_USERNS = 0xB701  # ioctl_ns(2)
FIRST_UID, UIDS = 1_000_000_000, 1_000_000_000


class Sandbox:
    """
    One way to confine programs.

    :param mode: see :data:`autograder.sandboxes.isolation.MODES`
    """

    def __init__(self, mode: str, ros: RosEnvironment | None = None) -> None:
        """Read the ROS environment once."""
        self.mode = mode
        self.facts = isolation.MODES[mode]
        self.ros = ros or ros_environment()

    @property
    def isolated(self) -> bool:
        """Return whether a program has separate file systems and a separate network."""
        return self.facts.namespaces

    @property
    def keeps_secrets(self) -> bool:
        """Return whether hidden exams may be used with this mode."""
        return self.facts.keeps_secrets

    def turn(self) -> AbstractContextManager[None]:
        """Return the lock that serialises runs on a shared network."""
        return nullcontext() if self.isolated else landlock.turn()

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
        self,
        program: Program,
        limits: Limits,
        descriptors: Sequence[str],
        capabilities: Sequence[str] = (),
    ) -> list[str]:
        """
        Return bubblewrap's options for a program.

        They go through a pipe, because a program inside the sandbox can read the command line.

        :param descriptors: ``--info-fd N`` and the like
        :param capabilities: what root keeps beside those that it needs to give up its rights
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
        for name, value in self.variables(program, '/tmp/home', 0).items():
            argv += ['--setenv', name, value]
        argv += [*descriptors, '--chdir', '/tmp', '--remount-ro', '/dev', '--remount-ro', '/']
        return argv

    def command(self, program: Program, limits: Limits) -> list[str]:
        """Return bubblewrap's command: the program behind its limits and, as root, with a uid."""
        drop = []
        if self.facts.root:
            uid = str(throw_away_uid())
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
            argv += [*_parents(file), '--ro-bind-try', file, file]
        binds = {path: path for path in self.ros.read_only}
        binds[str(HERE / 'fastdds.xml')] = '/grader/fastdds.xml'
        binds.update(program.binds)
        for host, inside in binds.items():
            argv += [*_parents(inside), '--ro-bind', host, inside]
        argv += self._masks(program)
        argv += ['--proc', '/proc', '--dev', '/dev', *size, '/dev/shm']
        return [*argv, '--perms', '1777', '--dir', '/tmp/home']

    def _masks(self, program: Program) -> list[str]:
        """Hide the course's own nodes behind empty folders and files."""
        argv = []
        for path in sorted(landlock.own_nodes(self.ros, program.course_messages)):
            if path.is_dir():
                # A mount of its own, so it needs its own size and its own "read-only".
                argv += ['--perms', '0555', '--size', '4096', '--tmpfs', str(path)]
                argv += ['--remount-ro', str(path)]
            elif path.exists():
                argv += ['--ro-bind', '/dev/null', str(path)]
        return argv

    # -- starting --------------------------------------------------------------------------

    def start(
        self, program: Program, limits: Limits, home: Path, inherited: Sequence[int] = ()
    ) -> Confined:
        """
        Start a confined program, which waits for :meth:`Confined.release`.

        Call this from a thread that lives longer than the program, because the kernel ends the
        sandbox with the thread that started it.

        :param home: an existing empty folder, for modes without file systems of their own
        :param inherited: descriptors that the program inherits under their numbers
        :raises SandboxUnavailable: if bubblewrap refuses
        """
        if not self.isolated:
            return self._start_weak(program, limits, home, inherited)
        gate, theirs = socket.socketpair()
        info_read, info_write = os.pipe()
        rules = os.open(landlock.filter_file(), os.O_RDONLY)
        descriptors = ['--info-fd', str(info_write), '--seccomp', str(rules)]
        try:
            options = self.bwrap(program, limits, descriptors)
            command = self.command(program, limits)
            held = (info_write, rules, *inherited)
            process = start_bwrap(options, command, held, stdin=theirs)
        except OSError as error:
            os.close(info_read)
            gate.close()
            raise SandboxUnavailable(
                f'bubblewrap did not start: {error}.', isolation.FIX_MISSING
            ) from error
        finally:
            theirs.close()
            os.close(info_write)
            os.close(rules)
        with os.fdopen(info_read) as info:
            text = info.read()
        try:
            pid = json.loads(text)['child-pid']
            pidfd = os.pidfd_open(pid)
            net = os.open(f'/proc/{pid}/ns/net', os.O_RDONLY)
        except (ValueError, OSError) as error:
            gate.close()
            end_group(process)
            _, said = process.communicate()
            what = said.decode(errors='replace').strip() or str(error)
            raise SandboxUnavailable(f'bubblewrap refused: {what}.', fix_for(what)) from error
        namespaces = {'net': net}
        if not self.facts.root:
            # Not nsenter -t PID: bubblewrap moves on to a nested user namespace.
            namespaces['user'] = fcntl.ioctl(net, NS_GET_USERNS)
        return Confined(process, gate, pid, pidfd, namespaces)

    def _start_weak(
        self, program: Program, limits: Limits, home: Path, inherited: Sequence[int]
    ) -> Confined:
        claimed = landlock.claim_free_domain()
        argv, variables = self.outside(program, home, claimed.domain, limits)
        if self.facts.landlock:
            argv = [*self.behind_landlock(program, home, inherited), *argv]
        gate, theirs = socket.socketpair()
        with theirs:
            process = subprocess.Popen(
                argv, pass_fds=inherited, env=variables, cwd=home, **{**PIPES, 'stdin': theirs}
            )
        pidfd = os.pidfd_open(process.pid)
        confined = Confined(process, gate, process.pid, pidfd, home=home)
        confined.supervised, confined.claimed = self.facts.landlock, claimed
        return confined

    def outside(
        self, program: Program, home: Path, domain: int, limits: Limits | None = None
    ) -> tuple[list[str], dict[str, str]]:
        """Return a program's command line with limits, and its variables, in host paths."""
        inside = {guest: host for host, guest in program.binds.items()}
        variables = {
            name: _outside(value, inside)
            for name, value in self.variables(program, str(home), domain).items()
        }
        prefix = ['setpriv', '--pdeathsig', 'KILL', '--']  # ends with its grader
        prefix += limits.argv(self.processes()) if limits else []
        argv = [*prefix, *(_outside(word, inside) for word in program.argv)]
        return argv, {**variables, 'TMPDIR': str(home)}

    def processes(self) -> int:
        """Return how many processes and threads a run's own uid has already."""
        return 0 if self.facts.root else landlock.threads_of_user()

    def behind_landlock(
        self, program: Program, home: Path, inherited: Sequence[int] = ()
    ) -> list[str]:
        """
        Return the launcher that puts a program behind Landlock.

        :param inherited: descriptors that stay open
        """
        rules = {**self.landlock_rules(program, str(home)), 'inherited': list(inherited)}
        if rules['uid']:
            os.chown(home, rules['uid'], rules['uid'])
        launcher = str(HERE / 'inside' / 'confine.py')
        # Not -I: Python has to find what is next to the launcher.
        return [self.ros.python, '-E', '-s', '-S', launcher, json.dumps(rules)]

    def landlock_rules(self, program: Program, *write: str) -> dict[str, Any]:
        """Return what is left to a program behind Landlock, for ``inside/confine.py``."""
        read, names = landlock.readable(self.ros, program.course_messages)
        return {
            'uid': throw_away_uid() if self.facts.root else 0,
            'read': [*read, *program.binds, str(HERE / 'fastdds.xml')],
            'list': names,
            'write': [*write, *landlock.DEVICES],
            'filter': str(landlock.filter_file()),
        }


def throw_away_uid() -> int:
    """
    Return a uid for one sandbox or probe; limits on processes are per uid.

    The uid is random, because graders in two containers may have equal pids and share the kernel
    that counts.
    """
    return FIRST_UID + secrets.randbelow(UIDS)


BARE = {'PATH': '/usr/bin:/bin'}
PIPES: dict[str, Any] = {
    'stdin': subprocess.PIPE,
    'stdout': subprocess.PIPE,
    'stderr': subprocess.PIPE,
    # A process group of its own, so that it can be ended with all that is just being set up.
    'start_new_session': True,
}


def start_bwrap(
    options: Sequence[str],
    command: Sequence[str],
    fds: Sequence[int],
    **pipes: Any,
) -> subprocess.Popen[bytes]:
    """
    Start bubblewrap with its options in a pipe.

    :param fds: descriptors it inherits
    :param pipes: what is to be different from :data:`PIPES`
    """
    listed, writing = os.pipe()
    try:
        # Some 8 KB; a pipe takes 64 KB without a reader.
        os.write(writing, b'\0'.join(option.encode() for option in options) + b'\0')
        os.close(writing)
        argv = ['bwrap', '--args', str(listed), '--', *command]
        return subprocess.Popen(argv, pass_fds=(*fds, listed), env=BARE, **{**PIPES, **pipes})
    finally:
        os.close(listed)


def _parents(path: str) -> list[str]:
    """Return options that make a path's parents readable, which bubblewrap opens only to root."""
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

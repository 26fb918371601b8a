"""
Confine a program with Landlock, and end every process that it started.

Usage: confine.py RULES COMMAND...  where RULES is JSON::

    {"uid": 1000000001, "read": [paths], "list": [folders], "write": [folders],
     "filter": file, "inherited": [descriptors]}

This is for machines without namespaces.  This process is the supervisor, to which the rules do not
apply.  Processes that the program leaves behind become children of the supervisor, so none outlive
the run: when the program has ended, on SIGTERM, or when the grader dies, the supervisor ends them
all.  The program is a child to which the rules apply.  It may read, execute and write only the
listed paths, cannot use TCP (Landlock 4 or newer), cannot signal processes outside (Landlock 6 or
newer), and has the same system-call filter as in a sandbox with namespaces.

The Landlock library on PyPI has only development releases, which support only files, so this
module makes the three system calls itself.  See landlock(7).
"""

from collections.abc import Iterator
from contextlib import suppress
import ctypes
from itertools import pairwise
import json
import os
import signal
import stat
import struct
import sys
from typing import Any

# From linux/prctl.h and linux/seccomp.h.
PR_SET_PDEATHSIG, PR_SET_SECCOMP, SECCOMP_MODE_FILTER = 1, 22, 2
PR_SET_DUMPABLE = 4
PR_CAPBSET_DROP, MOST_CAPABILITIES = 24, 64
CAPABILITY_VERSION = 0x20080522  # _LINUX_CAPABILITY_VERSION_3 of linux/capability.h
PR_SET_CHILD_SUBREAPER, PR_SET_NO_NEW_PRIVS = 36, 38
# Numbers of Landlock's system calls, the same on all architectures.
CREATE_RULESET, ADD_RULE, RESTRICT_SELF = 444, 445, 446
ASK_VERSION = 1
PATH_BENEATH = 1
EXECUTE, WRITE_FILE, READ_FILE, READ_DIR = 1, 2, 4, 8
TRUNCATE, IOCTL_DEV = 1 << 14, 1 << 15
OF_FILES = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE | IOCTL_DEV
# Number of file-access rights in each version of Landlock, from version 1 on.
KNOWN_RIGHTS = (13, 14, 15, 15, 16)
TCP_FROM, SCOPE_FROM = 4, 6
TCP, SCOPE = 0b11, 0b11  # TCP: bind and connect; scope: abstract sockets and signals
LTTNG = ('/dev/shm/lttng-ust-wait-6', '/dev/shm/lttng-ust-wait-8')
"""Files of LTTng, which rclpy loads: for the wheels from PyPI, and for Ubuntu 24.04."""

libc = ctypes.CDLL(None, use_errno=True)
libc.syscall.restype = ctypes.c_long


def call(name: str, *arguments: Any) -> int:
    """
    Call a function of the C library that returns a negative number on failure.

    :param arguments: each integer is passed as an unsigned long
    :raises OSError: if the call fails
    """
    values = [ctypes.c_ulong(value) if isinstance(value, int) else value for value in arguments]
    result = int(getattr(libc, name)(*values))
    if result < 0:
        raise OSError(ctypes.get_errno(), f'{name}: {os.strerror(ctypes.get_errno())}')
    return result


def prctl(option: int, *arguments: Any) -> None:
    """Change a property of this process with the system call of the same name."""
    call('prctl', option, *arguments, *[0] * (4 - len(arguments)))


def landlock_version() -> int:
    """
    Return the version of Landlock's interface in this kernel.

    :raises OSError: ENOSYS if the kernel has no Landlock, EOPNOTSUPP if Landlock is disabled
    """
    return call('syscall', CREATE_RULESET, None, 0, ASK_VERSION)


def restrict(rules: dict[str, Any], descriptors: dict[str, int]) -> None:
    """
    Give up file access that no rule allows and, if Landlock supports it, TCP and signals.

    :param rules: described in the docstring of this module
    :param descriptors: descriptors of the rules' paths, by path, opened before the uid was changed
    :raises OSError: if the kernel refuses
    """
    known = landlock_version()
    everything = (1 << KNOWN_RIGHTS[min(known, len(KNOWN_RIGHTS)) - 1]) - 1
    attributes = [everything]
    attributes += [TCP] if known >= TCP_FROM else []
    attributes += [SCOPE] if known >= SCOPE_FROM else []
    packed = struct.pack(f'={len(attributes)}Q', *attributes)
    ruleset = call('syscall', CREATE_RULESET, packed, len(packed), 0)
    reading = EXECUTE | READ_FILE | READ_DIR
    for name, rights in (('read', reading), ('list', READ_DIR), ('write', everything & ~EXECUTE)):
        for path in rules[name]:
            if path not in descriptors:
                continue
            folder = stat.S_ISDIR(os.fstat(descriptors[path]).st_mode)
            wanted = rights & everything & (everything if folder else OF_FILES)
            rule = struct.pack('=Qi', wanted, descriptors[path])
            call('syscall', ADD_RULE, ruleset, PATH_BENEATH, rule, 0)
    call('syscall', RESTRICT_SELF, ruleset, 0)


def filter_of(rules: dict[str, Any]) -> bytes:
    """Return the system-call filter: sock_filter records, eight bytes per instruction."""
    with open(rules['filter'], 'rb') as file:
        return file.read()


def give_up(rules: dict[str, Any], code: bytes) -> None:
    """
    Give up all rights of this process except those in the rules, and close other descriptors.

    :param rules: described in the docstring of this module; without ``read``, Landlock is not
        used; a uid of 0 keeps the current one
    :param code: the filter that :func:`filter_of` returns; see seccomp(2)
    :raises OSError: if the kernel refuses
    """
    descriptors = {}
    for path in (*rules.get('read', ()), *rules.get('list', ()), *rules.get('write', ())):
        if os.path.exists(path):
            descriptors[path] = os.open(path, os.O_PATH | os.O_CLOEXEC)
    held = ctypes.create_string_buffer(code, len(code))
    filter_calls = struct.pack('HxxxxxxP', len(code) // 8, ctypes.addressof(held))
    with suppress(OSError):  # no capability is left, or this process cannot gain any
        for capability in range(MOST_CAPABILITIES):
            prctl(PR_CAPBSET_DROP, capability)
    if rules['uid']:
        os.setgroups([])
        os.setresgid(rules['uid'], rules['uid'], rules['uid'])
        os.setresuid(rules['uid'], rules['uid'], rules['uid'])
    call('capset', struct.pack('=Ii', CAPABILITY_VERSION, 0), bytes(24))
    prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    prctl(PR_SET_NO_NEW_PRIVS, 1)
    if 'read' in rules:
        restrict(rules, descriptors)
    prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, ctypes.c_char_p(filter_calls))
    kept = [2, *sorted(rules['inherited']), 1024]
    for below, above in pairwise(kept):
        os.closerange(below + 1, above)


def tracing_files(uid: int) -> Iterator[str]:
    """
    Create the files in which LTTng waits for a tracer, and yield those that the program may read.

    If a program cannot create them itself, LTTng's threads fork a process every 5 s to try again.
    The grader would see some of these as processes of the student.
    """
    for common in LTTNG:
        for path, mode, owner in ((common, 0o666, -1), (f'{common}-{uid}', 0o640, uid)):
            with suppress(OSError):  # the file exists already, or this system has no /dev/shm
                flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC
                file = os.open(path, flags, 0o600)
                os.ftruncate(file, os.sysconf('SC_PAGESIZE'))
                os.fchown(file, owner, -1)
                os.fchmod(file, mode)
                os.close(file)
            if os.path.isfile(path) and not os.path.islink(path):
                yield path


def family(*pids: int) -> Iterator[int]:
    """Yield the pids of processes and their descendants, without those that have ended."""
    waiting = list(pids)
    while waiting:
        current = waiting.pop()
        try:
            tasks = os.listdir(f'/proc/{current}/task')
        except OSError:
            continue  # the process has ended
        yield current
        for task in tasks:
            with suppress(OSError):
                waiting += map(int, read_small(f'/proc/{current}/task/{task}/children').split())


def read_small(path: str) -> bytes:
    """Read a small file of ``/proc`` with little overhead; a watchdog check reads about twenty."""
    file = os.open(path, os.O_RDONLY)
    try:
        return os.read(file, 1 << 16)
    finally:
        os.close(file)


def end_all() -> None:
    """Kill all descendants of this process, including any that start in the meantime."""
    while left := [*family(os.getpid())][1:]:
        for pid in left:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                continue
        reap()
    reap()


def reap() -> dict[int, int]:
    """Reap ended children and return their exit codes by pid; 128 + N after signal N."""
    ended: dict[int, int] = {}
    while True:
        try:
            pid, status = os.waitpid(-1, os.WNOHANG)
        except ChildProcessError:
            return ended
        if pid == 0:
            return ended
        code = os.waitstatus_to_exitcode(status)
        ended[pid] = code if code >= 0 else 128 - code


def main() -> None:
    """Start the program, wait until it ends, and kill every process that it left running."""
    rules, command = json.loads(sys.argv[1]), sys.argv[2:]
    grader, uid = os.getppid(), rules['uid'] or os.getuid()
    traced = list(tracing_files(uid))
    rules['read'] += traced
    prctl(PR_SET_CHILD_SUBREAPER, 1)
    prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    wanted = {signal.SIGTERM, signal.SIGCHLD}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, wanted)
    if os.getppid() != grader:
        sys.exit('the grader is gone')
    child = os.fork()
    if child == 0:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        try:
            os.setsid()
            give_up(rules, filter_of(rules))
            os.execvp(command[0], command)
        except OSError as error:
            sys.exit(f'confine: {error}')
    nothing = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(nothing, descriptor)
    code: int | None = None
    while code is None:
        if signal.sigwait(wanted) == signal.SIGTERM:
            code = 128 + int(signal.SIGTERM)
        else:
            code = reap().get(child)
    end_all()
    for path in traced:
        if rules['uid'] and path.endswith(f'-{uid}'):  # each run has a new uid
            os.unlink(path)
    os._exit(code)


if __name__ == '__main__':
    main()

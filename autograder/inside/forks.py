"""
Keep a Python process with rclpy loaded, and fork it to create the processes of each run.

Loading rclpy takes longer than the rest of most runs.  This process loads it once, before any node
or network exists, and serves many runs.  There is one such server for probes and one for students'
programs.

Only the grader can send orders to this process.  A fork enters the namespaces of its run.  Before
it reads a scenario or a student's file, it gives up its rights (:func:`confine.give_up`): it drops
its capabilities, loads the system-call filter and, as root, takes an unused uid.

From this project, this file imports only ``inside/``, because a sandbox contains few files of the
grader.
"""

from contextlib import suppress
import json
import os
import resource
import signal
import socket
import sys
from typing import Any

import confine  # type: ignore[import-not-found]  # next to this file

READY, BORN = b'ready', b'born'
ORDER_BYTES = 1 << 16
MOST_FILES = 16  # standard input, output and error; sockets of clock and launcher; namespaces


def serve() -> list[str]:
    """
    Fork a process for each order, one at a time, and report its exit code.

    Standard input is a socket of type SOCK_SEQPACKET, which keeps message boundaries.

    :returns: in each fork, the arguments of its program; the server never returns
    """
    grader = socket.socket(fileno=0)
    grader.send(READY)
    while True:
        order, files, _, _ = socket.recv_fds(grader, ORDER_BYTES, MOST_FILES)
        if not order:
            sys.exit()
        pid = os.fork()
        if pid == 0:
            return _set_up_fork(json.loads(order), grader, files)
        for file in files:
            os.close(file)
        _, status = os.waitpid(pid, 0)
        grader.send(b'%d' % os.waitstatus_to_exitcode(status))


def _set_up_fork(order: dict[str, Any], grader: socket.socket, files: list[int]) -> list[str]:
    """
    Turn this fork into a process of a run.

    :param order: ``argv``; ``variables`` of the environment; ``limits``, with the names of
        setrlimit(2) in lower case; ``rules`` for :func:`confine.give_up`, None to keep all
        rights; and ``folder``, the working folder of a student's program
    :param files: descriptors in this order: standard input, output and error; the socket for the
        virtual clock; for a student's program, the socket to its launcher; the namespaces to enter
    """
    try:
        given, *written = files[:3]
        for number, file in enumerate(written, 1):
            os.dup2(file, number)
        kept, namespaces = [given, *files[3:4]], files[4:]
        if order['folder']:
            kept.append(namespaces.pop(0))
        rules = order['rules']
        code = confine.filter_of(rules) if rules else b''  # the next lines can hide the file
        for namespace in namespaces:
            confine.call('setns', namespace, 0)
        os.environ.update(order['variables'])
        for name, value in order['limits'].items():
            resource.setrlimit(getattr(resource, f'RLIMIT_{name.upper()}'), (value, value))
        if rules:
            confine.give_up({**rules, 'inherited': kept}, code)
        if order['folder']:
            _begin_session(order['folder'], kept)
        grader.send(BORN)  # the kernel adds this process's id in the grader's namespace
        grader.detach()
        os.dup2(given, 0)
        os.close(given)
        confine.libc.join_virtual_clock(kept[1])  # in the clock's library, which is preloaded
        os.environ['VIRTUAL_CLOCK'] = str(kept[1])  # as if started with this place
    except BaseException as error:  # noqa: BLE001 - a fork must never return to the server's loop
        os.write(2, f'{type(error).__name__}: {error}\n'.encode(errors='replace'))
        os._exit(1)
    return list(order['argv'])


def _begin_session(folder: str, kept: list[int]) -> None:
    """
    Fork into the process namespace of the run, which only children enter: setns(2).

    The parent waits, and passes the exit code to the launcher, which ends with the same code.
    """
    launcher = kept.pop()
    pid = os.fork()
    if pid:
        os.closerange(0, launcher)
        os.closerange(launcher + 1, max(kept) + 1)
        code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        with suppress(OSError):  # the launcher has been killed
            os.write(launcher, b'%d\n' % (code if code >= 0 else 128 - code))
        os._exit(0)
    confine.prctl(confine.PR_SET_PDEATHSIG, signal.SIGKILL)
    # Do what execve(2) does: otherwise, a program whose uid has changed cannot read /proc/self.
    confine.prctl(confine.PR_SET_DUMPABLE, 1)
    os.close(launcher)
    os.setsid()
    os.chdir(folder)

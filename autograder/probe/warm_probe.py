"""
Keep a Python with rclpy ready, and make each run's probe a fork of it.

To load Python, rclpy and the middleware takes longer than a probe then works.  It is done here
once for each thread that runs submissions, before any node or participant is made.

This process stands in a sandbox of bubblewrap's, in a network where nobody else is, and takes
orders from the grader alone.  A fork joins the network of its run and then, before it reads a word
that concerns the run, gives up all that this process may do: it has processes, folders and shared
memory of its own, a uid that belongs to nobody, no capability, and the system calls that are left
to a student's program.  So a probe that is taken over by what a program sends is as alone, and as
short-lived, as one in a sandbox to itself.

This file imports nothing of this project but its neighbours: only their text enters the sandbox.
"""

from __future__ import annotations

import gc
import json
import os
import resource
import select
import signal
import socket
import struct
import threading
from typing import Any, NoReturn
import warnings

import probe  # type: ignore[import-not-found]  # beside this file; first, as it is lean

# isort: split
from rcl_interfaces.msg import Log
from rcl_interfaces.srv import GetParameters
from rclpy.type_support import check_for_type_support
from rclpy.utilities import get_rmw_implementation_identifier
from rosgraph_msgs.msg import Clock
from system_calls import (  # type: ignore[import-not-found]
    call,
    filter_calls,
    PR_CAPBSET_DROP,
    PR_SET_NO_NEW_PRIVS,
    PR_SET_PDEATHSIG,
    prctl,
)

# From sched.h, sys/mount.h and linux/capability.h.
CLONE_NEWNS, CLONE_NEWIPC, CLONE_NEWPID, CLONE_NEWNET = 0x20000, 0x8000000, 0x20000000, 0x40000000
MS_RDONLY, MS_NOSUID, MS_NODEV, MS_NOEXEC, MS_REMOUNT, MS_BIND = 1, 2, 4, 8, 32, 4096
CAPABILITIES_3 = 0x20080522  # their version: three sets of 64 bits
LAST_CAPABILITY = '/proc/sys/kernel/cap_last_cap'
SHARED, HOME = (b'/tmp', b'/dev/shm'), b'/tmp/home'
"""Folders that all forks would share, and the one that each gets for itself."""
FILTER = '/grader/filter.bpf'
"""What a student's program may not ask of the kernel, and a probe neither."""
READY, BORN = b'ready', b'born'
ORDER_BYTES = 4096
FILES = 4  # that come with an order: the network, and the probe's input, output and errors


def main() -> None:
    """Load what every probe needs, then serve the grader until it is gone."""
    get_rmw_implementation_identifier()  # loads the middleware, and makes nothing of it yet
    for kind in (Clock, Log, GetParameters):
        check_for_type_support(kind)
    # Python says that a fork of several threads is dangerous; see wait_until_alone().
    warnings.filterwarnings('ignore', 'This process .* is multi-threaded', DeprecationWarning)
    gc.collect()
    gc.freeze()  # a fork would copy what its garbage collector looks at
    with socket.socket(fileno=0) as grader:
        grader.send(READY)
        serve(grader)


def serve(grader: socket.socket) -> None:
    """
    Make a probe for each order, and tell how it has ended.

    :param grader: a socket that keeps messages apart
    """
    own = os.open('/proc/self/ns/pid', os.O_RDONLY | os.O_CLOEXEC)
    while True:
        order, files, _, _ = socket.recv_fds(grader, ORDER_BYTES, FILES)
        if not order:
            return
        wait_until_alone()
        call('unshare', CLONE_NEWPID)  # for the fork, not for this process
        pid = os.fork()
        if pid == 0:
            become(json.loads(order), grader, files)
        call('setns', own, CLONE_NEWPID)
        for file in files:
            os.close(file)
        _, status = os.waitpid(pid, 0)
        grader.send(b'%d' % os.waitstatus_to_exitcode(status))


def wait_until_alone() -> None:
    """
    Wait until no other thread of this process runs: a fork would keep the locks that it holds.

    The tracer that rclpy is linked with has two, which begin to wait for a daemon that cannot be
    in here, and wait for ever.
    """
    this = threading.get_native_id()
    while any(_runs(int(task)) for task in os.listdir('/proc/self/task') if int(task) != this):
        select.select((), (), (), 0.001)  # there is no event for it


def _runs(task: int) -> bool:
    try:
        with open(f'/proc/self/task/{task}/stat', encoding='ascii') as file:
            return file.read().rpartition(') ')[2][0] != 'S'
    except OSError:
        return False  # it has just ended


def become(order: dict[str, Any], grader: socket.socket, files: list[int]) -> NoReturn:
    """
    Become the probe of a run.

    :param order: ``uid``; ``folder``, the size of its own folder [bytes]; and ``limits`` by
        the names of setrlimit(2) in small letters
    :param files: descriptors of the network and of standard input, output and error
    """
    code = 1
    try:
        network, given, *written = files
        for number, file in enumerate(written, 1):
            os.dup2(file, number)
        os.setsid()  # in no group with its maker
        confine(order, network)
        grader.send(BORN)  # the kernel adds the pid, as the grader sees it
        grader.detach()
        os.dup2(given, 0)
        os.closerange(3, max(files) + 1)
        probe.main()
        code = 0
    except BaseException as error:  # noqa: BLE001 - from here no way leads back into the loop
        os.write(2, f'{type(error).__name__}: {error}\n'.encode(errors='replace'))
    finally:
        os._exit(code)


def confine(order: dict[str, Any], network: int) -> None:
    """
    Join the network of a run, and give up everything else.

    :raises OSError: if the kernel refuses, with the name of the call
    """
    call('setns', network, CLONE_NEWNET)
    call('unshare', CLONE_NEWNS | CLONE_NEWIPC)
    plain = MS_NOSUID | MS_NODEV | MS_NOEXEC
    # Not over the shared folders themselves: Python and the course may be below one of them.
    for folder in SHARED:
        call('mount', None, folder, None, MS_REMOUNT | MS_BIND | MS_RDONLY | plain, None)
    size = f'mode=1777,size={order["folder"]}'.encode()
    call('mount', b'tmpfs', HOME, b'tmpfs', plain, size)
    call('mount', b'proc', b'/proc', b'proc', plain, None)
    for name, value in order['limits'].items():
        resource.setrlimit(getattr(resource, f'RLIMIT_{name.upper()}'), (value, value))
    with open(LAST_CAPABILITY, encoding='ascii') as file:
        for number in range(int(file.read()) + 1):
            prctl(PR_CAPBSET_DROP, number)
    uid = order['uid']
    os.setgroups([])
    os.setresgid(uid, uid, uid)
    os.setresuid(uid, uid, uid)  # what it may do goes with it, what it could pass on does not
    call('capset', struct.pack('Ii', CAPABILITIES_3, 0), bytes(24))
    prctl(PR_SET_NO_NEW_PRIVS, 1)
    prctl(PR_SET_PDEATHSIG, int(signal.SIGKILL))  # it ends with its maker
    os.chdir(HOME)
    with open(FILTER, 'rb') as code:
        filter_calls(code.read())


if __name__ == '__main__':
    main()

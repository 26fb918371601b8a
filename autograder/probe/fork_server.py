"""
Keep a Python process with rclpy loaded, and fork it to create the probe of each run.

Loading rclpy takes longer than the work of a probe.  This process loads it once, before any node
or network exists, and serves many runs.

Only the grader can send orders to this process.  A fork enters the network of its run.  Before it
reads the scenario, it gives up its rights (:func:`confine.give_up`): it gets an unused uid, no
capabilities, and the system-call filter of the students' programs.

From this project, this file imports only ``probe/`` and ``inside/``, because the sandbox contains
no other file of the grader.
"""

from __future__ import annotations

import ctypes
import gc
import json
import os
import resource
import socket
from typing import Any, NoReturn

import probe  # type: ignore[import-not-found]  # first, because it calls lean()

# isort: split
import confine  # type: ignore[import-not-found]  # in inside/
from probe_wire import load_type  # type: ignore[import-not-found]

READY, BORN = b'ready', b'born'
ORDER_BYTES = 1 << 16
MOST_FILES = 8  # standard input, output and error; the socket of the clock; namespaces
EVERY_RUN = ('rcl_interfaces/msg/Log', 'rcl_interfaces/srv/GetParameters', 'std_msgs/msg/String')
libc = ctypes.CDLL(None, use_errno=True)  # includes the clock's library, which is preloaded


def main() -> None:
    """Load the message types that every probe needs, then serve the grader until it exits."""
    for name in EVERY_RUN:
        load_type(name).__class__.__import_type_support__()
    gc.freeze()  # a garbage collection in a fork would copy the memory pages that it visits
    with socket.socket(fileno=0) as grader:
        grader.send(READY)
        serve(grader)


def serve(grader: socket.socket) -> None:
    """
    Fork a probe for each order, one at a time, and report its exit code.

    :param grader: socket of type SOCK_SEQPACKET, which keeps message boundaries
    """
    while True:
        order, files, _, _ = socket.recv_fds(grader, ORDER_BYTES, MOST_FILES)
        if not order:
            return
        pid = os.fork()
        if pid == 0:
            become(json.loads(order), grader, files)
        for file in files:
            os.close(file)
        _, status = os.waitpid(pid, 0)
        grader.send(b'%d' % os.waitstatus_to_exitcode(status))


def become(order: dict[str, Any], grader: socket.socket, files: list[int]) -> NoReturn:
    """
    Turn this fork into the probe of a run.

    :param order: ``variables`` of the environment; ``limits``, with the names of setrlimit(2) in
        lower case; and ``rules`` for :func:`confine.give_up`, None to keep all rights
    :param files: descriptors of standard input, output and error, of the probe's socket for the
        virtual clock, and of the namespaces to enter
    """
    code = 1
    try:
        given, *written = files[:3]
        for number, file in enumerate(written, 1):
            os.dup2(file, number)
        place, *namespaces = files[3:]
        for namespace in namespaces:
            enter(namespace)
        os.environ.update(order['variables'])
        for name, value in order['limits'].items():
            resource.setrlimit(getattr(resource, f'RLIMIT_{name.upper()}'), (value, value))
        if order['rules'] is not None:
            confine.give_up({**order['rules'], 'inherited': [given, place]})
        grader.send(BORN)  # the kernel adds this process's id in the grader's namespace
        os.dup2(given, 0)
        os.close(given)
        libc.join_virtual_clock(place)
        probe.main()
        code = 0
    except BaseException as error:  # noqa: BLE001 - a fork must never return to the server's loop
        os.write(2, f'{type(error).__name__}: {error}\n'.encode(errors='replace'))
    finally:
        os._exit(code)


def enter(namespace: int) -> None:
    """
    Enter the namespace that a descriptor names.

    :raises OSError: if the kernel refuses
    """
    if libc.setns(namespace, 0) != 0:
        raise OSError(ctypes.get_errno(), f'setns: {os.strerror(ctypes.get_errno())}')


if __name__ == '__main__':
    main()

"""
Keep a Python with rclpy loaded, and make the probe of each run a fork of it.

Loading rclpy takes longer than a probe then works.  Here it is done once, before there is any node
or network, and the next run uses the same process.

This process takes orders from the grader alone.  A fork joins the network of its run.  Before it
reads a word about the run, it gives up its rights, see :func:`confine.give_up`: it gets a uid that
belongs to nobody, no capability, and the system-call filter of the students' programs.

This file imports nothing of this project but its neighbours: only their text enters the sandbox.
"""

from __future__ import annotations

import ctypes
import gc
import json
import os
import resource
import socket
from typing import Any, NoReturn

import probe  # type: ignore[import-not-found]  # beside this file; first, because it is lean

# isort: split
import confine  # type: ignore[import-not-found]  # of the programs in the sandbox
from probe_wire import load_type  # type: ignore[import-not-found]

READY, BORN = b'ready', b'born'
ORDER_BYTES = 1 << 16
MOST_FILES = 8  # standard input, output and error; the place on the clock; namespaces
EVERY_RUN = ('rcl_interfaces/msg/Log', 'rcl_interfaces/srv/GetParameters', 'std_msgs/msg/String')
libc = ctypes.CDLL(None, use_errno=True)  # and the library of the clock, which is loaded into it


def main() -> None:
    """Load what every probe needs, then serve the grader until it is gone."""
    for name in EVERY_RUN:
        load_type(name).__class__.__import_type_support__()
    gc.freeze()  # a collection in a fork would copy what it looks at
    with socket.socket(fileno=0) as grader:
        grader.send(READY)
        serve(grader)


def serve(grader: socket.socket) -> None:
    """
    Make a probe for each order, one at a time, and report its exit code.

    :param grader: a socket that keeps messages apart
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
    Become the probe of a run.

    :param order: ``variables``; ``limits`` by the names of setrlimit(2) in small letters; and
        ``rules`` for :func:`confine.give_up`, None if it keeps its rights
    :param files: descriptors of standard input, output and error, of the place on the clock, and
        of the namespaces to enter
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
        grader.send(BORN)  # the kernel adds the process id, as the grader sees it
        os.dup2(given, 0)
        os.close(given)
        libc.join_virtual_clock(place)
        probe.main()
        code = 0
    except BaseException as error:  # noqa: BLE001 - from here no way leads back into the loop
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

"""
What the course's notebooks import.

``import roslab`` in a notebook makes the cell magics ``%%node``, ``%%rosmsg`` and ``%%rospkg``
known.  ROS 2 itself is started by the first call that needs it.
"""

from __future__ import annotations

from typing import Any

from roslab.api import listen, logs, nodes, start, stop, stop_all, wait_until
from roslab.checking import check
from roslab.errors import NameRefusedError, NotHereError, RoslabError
from roslab.interrupts import watch_cells
from roslab.logtable import record_logs
from roslab.magics import register
from roslab.messages import build_messages
from roslab.output import settle, shell
from roslab.package_files import package

__all__ = [
    'NameRefusedError',
    'NotHereError',
    'RoslabError',
    'build_messages',
    'check',
    'listen',
    'logs',
    'nodes',
    'package',
    'start',
    'stop',
    'stop_all',
    'wait_until',
]


def load_ipython_extension(ipython: Any) -> None:
    """Serve ``%load_ext roslab``, which does what the import does."""
    register(ipython)


_shell = shell()
if _shell is not None:
    register(_shell)
    watch_cells(_shell)
    record_logs()
    _shell.events.register('post_run_cell', settle)

"""
The functions that the course's notebooks import.

``import roslab`` in a notebook registers the cell magics ``%%node``, ``%%rosmsg``, ``%%rospkg``
and ``%%answer``.  ROS 2 itself is started by the first call that needs it.
"""

import os
from typing import Any

from roslab import error_hints
from roslab.callback_picture import watch_callbacks
from roslab.checking import check
from roslab.errors import NameRefusedError, NotHereError, RoslabError
from roslab.gallery import explain
from roslab.graph_picture import graph
from roslab.interrupts import watch_cells
from roslab.introspection import echo, hz, info, topics
from roslab.lifecycle_picture import lifecycle
from roslab.listening import listen
from roslab.live_picture import paint_all
from roslab.live_plot import plot
from roslab.logtable import logs, record_logs
from roslab.magics import refuse_programs, register
from roslab.messages import build_messages
from roslab.output import shell
from roslab.own_kernel import claim_domain, domain, require_variables
from roslab.package_files import package
from roslab.pages import lay_out
from roslab.progress import answer, progress
from roslab.qos_table import qos_table
from roslab.quiz import quiz
from roslab.recording import record, replay
from roslab.robot import robot
from roslab.session import nodes, start, stop, stop_all, wait_until
from roslab.simulating import recorded_runs, simulate
from roslab.spinning import make_spinning_interruptible, refuse_to_spin_twice
from roslab.timeline_picture import timeline

__all__ = [
    'NameRefusedError',
    'NotHereError',
    'RoslabError',
    'answer',
    'build_messages',
    'check',
    'domain',
    'echo',
    'explain',
    'graph',
    'hz',
    'info',
    'lifecycle',
    'listen',
    'logs',
    'nodes',
    'package',
    'plot',
    'progress',
    'qos_table',
    'quiz',
    'record',
    'recorded_runs',
    'replay',
    'robot',
    'simulate',
    'start',
    'stop',
    'stop_all',
    'timeline',
    'topics',
    'wait_until',
    'watch_callbacks',
]


def load_ipython_extension(ipython: Any) -> None:
    """Support ``%load_ext roslab``, which has the same effect as ``import roslab``."""
    register(ipython)


_shell = shell()
if _shell is not None:
    require_variables(os.environ)
    claim_domain(_shell)
    register(_shell)
    refuse_programs(_shell)
    watch_cells(_shell)
    record_logs()
    _shell.events.register('post_run_cell', paint_all)
    lay_out(_shell)
    make_spinning_interruptible()
    refuse_to_spin_twice()
    error_hints.load_ipython_extension(_shell)

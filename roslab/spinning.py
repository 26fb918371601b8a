"""
Make ``rclpy.spin`` and similar functions work in a cell.

Three things that work in a program fail in a notebook.  This module corrects them for the kernel's
main thread:

* A wait without a time limit never returns to Python, so Interrupt has no effect.  rclpy has a
  SIGINT handler for this case, but the kernel installs Python's own handler for each cell.  So
  waits are divided into short slices.
* ``rclpy.init`` in a cell installs a handler that shuts ROS down when the cell is interrupted, and
  then every later cell fails.  In a notebook, ROS is shut down only when the kernel ends.
* ``rclpy.spin(node)`` takes the node away from the background executor; after an interrupt, no
  executor serves the node.  So the call is refused, with advice.
"""

import threading
import time
from typing import Any

import rclpy
from rclpy.executors import Executor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from roslab.errors import RoslabError
from roslab.executor import BackgroundExecutor

_SLICE_NS = 50_000_000
"""Maximum time for which an interrupt may remain unnoticed [ns]."""
_ENTITIES = ('subscription', 'guard_condition', 'timer', 'client', 'service')
_WaitSet: Any = rclpy_implementation.WaitSet


class InterruptibleWaitSet(_WaitSet):  # type: ignore[misc]
    """A wait set that regularly returns to Python while it waits in the main thread."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self._added: list[tuple[Any, Any]] = []
        self._complete = sum(arguments[:6])

    def wait(self, timeout_ns: int) -> None:
        """
        Wait until something is ready.

        A wait set drops entities that were not ready, so all entities are added again after each
        slice.  Entities that C code added cannot be added again.  If there are any, this method
        returns early with nothing ready, and the executor tries again.

        :param timeout_ns: how long to wait, negative for no limit [ns]
        """
        if threading.current_thread() is not threading.main_thread():
            super().wait(timeout_ns)
            return
        end = time.monotonic_ns() + timeout_ns
        while True:
            left = end - time.monotonic_ns() if timeout_ns >= 0 else _SLICE_NS
            super().wait(max(0, min(left, _SLICE_NS)))
            over = timeout_ns >= 0 and left <= _SLICE_NS
            if over or len(self._added) != self._complete or self._anything_ready():
                return
            super().clear_entities()
            for add, handle in self._added:
                add(handle)

    def clear_entities(self) -> None:
        """Remove all added entities."""
        self._added.clear()
        super().clear_entities()

    def _anything_ready(self) -> bool:
        return any(self.get_ready_entities(kind) for kind in _ENTITIES)


def _adder(kind: str) -> Any:
    original = getattr(_WaitSet, f'add_{kind}')

    def add(self: Any, handle: Any) -> Any:
        self._added.append((original.__get__(self), handle))
        return original(self, handle)

    return add


for _kind in _ENTITIES:
    setattr(InterruptibleWaitSet, f'add_{_kind}', _adder(_kind))


def make_spinning_interruptible() -> None:
    """Make waits in this process's main thread interruptible without shutting ROS down."""
    rclpy_implementation.WaitSet = InterruptibleWaitSet
    # rclpy.init looks up this name in its module; without the handler, SIGTERM still ends a
    # kernel.
    rclpy.install_signal_handlers = lambda *_: None


def refuse_to_spin_twice() -> None:
    """Make other executors reject a node that runs in the background."""
    original = Executor.add_node

    def add_node(self: Executor, node: Node) -> bool:
        serving = getattr(node, 'executor', None)
        if isinstance(serving, BackgroundExecutor) and serving is not self:
            raise RoslabError(
                f'{node.get_name()} runs already: start(...) spins it in the background, so this '
                'cell need not. Remove this call; to wait for something, use '
                'wait_until(lambda: ...).'
            )
        return original(self, node)

    Executor.add_node = add_node  # type: ignore[method-assign]

"""
The background executor of a kernel.

A single thread serves all nodes of a notebook, one callback at a time, like a program that calls
``rclpy.spin``.  Two things differ from ``SingleThreadedExecutor``.  An exception in a callback is
passed to a handler function instead of ending the loop.  Other threads can request actions between
two callbacks, so that entities are added and destroyed while no wait set uses them.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager, suppress
import ctypes
from queue import Empty, SimpleQueue
import threading
import time
from typing import Any

from rclpy.context import Context
from rclpy.executors import (
    ConditionReachedException,
    Executor,
    ExternalShutdownException,
    ShutdownException,
    TimeoutException,
)
from rclpy.node import Node
from rclpy.task import Future

OnFailure = Callable[[Node | None, BaseException], None]
Around = Callable[[Node | None], AbstractContextManager[None]]

_MOST_FAILURES_IN_A_ROW = 100
_PATIENCE_S = 1.0
"""How long to wait for a running callback [s]."""
_SLICE_S = 0.05
"""Time between two checks of a condition while no callback runs, as during discovery [s]."""


def force_destroy(node: Node) -> None:
    """
    Destroy a node at once, even if something still refers to it.

    rclpy leaves the state machine of a lifecycle node to the garbage collector.  Until then, the
    node's name, topics and services would stay in the graph.
    """
    node.destroy_node()
    if hasattr(node, '_state_machine'):
        node._state_machine = None


class CallbackStopped(BaseException):
    """Raised inside a callback that does not return, to free the executor thread."""


class Progress:
    """
    Wakes waiting cells each time a callback has run.

    It uses queues implemented in C, not a condition variable.  An interrupt of the kernel may
    happen at any instruction of the waiting cell; it must never leave a lock held that callbacks
    need.
    """

    def __init__(self) -> None:
        self._waiting: set[SimpleQueue[None]] = set()

    def notify(self) -> None:
        """Wake all waiters."""
        for waiter in tuple(self._waiting):
            if waiter.empty():
                waiter.put(None)

    def wait(self, reached: Callable[[], Any], timeout_s: float) -> Any:
        """
        Return the value of ``reached`` as soon as it is true, or its last value after the timeout.

        :param reached: called in this thread, after each callback and at least every ``_SLICE_S``:
            discovery runs in the background without a callback, so only another call of
            ``reached`` sees its results
        """
        waiter: SimpleQueue[None] = SimpleQueue()
        end = time.monotonic() + timeout_s
        self._waiting.add(waiter)
        try:
            while not (value := reached()) and (left := end - time.monotonic()) > 0:
                with suppress(Empty):
                    waiter.get(timeout=min(left, _SLICE_S))
            return value
        finally:
            self._waiting.discard(waiter)


class BackgroundExecutor(Executor):
    """
    A daemon thread that runs callbacks one at a time, and survives their exceptions.

    :param on_failure: called in the thread with the node and its callback's exception
    :param progress: notified in the thread after each callback and request
    :param around: given a node, returns the context manager to enter for each of its callbacks
    """

    def __init__(
        self, context: Context, on_failure: OnFailure, progress: Progress, around: Around
    ) -> None:
        super().__init__(context=context)
        self._on_failure = on_failure
        self._progress = progress
        self._around = around
        self._asked: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self.running: tuple[Node | None, float] | None = None
        """The node whose callback is running and its start time (``time.monotonic``), or None."""
        self._stopping = False
        self._thread = threading.Thread(
            target=self._spin_until_stopped, name='roslab executor', daemon=True
        )
        self._thread.start()

    def ask(self, request: Callable[[], None]) -> None:
        """Request an action between two callbacks; safe in any thread and in finalizers."""
        self._asked.put(request)
        self.wake()

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Run the requested actions, then wait for one callback and run it."""
        while not self._asked.empty():
            self._asked.get()()
            self._progress.notify()
        try:
            task, _, node = self.wait_for_ready_callbacks(
                timeout_sec, None, lambda: not self._asked.empty()
            )
        except (ConditionReachedException, ShutdownException, TimeoutException):
            return
        self._run(task, node)

    def spin_once_until_future_complete(
        self, future: Future, timeout_sec: Any | None = None
    ) -> None:
        """Do the same as :meth:`spin_once`."""
        future.add_done_callback(lambda _: self.wake())
        self.spin_once(timeout_sec)

    def _run(self, task: Any, node: Node | None) -> None:
        self.running = (node, time.monotonic())
        try:
            with self._around(node):
                task()
            failure = task.exception()
        except BaseException as stop:  # a task stores an Exception but does not catch SystemExit
            task.cancel()
            failure = stop
        finally:
            self.running = None
        if failure is not None:
            self._on_failure(node, failure)
        self._progress.notify()

    @property
    def alive(self) -> bool:
        """Return whether the thread is running callbacks."""
        return self._thread.is_alive() and not self._stopping and self.context.ok()

    @property
    def is_this_thread(self) -> bool:
        """Return whether the caller runs in the executor thread, as callbacks do."""
        return threading.current_thread() is self._thread

    def add(self, node: Node) -> None:
        """Start serving a node."""
        if not self._do(lambda: self.add_node(node), _PATIENCE_S):
            self.add_node(node)

    def destroy(self, node: Node) -> None:
        """Stop serving a node and destroy it, even if its callback does not return."""

        def go() -> None:
            self.remove_node(node)
            force_destroy(node)

        if self._do(go, _PATIENCE_S):
            return
        running = self.running
        if running is not None and running[0] is node:
            self._break_callback()
        # Try again, because the thread may only have been slow.  Destroying a node twice is
        # harmless.
        if not self._do(go, _PATIENCE_S):
            go()  # a callback still blocks the thread, so no wait set is in use

    def stop(self) -> None:
        """Stop the thread, if its callback ends."""
        self._stopping = True
        self.ask(lambda: None)
        self._thread.join(_PATIENCE_S)
        if self._thread.is_alive():
            self._break_callback()
            self._thread.join(_PATIENCE_S)
        if not self._thread.is_alive():
            self.shutdown()

    def _do(self, action: Callable[[], object], patience_s: float) -> bool:
        """Run an action in the thread; return False if it was withdrawn after the timeout."""
        if self.is_this_thread or not self._thread.is_alive():
            action()
            return True
        request = _Request(action)
        self.ask(request)
        return request.wait(patience_s)

    def _break_callback(self) -> None:
        """Raise :class:`CallbackStopped` at the next Python line that the thread executes."""
        ctypes.pythonapi.PyThreadState_SetAsyncExc(
            ctypes.c_ulong(self._thread.ident or 0), ctypes.py_object(CallbackStopped)
        )

    def _spin_until_stopped(self) -> None:
        failures = 0
        while not self._stopping and self.context.ok():
            try:
                self.spin_once()
                failures = 0
            except ExternalShutdownException:
                return
            except CallbackStopped:
                continue  # the exception arrived after the callback had returned
            except Exception as error:
                # A cell destroyed a node while the wait set was built; the next round succeeds.
                failures += 1
                if failures >= _MOST_FAILURES_IN_A_ROW:
                    print(f'roslab: the executor stopped. {type(error).__name__}: {error}')
                    return


class _Request:
    """
    An action that is either run by the executor or withdrawn by the requester, never both.

    It uses queues, not a future, whose lock could remain held after a :class:`CallbackStopped`.
    """

    def __init__(self, action: Callable[[], object]) -> None:
        self._action = action
        self._tickets: SimpleQueue[None] = SimpleQueue()
        self._tickets.put(None)
        self._done: SimpleQueue[BaseException | None] = SimpleQueue()

    def __call__(self) -> None:
        """Run the action unless it was withdrawn."""
        try:
            self._tickets.get_nowait()
        except Empty:
            return
        error = None
        try:
            try:
                self._action()
            except CallbackStopped:  # intended for a callback that has already returned
                self._action()
        except Exception as raised:
            error = raised
        self._done.put(error)

    def wait(self, timeout_s: float) -> bool:
        """Wait until the action has run; withdraw it after the timeout."""
        try:
            error = self._done.get(timeout=timeout_s)
        except Empty:
            with suppress(Empty):
                self._tickets.get_nowait()
                return False
            error = None  # the action is already running and counts as completed
        if error is not None:
            raise error
        return True

"""
The background executor of a kernel.

All nodes of a notebook are served by a single thread, one callback at a time, like a program that
calls ``rclpy.spin``.  Two things differ from ``SingleThreadedExecutor``: an exception in a
callback goes to a function instead of ending the loop, and other threads can request actions
between two callbacks, so that entities are added and destroyed while no wait set holds them.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext, suppress
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


def destroy_wholly(node: Node) -> None:
    """
    Destroy a node at once, even if something still refers to it.

    rclpy leaves the state machine of a lifecycle node to the garbage collector, and with it the
    node's name, topics and services in the graph.
    """
    node.destroy_node()
    if hasattr(node, '_state_machine'):
        node._state_machine = None


class CallbackStopped(BaseException):
    """Raised inside a callback that does not return, to free its thread."""


class Progress:
    """
    Wakes waiting cells each time a callback has run.

    Built on queues in C instead of a condition variable: an interrupt of the kernel may happen at
    any instruction of the waiting cell, and must never leave a lock locked that callbacks need.
    """

    def __init__(self) -> None:
        self._waiting: set[SimpleQueue[None]] = set()

    def notify(self) -> None:
        """Wake all waiters."""
        for waiter in tuple(self._waiting):
            if waiter.empty():
                waiter.put(None)

    def wait(self, reached: Callable[[], Any], timeout_s: float, slice_s: float) -> Any:
        """
        Return the value of ``reached`` as soon as it is true, or its last value at the end.

        :param reached: called in this thread, after each callback and at least once each slice
        :param timeout_s: how long to wait [s]
        :param slice_s: the longest time between two looks [s]; discovery runs in the background
            without a callback, so only another look shows its results
        """
        waiter: SimpleQueue[None] = SimpleQueue()
        end = time.monotonic() + timeout_s
        self._waiting.add(waiter)
        try:
            while not (value := reached()) and (left := end - time.monotonic()) > 0:
                with suppress(Empty):
                    waiter.get(timeout=min(left, slice_s))
            return value
        finally:
            self._waiting.discard(waiter)


class GuardedExecutor(Executor):
    """
    Runs callbacks one at a time and survives their exceptions.

    :param context: the context of all its nodes
    :param on_failure: called in the spinning thread with the node and what its callback raised
    :param on_progress: called in the spinning thread after each callback and request
    :param around: returns the context manager that is entered for each callback of a node
    """

    def __init__(
        self,
        *,
        context: Context,
        on_failure: OnFailure,
        on_progress: Callable[[], None],
        around: Around = lambda _: nullcontext(),
    ) -> None:
        super().__init__(context=context)
        self._on_failure = on_failure
        self._on_progress = on_progress
        self._around = around
        self._asked: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self.running: tuple[Node | None, float] | None = None
        """The node whose callback runs now and since when (``time.monotonic``), or None."""

    def ask(self, request: Callable[[], None]) -> None:
        """Request an action between two callbacks; safe in any thread and in finalizers."""
        self._asked.put(request)
        self.wake()

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """
        Run the requested actions, then wait for one callback and run it.

        :param timeout_sec: how long to wait [s], None for as long as it takes
        """
        while not self._asked.empty():
            self._asked.get()()
            self._on_progress()
        try:
            task, _, node = self.wait_for_ready_callbacks(timeout_sec, None, self._is_asked)
        except (ConditionReachedException, ShutdownException, TimeoutException):
            return
        self._run(task, node)

    def spin_once_until_future_complete(
        self, future: Future, timeout_sec: Any | None = None
    ) -> None:
        """
        Do the same as :meth:`spin_once`.

        :param future: wakes this executor when it is done
        :param timeout_sec: how long to wait [s]
        """
        future.add_done_callback(lambda _: self.wake())
        self.spin_once(timeout_sec)

    def _is_asked(self) -> bool:
        return not self._asked.empty()

    def _run(self, task: Any, node: Node | None) -> None:
        self.running = (node, time.monotonic())
        try:
            with self._around(node):
                task()
            failure = task.exception()
        except BaseException as stop:  # a task stores an Exception but lets SystemExit through
            task.cancel()
            failure = stop
        finally:
            self.running = None
        if failure is not None:
            self._on_failure(node, failure)
        self._on_progress()


class BackgroundExecutor:
    """
    A daemon thread that spins one :class:`GuardedExecutor` until it is stopped.

    :param context: an initialised context
    :param on_failure: see :class:`GuardedExecutor`
    :param progress: notified after each callback
    :param around: see :class:`GuardedExecutor`
    """

    def __init__(
        self,
        context: Context,
        on_failure: OnFailure,
        progress: Progress,
        around: Around = lambda _: nullcontext(),
    ) -> None:
        self.context = context
        self._stopping = False
        self._executor = GuardedExecutor(
            context=context, on_failure=on_failure, on_progress=progress.notify, around=around
        )
        self._thread = threading.Thread(target=self._spin, name='roslab executor', daemon=True)
        self._thread.start()

    @property
    def alive(self) -> bool:
        """Return whether callbacks are being run."""
        return self._thread.is_alive() and not self._stopping and self.context.ok()

    @property
    def is_this_thread(self) -> bool:
        """Return whether the caller is a callback."""
        return threading.current_thread() is self._thread

    @property
    def running(self) -> tuple[Node | None, float] | None:
        """The node whose callback runs now and since when (``time.monotonic``), or None."""
        return self._executor.running

    def add(self, node: Node) -> None:
        """Serve a node."""
        self._between_callbacks(lambda: self._executor.add_node(node))

    def destroy(self, node: Node, patience_s: float = 1.0) -> None:
        """
        Stop serving a node and destroy it, even if its callback does not return.

        :param patience_s: how long a running callback may still take [s]
        """

        def go() -> None:
            self._executor.remove_node(node)
            destroy_wholly(node)

        if self._do(go, patience_s):
            return
        running = self.running
        if running is not None and running[0] is node:
            self._break_callback()
        # Try again, because the thread may only have been slow.  Destroying a node twice is
        # harmless.
        if not self._do(go, patience_s):
            go()  # another node blocks the thread, so no wait set is in use

    def ask(self, request: Callable[[], None]) -> None:
        """Request an action between two callbacks, without waiting for it."""
        self._executor.ask(request)

    def stop(self, patience_s: float = 1.0) -> bool:
        """
        End the thread.

        :param patience_s: how long a running callback may still take [s]
        :returns: whether the thread has ended
        """
        self._stopping = True
        self._executor.ask(lambda: None)
        self._thread.join(patience_s)
        if self._thread.is_alive():
            self._break_callback()
            self._thread.join(patience_s)
        if not self._thread.is_alive():
            self._executor.shutdown()
        return not self._thread.is_alive()

    def _between_callbacks(self, action: Callable[[], object], patience_s: float = 1.0) -> None:
        if not self._do(action, patience_s):
            action()

    def _do(self, action: Callable[[], object], patience_s: float) -> bool:
        """Run an action in the thread; False means that it was withdrawn, not run."""
        if self.is_this_thread or not self._thread.is_alive():
            action()
            return True
        request = _Request(action)
        self._executor.ask(request)
        return request.wait(patience_s)

    def _break_callback(self) -> None:
        """Raise :class:`CallbackStopped` at the next line of Python that the thread executes."""
        ctypes.pythonapi.PyThreadState_SetAsyncExc(
            ctypes.c_ulong(self._thread.ident or 0), ctypes.py_object(CallbackStopped)
        )

    def _spin(self) -> None:
        failures = 0
        while not self._stopping and self.context.ok():
            try:
                self._executor.spin_once()
                failures = 0
            except ExternalShutdownException:
                return
            except CallbackStopped:
                continue  # arrived after the callback had already returned
            except Exception as error:
                # A cell destroyed a node while the wait set was built; the next round succeeds.
                failures += 1
                if failures >= _MOST_FAILURES_IN_A_ROW:
                    print(f'roslab: the executor stopped. {type(error).__name__}: {error}')
                    return


class _Request:
    """An action that either the executor runs or the requester withdraws, never both."""

    def __init__(self, action: Callable[[], object]) -> None:
        self._action = action
        self._tickets: SimpleQueue[None] = SimpleQueue()
        self._tickets.put(None)
        self._done: SimpleQueue[BaseException | None] = SimpleQueue()

    def __call__(self) -> None:
        """Run the action if it was not withdrawn."""
        try:
            self._tickets.get_nowait()
        except Empty:
            return
        try:
            self._carry_out()
        except Exception as error:
            self._done.put(error)
        else:
            self._done.put(None)

    def _carry_out(self) -> None:
        try:
            self._action()
        except CallbackStopped:  # intended for a callback that has already returned
            self._action()

    def wait(self, timeout_s: float) -> bool:
        """
        Wait until the action has run; withdraw it after the timeout.

        :returns: whether it ran
        """
        try:
            error = self._done.get(timeout=timeout_s)
        except Empty:
            with suppress(Empty):
                self._tickets.get_nowait()
                return False
            error = None  # the action is running and counts as done
        if error is not None:
            raise error
        return True

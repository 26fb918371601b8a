"""
Manage the ROS 2 session of a kernel: its context, its executor, its nodes, and waits for them.

Each kernel has one :class:`Session`, created by :func:`session`.  At exit, the session destroys
its nodes and shuts the context down, because a process that ends with live nodes leaves its shared
memory behind.

A node whose callback raises an exception is stopped and destroyed, just as its program would end
in a terminal.  The other nodes continue.  To get the node back, start it again.
"""

import atexit
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, suppress
import math
import time
import traceback
from typing import Any, NamedTuple, TypeVar

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rclpy.subscription import Subscription
from rclpy.utilities import get_default_context

from roslab.errors import NotHereError, RoslabError, shown_as
from roslab.executor import BackgroundExecutor, CallbackStopped, force_destroy, Progress
from roslab.interrupts import HeldInterrupts
from roslab.logtable import record_logs
from roslab.output import say
from roslab.pages import output_below, Page, page_here
from roslab.replace_node import constructing, Construction, key_of
from roslab.tracebacks import last_line, short_traceback

HELPER_NAME = '_roslab'
"""Node that owns the subscriptions of :func:`roslab.listen`; its leading underscore hides it."""

T = TypeVar('T')

_SLOW_CALLBACK_S = 1.0
_WRITE_IT = '\n  Replace that line with your own code, run its cell, then run this one again.'


class Started(NamedTuple):
    """A node and the page of the cell that started it."""

    node: Node
    page: Page | None


class Session:
    """Nodes that run in the background of a kernel."""

    def __init__(self) -> None:
        self.progress = Progress()
        self._background: BackgroundExecutor | None = None
        self._helper: Node | None = None
        self._started: dict[str, Started] = {}
        self._lost: dict[str, str] = {}
        # A thread that still spins while the interpreter shuts down would abort the process.
        atexit.register(self.close)

    @property
    def executor(self) -> BackgroundExecutor:
        """The running executor; the first use initialises ROS."""
        with HeldInterrupts():
            background = self._background
            if background is None or not background.alive:
                self.close()
                record_logs()
                background = BackgroundExecutor(
                    self._context(), self._on_failure, self.progress, self._output_below_cell
                )
                self._background = background
            return background

    @property
    def helper(self) -> Node:
        """A hidden node that owns the subscriptions of the notebook itself."""
        with HeldInterrupts():
            executor = self.executor
            if self._helper is None:
                self._helper = Node(
                    HELPER_NAME,
                    context=executor.context,
                    start_parameter_services=False,
                    enable_rosout=False,
                )
                executor.add(self._helper)
            return self._helper

    def owns(self, node: Node) -> bool:
        """Return whether a node is the current hidden node."""
        background = self._background
        return node is self._helper and background is not None and background.alive

    def forget(self, node: Node, subscription: Subscription) -> None:
        """Destroy a subscription soon, between two callbacks; safe in finalizers."""
        background, destroy = self._background, node.destroy_subscription
        if background is not None and self.owns(node):
            background.ask(lambda: destroy(subscription))

    def nodes(self) -> dict[str, Node]:
        """Return the running nodes, by name."""
        for key, started in tuple(self._started.items()):
            if not _is_alive(started.node):
                self._started.pop(key, None)
        return {key: started.node for key, started in tuple(self._started.items())}

    def start(
        self,
        factory: Callable[..., Any] | Node,
        name: str | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> Node:
        """Do what :func:`start` does."""
        with HeldInterrupts() as interrupts:
            executor = self.executor
            if isinstance(factory, Node):
                node = factory
            else:
                making = Construction(executor.context, self._stop_if_any, name, parameters or {})
                node = self._construct(factory, making, interrupts)
            key = key_of(node.get_name(), node.get_namespace())
            self._stop_if_any(key, but=node)
            # Register the node first, because its first callback may raise before `add` returns.
            self._lost.pop(key, None)
            self._started[key] = Started(node, page_here())
            try:
                executor.add(node)
            except BaseException:
                self._started.pop(key, None)
                raise
        return node

    def stop(self, which: Node | str) -> None:
        """Do what :func:`stop` does."""
        key = self._key(which)
        with HeldInterrupts():
            started = self._started.pop(key, None)
            if started is not None:
                self._lost[key] = 'was stopped'
                self._destroy(started.node)
        if started is None and key not in self._lost and isinstance(which, str):
            running = ', '.join(self.nodes()) or 'none'
            raise NotHereError(f'No node {key!r} was started. Running nodes: {running}.')

    def stop_all(self) -> None:
        """Stop and destroy all nodes started by cells, and all subscriptions of ``listen``."""
        for key in tuple(self._started):
            self.stop(key)
        with HeldInterrupts():
            helper, self._helper = self._helper, None
            if helper is not None:
                self._destroy(helper)

    def close(self) -> None:
        """Destroy all nodes and shut the context down; a later use initialises ROS again."""
        with HeldInterrupts():
            background, self._background = self._background, None
            nodes = [self._helper, *(started.node for started in self._started.values())]
            self._helper = None
            self._started.clear()
            if background is None:
                return
            background.stop()
            for node in filter(None, nodes):
                _destroy_quietly(node)
            background.context.try_shutdown()
            if not rclpy.ok():
                rclpy.try_shutdown()  # so that rclpy can create a new default context

    def losses(self) -> str:
        """Return sentences about nodes that were stopped because of an exception."""
        return ' '.join(
            f'Node {key} {why}.' for key, why in tuple(self._lost.items()) if why != 'was stopped'
        )

    def hints(self) -> str:
        """Return sentences with possible reasons for a wait that timed out."""
        said = [losses] if (losses := self.losses()) else []
        running = self._background.running if self._background else None
        if running is not None and time.monotonic() - running[1] > _SLOW_CALLBACK_S:
            owner = running[0].get_name() if running[0] is not None else 'a node'
            said.append(
                f'A callback of {owner} has been running for '
                f'{time.monotonic() - running[1]:.0f} s, and no other callback runs before it '
                f'ends. To end it: stop({owner!r}).'
            )
        if not said and not self.nodes():
            said.append('No node was started in this notebook: run the cell with start(...).')
        return ' '.join(said)

    def _context(self) -> Context:
        """Return an initialised context."""
        if not rclpy.ok():
            rclpy.try_shutdown()
            # rclpy's own handlers would shut the context down when a cell is interrupted.
            rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        return get_default_context()

    def _construct(
        self, factory: Callable[..., Any], making: Construction, interrupts: HeldInterrupts
    ) -> Node:
        called = getattr(factory, '__name__', repr(factory))
        if not callable(factory) or called == 'main':
            why = 'main() would spin in this cell and never return. ' if called == 'main' else ''
            raise RoslabError(
                f'start({called}) expected a node class, as in start(TemperaturePublisher). {why}'
            )
        try:
            with constructing(making), interrupts.allowed():
                # A bare Node gets its name from start(Node, name=...), see Construction.
                node = Node(making.name or '') if factory is Node else factory()
            if not isinstance(node, Node):
                raise RoslabError(
                    f'start({called}) expected a class or function that creates a Node, got '
                    f'{type(node).__name__}. Pass a subclass of Node or a function returning one.'
                )
        except BaseException as error:
            # Otherwise the node would stay in the graph although no variable refers to it.
            for half_made in making.made:
                _destroy_quietly(half_made)
            if not isinstance(error, Exception):
                # An interrupt may arrive after rclpy has created a publisher but before it has
                # stored it.  Then only a frame refers to the publisher, which refers to the node.
                traceback.clear_frames(error.__traceback__)
            if isinstance(error, Exception) and not isinstance(error, RoslabError):
                said = f'start({called}) created no node, because it raised an exception:'
                todo = _WRITE_IT if isinstance(error, NotImplementedError) else ''
                shown_as(error, f'{said}\n{short_traceback(error)}{todo}')
            raise
        return node

    def _stop_if_any(self, key: str, but: Node | None = None) -> None:
        if key in self._started and self._started[key].node is not but:
            self.stop(key)

    def _destroy(self, node: Node) -> None:
        if self._background is not None and self._background.alive:
            self._background.destroy(node)
        else:
            _destroy_quietly(node)

    def _key(self, which: Node | str) -> str:
        if isinstance(which, str):
            forms = (which, which.lstrip('/'), f'/{which}')
            return next((form for form in forms if form in self._started), which)
        keys = (key for key, one in tuple(self._started.items()) if one.node is which)
        return next(keys, repr(which))

    def _output_below_cell(self, node: Node | None) -> AbstractContextManager[None]:
        pages = (one.page for one in tuple(self._started.values()) if one.node is node)
        return output_below(next(pages, None))

    def _on_failure(self, node: Node | None, error: BaseException) -> None:
        """
        Print the exception of a callback and stop its node; runs in the executor's thread.

        The reason is stored and printed before the node is removed, so that no other code sees
        the node missing without a reason.
        """
        key = self._key(node) if node is not None else 'a callback'
        started = self._started.get(key)
        try:
            if not isinstance(error, CallbackStopped):
                self._lost[key] = f'stopped: {last_line(error)}'
                with output_below(started.page if started else None):
                    say(
                        f'{key} stopped because a callback raised an exception:\n'
                        f'{short_traceback(error)}\n'
                        '  The other nodes keep running. Correct the cell, run it, and start the '
                        'node again.'
                    )
        finally:
            if node is not None:
                _destroy_quietly(node)
            if self._started.get(key) is started:
                self._started.pop(key, None)


def _is_alive(node: Node) -> bool:
    try:
        with node.handle:
            return node.context.ok()
    except Exception:
        return False


def _destroy_quietly(node: Node) -> None:
    """Destroy a node that may be incomplete, already destroyed or without a context."""
    with suppress(Exception):
        force_destroy(node)


_session: Session | None = None


def session() -> Session:
    """Return the session of this kernel; the first call creates it."""
    global _session
    if _session is None:
        _session = Session()
    return _session


def start(
    factory: Callable[..., Any] | Node,
    *,
    name: str | None = None,
    parameters: Mapping[str, Any] | None = None,
) -> Node:
    """
    Create a node and run it in the background, replacing an older node of the same name.

    :param factory: a subclass of Node, a function that returns a node, or an existing node
    :param name: replaces the node's own name, as ``-r __node:=name`` does in a terminal
    :param parameters: initial values of declared parameters, as ``-p name:=value`` does
    :raises RoslabError: if the factory creates no node
    """
    return session().start(factory, name, parameters)


def stop(node: Node | str) -> None:
    """
    Stop and destroy a node; a node that has already stopped is not an error.

    :param node: the node, or its name
    :raises NotHereError: if no node with this name was ever started
    """
    session().stop(node)


def stop_all() -> None:
    """Stop and destroy all nodes of this notebook, and end all subscriptions of ``listen``."""
    session().stop_all()


def nodes() -> dict[str, Node]:
    """Return the nodes that this notebook runs, by name."""
    return session().nodes()


def wait_in(condition: Callable[[], T], timeout_s: float) -> T:
    """
    Wait in this thread while the nodes of this kernel continue to run.

    :param condition: evaluated after each callback
    :param timeout_s: how long to wait [s]
    :returns: the last value of the condition, which is false after a timeout
    :raises RoslabError: if called from a callback, or without a time limit
    """
    if not callable(condition):
        raise RoslabError(
            'wait_until() expected a function to call repeatedly, as in '
            f'wait_until(lambda: len(heard) > 2), got {condition!r}.'
        )
    if not (isinstance(timeout_s, (int, float)) and math.isfinite(timeout_s) and timeout_s >= 0):
        raise RoslabError(f'timeout: expected a number of seconds, as in 5.0, got {timeout_s!r}.')
    if session().executor.is_this_thread:
        raise RoslabError(
            'A callback cannot wait for other callbacks: all of them run in one thread. '
            'Return from it, and do the rest in the callback that you are waiting for.'
        )
    value: T = session().progress.wait(condition, timeout_s)
    return value


def wait_until(condition: Callable[[], T], timeout: float = 5.0, what: str = 'a condition') -> T:
    """
    Wait until a condition is true; nodes continue to run meanwhile.

    :param condition: called after each callback, until it returns a true value
    :param timeout: the longest time to wait [s]
    :param what: description of the condition, for the error message
    :returns: what the condition returned
    :raises TimeoutError: after ``timeout``; its message lists possible reasons
    """
    value = wait_in(condition, timeout)
    if not value:
        hints = session().hints()
        raise timeout_error(f'Waited {timeout:g} s for {what} without success.', hints)
    return value


def timeout_error(*sentences: str) -> TimeoutError:
    """Return a TimeoutError for which a notebook shows only the given sentences."""
    text = ' '.join(sentence for sentence in sentences if sentence)
    return shown_as(TimeoutError(text), f'TimeoutError: {text}')

"""
Deliver the kernel's Interrupt only at moments when it does no harm.

Jupyter's Interrupt raises KeyboardInterrupt between any two instructions of a cell.  Three moments
are harmful: between creating a node and registering it, because the node would stay unknown;
inside a finalizer, because Python drops the exception and the cell continues; and in the kernel's
own code before and after a cell, because a message would be lost or IPython could not show errors
as :mod:`roslab.error_hints` does.
"""

from __future__ import annotations

import atexit
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
import signal
import sys
import threading
from types import FrameType
from typing import Any
import weakref

from IPython.core import interactiveshell

_RETRY_S = 0.01
_HALF_CREATED_BY = frozenset({'rclpy', 'ptyprocess'})  # folder names of these packages
_SHOWING_ERRORS = frozenset(
    {'wrapped', 'showtraceback', 'showsyntaxerror', '_format_exception_for_storage'}
)
"""IPython functions that show the error of a cell; ``wrapped`` calls a custom handler."""
_RUNNING = frozenset(
    {'run_code', 'user_expressions', 'comm_open', 'comm_msg', 'do_complete', 'do_inspect'}
)
"""IPython and kernel functions that run learners' code.  An interrupt elsewhere in the kernel
would lose the request to execute a cell, and the cell would never finish."""


class HeldInterrupts:
    """
    Delays SIGINT during a short step of bounded length, and delivers it afterwards.

    A nested step passes its interrupt on, so that only the end of the outer step delivers it.
    Python delivers signals only in the main thread; in other threads, this class does nothing.
    """

    def __init__(self) -> None:
        self._active = threading.current_thread() is threading.main_thread()
        self._held = False
        self._previous: Any = None

    def __enter__(self) -> HeldInterrupts:
        if self._active:
            self._previous = signal.signal(signal.SIGINT, self._hold)
        return self

    def __exit__(self, _: object, error: BaseException | None, __: object) -> None:
        if self._active:
            signal.signal(signal.SIGINT, self._previous)
        if self._held and error is None:
            self._deliver_held()

    @contextmanager
    def allowed(self) -> Iterator[None]:
        """Allow interrupts temporarily, because a learner's own code may never end."""
        if not self._active:
            yield
            return
        signal.signal(signal.SIGINT, self._previous)
        if self._held:
            self._held = False
            self._deliver_held()
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, self._hold)

    def _hold(self, number: int, frame: FrameType | None) -> None:
        self._held = True

    def _deliver_held(self) -> None:
        outer = getattr(self._previous, '__self__', None)
        if isinstance(outer, HeldInterrupts):
            outer._held = True
        else:
            raise KeyboardInterrupt


@contextmanager
def no_interrupts() -> Iterator[None]:
    """Ignore interrupts temporarily, while no code of the learner is running."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous = signal.signal(signal.SIGINT, lambda *_: None)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, previous)


def watch_cells(shell: Any) -> None:
    """Deliver the interrupts of this kernel's cells only at moments when they do no harm."""
    # ipykernel installs its own handler for each message and restores the old one afterwards.
    shell.events.register('pre_run_cell', _watch_cell)
    kernel = getattr(shell, 'kernel', None)
    if kernel is None:
        return
    from ipykernel import zmqshell  # not installed outside a kernel

    put_in_place = kernel.pre_handler_hook

    def before_message() -> None:
        put_in_place()
        _state.message += 1
        _watch_cell()

    kernel.pre_handler_hook = before_message
    # After an interrupted command, IPython continues the cell.  Wrap the functions that run
    # commands, to end the cell too.
    for module, name in ((zmqshell, 'system'), (interactiveshell, 'getoutput')):
        setattr(module, name, _ends_cell_on_interrupt(getattr(module, name)))
    sys.unraisablehook = _resending_interrupts(sys.unraisablehook)
    # Ignore signals while the kernel shuts down: an interrupt, or Jupyter's second signal after
    # some seconds, would abort other exit functions.  Functions registered last run first.
    for reminder in (signal.SIGINT, signal.SIGTERM):
        atexit.register(signal.signal, reminder, signal.SIG_IGN)


def interrupted() -> bool:
    """Return whether an interrupt was delivered to the running cell."""
    return _state.interrupted


@dataclass
class _CellState:
    """The number of the message that the kernel handles, and whether its cell was interrupted."""

    message: int = 0
    interrupted: bool = False


_state = _CellState()


def _watch_cell(_: Any = None) -> None:
    _state.interrupted = False
    main = threading.current_thread() is threading.main_thread()
    if main and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _deliver)


def _resending_interrupts(tell: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """
    Return a hook for exceptions that Python drops, which sends a dropped interrupt again.

    Any function can be the callback of a weak reference, so :func:`_moment` cannot recognise all
    places where Python drops exceptions.

    The hook also hides errors of an ``Executor()`` or ``!command`` whose creation was interrupted:
    its ``__del__`` runs later, during another cell, and accesses attributes that were never set.
    """

    def dropped(unraisable: Any) -> None:
        if unraisable.exc_type is KeyboardInterrupt:
            _resend_later()
        elif not _is_half_created(unraisable):
            tell(unraisable)

    return dropped


def _is_half_created(unraisable: Any) -> bool:
    """Return whether an error is about an attribute that an interrupted creation never set."""
    trace = unraisable.exc_traceback
    if unraisable.exc_type is not AttributeError or trace is None:
        return False
    code = trace.tb_frame.f_code
    return code.co_name == '__del__' and Path(code.co_filename).parent.name in _HALF_CREATED_BY


def _ends_cell_on_interrupt(command: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that runs a command, and ends the cell if the command is interrupted."""

    def run(*arguments: Any) -> Any:
        _state.interrupted = False
        try:
            result = command(*arguments)
        except UnboundLocalError:
            # IPython raises this if an interrupt arrives before the child has started.
            if not interrupted():
                raise
            raise KeyboardInterrupt from None
        if interrupted():
            raise KeyboardInterrupt
        return result

    return run


def _deliver(number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt now, or later if it would be lost now, but never after the cell."""
    moment = _moment(frame)
    if moment == 'now':
        _state.interrupted = True
        signal.default_int_handler(number, frame)
    elif moment == 'later':
        _resend_later()


def _resend_later() -> None:
    message = _state.message

    def resend() -> None:
        if message == _state.message:  # otherwise the signal would interrupt a later cell
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    retry = threading.Timer(_RETRY_S, resend)
    retry.daemon = True
    retry.start()


def _moment(frame: FrameType | None) -> str:
    """Return when to deliver an interrupt: ``now``, ``later`` or ``never``."""
    running = False
    while frame is not None:
        name, file = frame.f_code.co_name, frame.f_code.co_filename
        if name == '__del__' or file == weakref.__file__:
            return 'later'
        if name in _SHOWING_ERRORS and file == interactiveshell.__file__:
            return 'never'
        running = running or name in _RUNNING
        frame = frame.f_back
    return 'now' if running else 'later'

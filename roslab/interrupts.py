"""
Interrupt, at any moment and without harm.

The kernel's Interrupt raises KeyboardInterrupt between any two instructions of a cell.  Two
moments are bad: between making a node and writing down that it exists, where it would leave a node
nobody knows of, and inside a finalizer, where Python drops the exception and the cell runs on.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
import signal
import threading
from types import FrameType, TracebackType
from typing import Any
import weakref

_RETRY_S = 0.01


class HeldInterrupts:
    """
    Holds SIGINT back for a short, bounded step, and delivers it after it.

    In any other thread than the main one, where Python delivers no signals, this does nothing.
    """

    def __init__(self) -> None:
        self._active = threading.current_thread() is threading.main_thread()
        self._held = False
        self._previous: Any = None

    def __enter__(self) -> HeldInterrupts:
        if self._active:
            self._previous = signal.signal(signal.SIGINT, self._hold)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._active:
            signal.signal(signal.SIGINT, self._previous)
        if self._held and error is None:
            raise KeyboardInterrupt

    @contextmanager
    def allowed(self) -> Iterator[None]:
        """Let interrupts through for a while: a learner's own code may take for ever."""
        if not self._active:
            yield
            return
        signal.signal(signal.SIGINT, self._previous)
        if self._held:
            raise KeyboardInterrupt
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, self._hold)

    def _hold(self, number: int, frame: FrameType | None) -> None:
        self._held = True


def watch_cells(shell: Any) -> None:
    """
    Deliver the interrupts of this kernel's cells outside of finalizers.

    :param shell: what ``get_ipython()`` returns
    """
    # ipykernel puts its own handler in place for each cell, and the older one back after it.
    shell.events.register('pre_run_cell', _watch_cell)


def _watch_cell(_: Any) -> None:
    main = threading.current_thread() is threading.main_thread()
    if main and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _deliver)


def _deliver(number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, a little later if it would be lost here."""
    if not _in_finalizer(frame):
        signal.default_int_handler(number, frame)
    main = threading.main_thread().ident or 0
    retry = threading.Timer(_RETRY_S, signal.pthread_kill, (main, signal.SIGINT))
    retry.daemon = True
    retry.start()


def _in_finalizer(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_name == '__del__' or frame.f_code.co_filename == weakref.__file__:
            return True
        frame = frame.f_back
    return False

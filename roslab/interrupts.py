"""
Keeping Interrupt away from the few steps that must not be done by half.

The kernel's Interrupt raises KeyboardInterrupt between any two instructions of a cell.  Between
making a node and writing down that it exists, that would leave a node nobody knows of.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
import signal
import threading
from types import FrameType, TracebackType
from typing import Any


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

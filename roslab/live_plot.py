"""
Plot a numeric field of a topic; the picture stays up to date while other cells run.

A separate thread draws at most five times a second, and only if there is new data.  It ends with
its listener, with the session, or when another cell plots the same field.
"""

from __future__ import annotations

import atexit
from collections.abc import Iterable, Mapping
from contextlib import suppress
import math
import threading
from typing import Any

from autograder.simulated import TopicRecord
from roslab.errors import RoslabError
from roslab.fields import number_getter
from roslab.interrupts import HeldInterrupts
from roslab.introspection import listen_as_found
from roslab.listening import Listener
from roslab.output import current_cell, has_frontend, shell
from roslab.plot_picture import Curve, curve_html, curve_text
from roslab.session import Session

_PERIOD_S = 0.2
_STOPPING_S = 1.0

_plots: dict[tuple[str, str, bool], Plot] = {}


class Plot:
    """
    A picture that follows a topic, or that shows one topic of a simulation.

    :param session: session whose hidden node subscribes
    :param topic: with or without the leading slash (the graph gives its type), or a topic
        recorded by a simulation, ``run['topic']``
    :param field: path of a numeric field, such as ``header.stamp.sec`` or ``data[0]``
    :param seconds: length of the time axis [s]
    :param threshold: a value to draw as a horizontal line; values above it are highlighted
    :param marks: times of other events, by name [s]
    :raises NotHereError: if the topic has no endpoint
    :raises RoslabError: if the field does not exist or is not numeric
    """

    def __init__(
        self,
        session: Session,
        topic: str | TopicRecord,
        field: str,
        seconds: float,
        threshold: float | None,
        marks: Mapping[str, Iterable[float]] | None = None,
    ) -> None:
        _require_numbers(seconds, threshold)
        self.field = field
        self.seconds = seconds
        self.threshold = threshold
        self.marks = {label: tuple(times) for label, times in (marks or {}).items()}
        self._handle: Any = None
        self._painting = threading.Lock()
        self._painted: tuple[int, float] | None = None
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None
        self.listener: Listener | TopicRecord = (
            topic if isinstance(topic, TopicRecord) else listen_as_found(session, topic)
        )
        try:
            self._number = number_getter(self.listener.msg_type, field)
        except RoslabError:
            self.listener.stop()
            raise
        cell = current_cell()
        self._shown_in = cell.number if cell else None

    @property
    def topic(self) -> str:
        """Full name of the topic."""
        return self.listener.topic

    @property
    def values(self) -> list[float]:
        """All values of the field so far, oldest first."""
        found = (self._number(message) for message in self.listener.messages)
        return [value for value in found if value is not None]

    def wait(self, count: int = 1, timeout: float = 10.0) -> list[float]:
        """
        Wait until a number of messages have arrived and the picture shows them.

        :param count: how many messages since the plot began
        :param timeout: how long to wait [s]
        :returns: all values so far
        :raises TimeoutError: with possible reasons
        """
        try:
            self.listener.wait(count, timeout)
        finally:
            self._keep_up()
            self.paint()
        return self.values

    def stop(self) -> None:
        """Stop listening and drawing; the picture stays as last drawn."""
        with HeldInterrupts():
            self._ended.set()
            self.listener.stop()
            if self._thread is not None and self._thread is not threading.current_thread():
                self._thread.join(_STOPPING_S)
            if _plots.get(self._key) is self:
                del _plots[self._key]
            self.paint()

    def begin(self) -> None:
        """Show the picture in the running cell and start updating it."""
        with HeldInterrupts():
            older = _plots.pop(self._key, None)
            if older is not None:
                older.stop()
            _plots[self._key] = self
            if shell() is None:
                return
            from IPython.display import display

            self._handle = display(self._bundle(), raw=True, display_id=True)
        self._keep_up()

    def _keep_up(self) -> None:
        """Continue updating the picture, even after stop_all() has ended its subscription."""
        with HeldInterrupts():
            if self._handle is None or self._ended.is_set():
                return
            _plots.setdefault(self._key, self)
            running = self._thread is not None and self._thread.is_alive()
            if has_frontend() and not running:
                # Without a frontend, redrawing in wait() and at the end of each cell is enough.
                self._thread = threading.Thread(
                    target=self._follow, name='roslab plot', daemon=True
                )
                self._thread.start()

    def paint(self) -> None:
        """Redraw if there is new data; never raise an exception."""
        with HeldInterrupts(), self._painting:
            newest = self._newest()
            if self._handle is None or newest == self._painted:
                return
            self._painted = newest
            with suppress(Exception):  # a closed connection must not end a cell or a thread
                self._handle.update(self._bundle(), raw=True)

    @property
    def _key(self) -> tuple[str, str, bool]:
        # A plot of a simulation does not end the live plot of the topic with the same name.
        return self.topic, self.field, isinstance(self.listener, TopicRecord)

    def _newest(self) -> tuple[int, float]:
        times = self.listener.times
        return len(times), times[-1] if times else -1.0

    def _follow(self) -> None:
        while not self._ended.wait(_PERIOD_S) and self.listener.alive:
            self.paint()

    def _curve(self) -> Curve:
        times, messages = self.listener.times, self.listener.messages
        begin = (times[-1] if times else 0.0) - self.seconds
        recent = [(time, self._number(m)) for time, m in zip(times, messages) if time >= begin]
        return Curve(
            f'{self.topic} {self.field}',
            tuple((time, value) for time, value in recent if value is not None),
            self.seconds,
            self.threshold,
            self.marks,
        )

    def _bundle(self) -> dict[str, str]:
        curve = self._curve()
        return {'text/plain': curve_text(curve), 'text/html': curve_html(curve)}

    def __str__(self) -> str:
        return curve_text(self._curve())

    def __repr__(self) -> str:
        return str(self)

    def _ipython_display_(self) -> None:
        """Show a copy if a later cell returns the plot; only the first picture is updated."""
        cell = current_cell()
        if cell is None or cell.number != self._shown_in:
            from IPython.display import display

            display(self._bundle(), raw=True)


def paint_all(_: Any = None) -> None:
    """Update the pictures at the end of a cell, and forget plots that have ended."""
    for key, plot in tuple(_plots.items()):
        plot.paint()
        if not plot.listener.alive:
            _plots.pop(key, None)


def _stop_all() -> None:
    """Stop the drawing threads before the interpreter shuts down."""
    for plot in tuple(_plots.values()):
        plot.stop()


atexit.register(_stop_all)


def _require_numbers(seconds: float, threshold: float | None) -> None:
    if not isinstance(seconds, (int, float)) or not math.isfinite(seconds) or seconds <= 0:
        raise RoslabError(f'seconds: expected a length of time, as in 20.0, got {seconds!r}.')
    if threshold is not None and not isinstance(threshold, (int, float)):
        raise RoslabError(f'threshold: expected a number, as in 30.0, got {threshold!r}.')

"""
A picture in the output of one cell that is redrawn while other cells run.

A separate thread draws, at most five times a second and only if there is something new.  It ends
when its subject ends, or when another cell shows the same subject.

Pages with widgets redraw the picture in place.  The notebook gets the newest picture as HTML at
the end of each cell, or every picture as long as no page has reported that it draws in place.
The widget has no view, because a saved view without its kernel hides the HTML next to it.
"""

from __future__ import annotations

import atexit
from collections.abc import Hashable
from contextlib import suppress
import threading
from typing import Any
from uuid import uuid4

from roslab.interrupts import HeldInterrupts
from roslab.output import current_cell, has_frontend, shell

_PERIOD_S = 0.2
_STOPPING_S = 1.0

_pictures: dict[Hashable, LivePicture] = {}


class LivePicture:
    """
    A picture in the output of a cell, and the thread that redraws it; subclasses draw the subject.

    :param key: name of the subject; a second picture with the same key ends the first one
    """

    def __init__(self, key: Hashable) -> None:
        self._key = key
        self._handle: Any = None
        self._widget: Any = None
        self._place = ''
        self._painting = threading.Lock()
        self._painted: dict[bool, object] = {}  # the newest picture in the notebook, and in pages
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None
        cell = current_cell()
        self._shown_in = cell.number if cell else None

    def _html(self) -> str:
        """Return the picture."""
        raise NotImplementedError

    def _newest(self) -> object:
        """Return a value that changes when there is something new to draw."""
        raise NotImplementedError

    def _can_change(self) -> bool:
        """Return whether the picture can still change."""
        raise NotImplementedError

    def _finish(self) -> None:
        """Stop the subject; called once at the end."""
        raise NotImplementedError

    def begin(self) -> None:
        """Show the picture in the running cell and keep it up to date."""
        with HeldInterrupts():
            older = _pictures.pop(self._key, None)
            if older is not None:
                older.stop()
            _pictures[self._key] = self
            if shell() is None:
                return
            from IPython.display import display

            self._place = uuid4().hex if has_frontend() and self._can_change() else ''
            self._handle = display(self._bundle(self._place), raw=True, display_id=True)
            if self._place:
                from roslab.widgets import PictureWidget  # slow to import

                self._widget = PictureWidget(self._place)
        self._resume_updates()

    def stop(self) -> None:
        """End the subject and stop drawing; the picture no longer changes."""
        with HeldInterrupts():
            self._ended.set()
            self._finish()
            if self._thread is not None and self._thread is not threading.current_thread():
                self._thread.join(_STOPPING_S)
            if _pictures.get(self._key) is self:
                del _pictures[self._key]
            self._paint()
            if self._widget:
                self._widget.close()

    def _resume_updates(self) -> None:
        """Keep the picture up to date again, even after stop_all() has ended its subject."""
        with HeldInterrupts():
            if self._handle is None or self._ended.is_set():
                return
            running = self._thread is not None and self._thread.is_alive()
            if has_frontend() and not running:
                # Without a frontend, redrawing at the end of each cell is enough.
                self._thread = threading.Thread(
                    target=self._follow, name='roslab picture', daemon=True
                )
                self._thread.start()

    def _follow(self) -> None:
        while not self._ended.wait(_PERIOD_S) and self._can_change():
            self._paint(in_place=bool(self._widget and self._widget.is_shown))
        self._paint()

    def _paint(self, in_place: bool = False) -> None:
        """Redraw if there is something new, in pages only or in the notebook too; never raise."""
        with HeldInterrupts(), self._painting:
            newest = self._newest()
            if self._handle is None or newest == self._painted.get(in_place):
                return
            self._painted[in_place] = newest
            with suppress(Exception):  # a closed connection must not end a cell or a thread
                if self._widget:
                    self._widget.picture = self._html()
                if not in_place:
                    self._handle.update(self._bundle(self._place), raw=True)

    def _bundle(self, place: str = '') -> dict[str, str]:
        html = self._html()
        if place:
            html = f'<div data-picture="{place}">{html}</div>'
        return {'text/plain': repr(self), 'text/html': html}

    def _ipython_display_(self) -> None:
        """Show a copy if a later cell returns the picture; only the first one is updated."""
        cell = current_cell()
        if cell is None or cell.number != self._shown_in:
            from IPython.display import display

            display(self._bundle(), raw=True)


def paint_all(_: Any = None) -> None:
    """Update the pictures in the notebook at the end of a cell."""
    for picture in tuple(_pictures.values()):
        picture._paint()


@atexit.register
def _stop_all() -> None:
    """End the threads before the interpreter shuts down."""
    for picture in tuple(_pictures.values()):
        picture.stop()

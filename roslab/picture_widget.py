"""Redraw a live picture in the pages that show it."""

from __future__ import annotations

from pathlib import Path

import anywidget
import traitlets


class PictureWidget(anywidget.AnyWidget):
    """
    The newest picture; a page draws it into the output of its cell, so it needs no view.

    :param place: value of the attribute ``data-picture`` of the element to draw into
    :param picture: the picture as HTML
    """

    _esm = Path(__file__).with_name('picture.js')
    place = traitlets.Unicode().tag(sync=True)
    picture = traitlets.Unicode().tag(sync=True)
    is_shown = False
    """Whether a page draws it; pages without widgets never do."""

    def __init__(self, place: str, picture: str) -> None:
        super().__init__(place=place, picture=picture)
        # A synchronised trait would hold back the other one, which another thread changes.
        self.on_msg(lambda *_: setattr(self, 'is_shown', True))

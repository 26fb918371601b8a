"""Redraw a live picture in the pages that show it."""

from pathlib import Path

import anywidget
import traitlets


class PictureWidget(anywidget.AnyWidget):
    """The newest picture as HTML; pages draw it into the elements with ``data-picture=place``."""

    _esm = Path(__file__).with_name('picture.js')
    place = traitlets.Unicode().tag(sync=True)
    picture = traitlets.Unicode().tag(sync=True)
    is_shown = False

    def __init__(self, place: str) -> None:
        super().__init__(place=place)
        # Receiving a synchronised trait would delay `picture`, which another thread sets.
        self.on_msg(lambda *_: setattr(self, 'is_shown', True))

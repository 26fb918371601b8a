"""Draw labelled rows above an axis, such as messages or callbacks against time."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from drawing import svg
from drawing.slider import cursor, slider

_WIDTH = 760.0
_MARGIN = 10.0
_TICK = 9.0

Place = Callable[[float], float]
"""Returns the position of a time [s] or a number on the axis."""


class Lane(NamedTuple):
    """
    One row of a picture with an axis.

    :param label: at the left of the row
    :param more: a second, fainter label
    :param amount: at the right of the row
    :param draw: returns the drawing, from the height of the row's line and the axis
    :param middle: distance of the row's line from its top
    """

    label: str
    more: str
    amount: str
    draw: Callable[[float, Place], str]
    italic: bool = False
    middle: float = 15.0
    height: float = 30.0


def draw_lanes(
    lanes: Sequence[Lane],
    axis: tuple[float, float],
    title: str,
    described: str,
    table: svg.Table,
    *,
    unit: str = 'seconds',
    whole: bool = False,
    legend: str = '',
    moments: Sequence[tuple[float, str]] = (),
) -> str:
    """
    Return a picture with labelled rows above an axis.

    :param axis: start and end of the axis
    :param described: the contents of the picture as text
    :param unit: label of the axis
    :param whole: whether the axis shows only whole numbers
    :param legend: explains the symbols
    :param moments: positions of the slider: time [s] and caption
    """
    begin, end = axis
    left = _MARGIN + max(
        max(svg.text_width(lane.label, 13), svg.text_width(lane.more, 10)) for lane in lanes
    )
    right = _WIDTH - _MARGIN - max(svg.text_width(lane.amount, 11) for lane in lanes)
    right = min(right, _WIDTH - _MARGIN - svg.text_width(unit, 11))
    span, pad = max(end - begin, 1e-6), 12.0

    def place(value: float) -> float:
        return left + pad + (value - begin) / span * (right - left - 2 * pad)

    bottom = _MARGIN + sum(lane.height for lane in lanes)
    parts = []
    for tick in svg.ticks(begin, end):
        if not whole or tick == int(tick):
            x = place(tick)
            parts.append(svg.line(x, _MARGIN, x, bottom + 4, faint=True))
            parts.append(svg.text(x, bottom + 17, f'{tick:g}', anchor='middle', size=11))
    parts.append(svg.text(right + 4, bottom + 17, unit, size=11, faint=True))
    parts.append(svg.text(_MARGIN, bottom + 34, legend, size=11) if legend else '')
    top = _MARGIN
    for lane in lanes:
        parts += [_labels(lane, top + lane.middle, left, right)]
        parts += [lane.draw(top + lane.middle, place)]
        top += lane.height
    below = ''
    if moments:
        places = [(place(time), words) for time, words in moments]
        parts.append(cursor(places[-1][0], _MARGIN, bottom + 4))
        below = slider(title, places, (place(begin), place(begin + span)), _WIDTH)
    height = bottom + (46 if legend else 28)
    return svg.picture(_WIDTH, height, title, described, parts, table, below)


def _labels(lane: Lane, y: float, left: float, right: float) -> str:
    label = svg.text(
        left,
        y if lane.more else y + 4,
        lane.label,
        anchor='end',
        bold=not lane.italic,
        italic=lane.italic,
    )
    more = svg.text(left, y + 12, lane.more, anchor='end', size=10, faint=True)
    line = svg.line(left + 6, y, right - 6, y, faint=True)
    return (
        label
        + (more if lane.more else '')
        + line
        + svg.text(right + 4, y + 4, lane.amount, size=11)
    )


def distinct(times: Iterable[float], place: Place) -> list[float]:
    """Return one position per half pixel, to limit the size of the picture."""
    return sorted({round(place(time) * 2) / 2 for time in times})


def draw_ticks(times: Iterable[float], colour: str, dashed: bool, y: float, place: Place) -> str:
    """Return one tick per time, as one SVG path."""
    path = ''.join(f'M{x:g} {y - _TICK:g}v{2 * _TICK:g}' for x in distinct(times, place))
    dashes = ' stroke-dasharray="3 2"' if dashed else ''
    look = f'fill="none" stroke="{colour}" stroke-width="1.8"{dashes}'
    return f'<path d="{path}" {look}/>' if path else ''

"""Draw a numeric value against time as a picture and as text, without ROS."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby
import math

from drawing import svg
from roslab.output import counted

_WIDTH = 720.0
_HEIGHT = 250.0
_LEFT = 62.0
_RIGHT = 16.0
_TOP = 30.0
_BOTTOM = 40.0
_MOST_POINTS = 600
_MOST_DOTS = 80
_MOST_LISTED = 10

Point = tuple[float, float]
"""A time [s] and a value."""


@dataclass(frozen=True)
class Curve:
    """
    The data to draw.

    :param points: sorted by time; a value that is not finite leaves a gap
    :param seconds: length of the time axis [s]
    :param threshold: a value to draw as a horizontal line; values above it are highlighted
    :param marks: times of other events, by name [s]
    """

    name: str
    points: tuple[Point, ...]
    seconds: float
    threshold: float | None = None
    marks: Mapping[str, Sequence[float]] = field(default_factory=dict)

    @property
    def finite(self) -> list[Point]:
        """The points with finite values, which can be drawn."""
        return [point for point in self.points if math.isfinite(point[1])]

    @property
    def above(self) -> int:
        """The number of values above the threshold."""
        level = self.threshold
        return 0 if level is None else sum(value > level for _, value in self.finite)


def curve_words(curve: Curve) -> str:
    """Return one sentence that describes the plot."""
    points = curve.finite
    if not points:
        return f'{curve.name}: waiting for messages.'
    values = [value for _, value in points]
    span = points[-1][0] - points[0][0]
    words = (
        f'{curve.name}: {counted(points, "value")} in {span:.1f} s, '
        f'from {min(values):g} to {max(values):g}, last {values[-1]:g}'
    )
    if len(points) < len(curve.points):
        words += f'; {len(curve.points) - len(points)} not finite'
    if curve.threshold is not None:
        words += f'; {curve.above} above the threshold {curve.threshold:g}'
    for label, times in curve.marks.items():
        words += f'; {label} at {", ".join(f"{time:.2f} s" for time in times) or "no time"}'
    return f'{words}.'


def curve_text(curve: Curve) -> str:
    """Return the plot as text: the description and the newest values."""
    newest = curve.points[-_MOST_LISTED:]
    lines = [curve_words(curve)]
    for time, value in newest:
        over = curve.threshold is not None and value > curve.threshold
        lines.append(f'  {time:8.2f} s  {value:g}{"  above" if over else ""}')
    return '\n'.join(lines)


def curve_html(curve: Curve) -> str:
    """Return the plot as an HTML picture."""
    points = _thinned(curve.points, _MOST_POINTS)
    low, high = _range(curve)
    end = max(points[-1][0] if points else 0.0, curve.seconds)
    begin = end - curve.seconds

    def x_of(time: float) -> float:
        return _LEFT + (time - begin) / curve.seconds * (_WIDTH - _LEFT - _RIGHT)

    def y_of(value: float) -> float:
        return _HEIGHT - _BOTTOM - (value - low) / (high - low) * (_HEIGHT - _TOP - _BOTTOM)

    right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM
    legend = [f'diamond: {label}' for label in curve.marks]
    legend += [] if curve.threshold is None else [f'dashed: threshold {curve.threshold:g}']
    parts = [
        svg.text(_LEFT, 18, curve.name, bold=True, size=13),
        # In the title row, no curve overlaps the legend.
        svg.text(right, 18, ', '.join(legend), anchor='end', size=11),
        svg.text(right, _HEIGHT - 6, 'seconds', anchor='end', size=11, faint=True),
        svg.line(_LEFT, bottom, right, bottom),
        svg.line(_LEFT, _TOP, _LEFT, bottom),
    ]
    for tick in svg.ticks(begin, end):
        x = x_of(tick)
        parts.append(svg.line(x, bottom, x, bottom + 4))
        parts.append(svg.text(x, bottom + 17, f'{tick:g}', anchor='middle', size=11))
    for tick in svg.ticks(low, high, 5):
        y = y_of(tick)
        parts.append(svg.line(_LEFT, y, right, y, faint=True))
        parts.append(svg.text(_LEFT - 6, y + 4, f'{tick:g}', anchor='end', size=11))
    if curve.threshold is not None:
        y = y_of(curve.threshold)
        parts.append(svg.line(_LEFT, y, right, y, colour=svg.RED, width=1.5, dashed=True))
    parts += _drawn([(x_of(time), y_of(value), value) for time, value in points], curve.threshold)
    parts += _marks(curve, x_of)
    if not points:
        middle = (_LEFT + right) / 2
        parts.append(svg.text(middle, _TOP + 18, 'waiting for messages', anchor='middle'))
    title = f'Plot of {curve.name}'
    return svg.picture(_WIDTH, _HEIGHT, title, curve_words(curve), parts, _table(curve))


def _table(curve: Curve) -> svg.Table:
    """Return the values as a table; many values are reduced by :func:`_thinned`."""
    level = curve.threshold
    head = ['seconds', curve.name, *([] if level is None else [f'above {level:g}'])]
    rows = []
    for time, value in _thinned(curve.points, svg.MAX_ROWS):
        above = [] if level is None else ['yes' if value > level else 'no']
        rows.append([f'{time:.2f}', f'{value:g}', *above])
    return [head, *rows]


def _range(curve: Curve) -> tuple[float, float]:
    values = [value for _, value in curve.finite]
    if curve.threshold is not None:
        values.append(curve.threshold)
    low, high = min(values, default=0.0), max(values, default=1.0)
    room = (high - low) * 0.12 or max(abs(high) * 0.1, 1.0)
    return low - room, high + room


def _thinned(points: Sequence[Point], most: int) -> list[Point]:
    """Return at most ``most`` points: the lowest and the highest of each group of neighbours."""
    if len(points) <= most:
        return list(points)
    size = math.ceil(len(points) / (most / 2))
    kept: list[Point] = []
    for start in range(0, len(points), size):
        stretch = points[start : start + size]
        kept += sorted({min(stretch, key=lambda p: p[1]), max(stretch, key=lambda p: p[1])})
    return kept


def _marks(curve: Curve, x_of: Callable[[float], float]) -> Iterator[str]:
    """Yield a diamond at the bottom of the picture per event; simultaneous events are stacked."""
    for times in curve.marks.values():
        for place, time in enumerate(times):
            y = _HEIGHT - _BOTTOM - 9 - 11 * list(times[:place]).count(time)
            yield svg.shape('diamond', x_of(time), y, 5, svg.ORANGE)


def _drawn(points: list[tuple[float, float, float]], threshold: float | None) -> list[str]:
    """Return the curve, interrupted where a value is not finite, and its points."""
    parts = []
    for finite, stretch in groupby(points, key=lambda point: math.isfinite(point[2])):
        if finite:
            drawn = ' '.join(f'{x:.1f},{y:.1f}' for x, y, _ in stretch)
            parts.append(
                f'<polyline points="{drawn}" fill="none" stroke="{svg.BLUE}" '
                'stroke-width="2" stroke-linejoin="round"/>'
            )
    shown = [point for point in points if math.isfinite(point[2])]
    for x, y, value in shown:
        if threshold is not None and value > threshold:
            parts.append(svg.shape('triangle', x, y, 5, svg.RED))
        elif len(shown) <= _MOST_DOTS:
            parts.append(svg.shape('circle', x, y, 2.5, svg.BLUE))
    return parts

"""Draw messages against time: one row per topic, one tick per message."""

from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from drawing import svg
from drawing.lanes import distinct, draw_lanes, draw_ticks, Lane, Place
from roslab.cli_text import message_yaml
from roslab.errors import RoslabError
from roslab.lookup import type_name
from roslab.output import counted, text_table

_MOST_TIMES = 12
_MOST_LETTERS = 60
_MARK_SHAPES = ('triangle', 'diamond', 'cross', 'square', 'plus', 'circle')
_MARK_COLOURS = (svg.RED, svg.ORANGE, svg.GREEN)


class Row(NamedTuple):
    """
    One row of the timeline.

    :param label: a topic, or the name of other events
    :param times: times of the events, sorted [s]
    :param mark: True if the row shows other events instead of messages
    :param more: a second, fainter label
    :param texts: contents of the messages of a recorded run, for its slider
    """

    label: str
    times: tuple[float, ...]
    mark: bool = False
    more: str = ''
    texts: tuple[str, ...] = ()

    @property
    def rate(self) -> float | None:
        """Messages per second between the first and the last, None for fewer than two messages."""
        if self.mark or len(self.times) < 2 or self.times[-1] <= self.times[0]:
            return None
        return (len(self.times) - 1) / (self.times[-1] - self.times[0])

    @property
    def amount(self) -> str:
        """The number and the rate of the messages, as text."""
        words = counted(self.times, 'mark' if self.mark else 'message')
        return words if self.rate is None else f'{words}, {self.rate:.1f} Hz'


class Timeline:
    """Messages on a time axis from ``begin`` to ``end`` [s], shown as a picture or as a table."""

    def __init__(self, rows: Sequence[Row], begin: float, end: float) -> None:
        self.rows = tuple(rows)
        self.begin = begin
        self.end = end

    def __repr__(self) -> str:
        table = [('row', 'count', 'rate', 'times [s]')]
        for row in self.rows:
            rate = 'mark' if row.mark else '-' if row.rate is None else f'{row.rate:.1f} Hz'
            times = svg.listed(row.times, _MOST_TIMES)
            table.append((row.label, str(len(row.times)), rate, times))
        return text_table(table, right=(1, 2))

    def _repr_html_(self) -> str:
        rows = self.rows
        described = '. '.join(f'{row.label}: {row.amount}' for row in rows)
        data = [(row.label, row.more, row.amount, svg.listed(row.times)) for row in rows]
        axis = self.begin, max(self.end, self.begin + 1e-6)
        title = f'Timeline of {axis[1] - axis[0]:.1f} seconds, {counted(rows, "row")}'
        table = [('row', 'type', 'amount', 'times [s]'), *data]
        marks = [row for row in rows if row.mark]
        lanes = []
        for row in rows:
            draw = (
                partial(_mark, row, marks.index(row))
                if row.mark
                else partial(draw_ticks, row.times, svg.BLUE, False)
            )
            lanes.append(Lane(row.label, row.more, row.amount, draw, italic=row.mark))
        return draw_lanes(lanes, axis, title, described, table, moments=_moments(rows))


def timeline(
    *sources: Any,
    marks: Mapping[str, Iterable[float]] | None = None,
    seconds: float | None = None,
) -> Timeline:
    """
    Show messages on a time axis, as a picture or, with ``str()``, as a plain-text table.

    :param sources: listeners, plots, simulations or recorded topics. The axis begins when the
        first listener began to listen; a simulation contributes all its topics
    :param marks: names and times of other events, on the scale of the first listener's ``now`` [s]
    :param seconds: show only this much time before the newest event [s]
    :raises RoslabError: if a source has an unknown type, or a mark has no times
    """
    found = [one for source in sources for one in getattr(source, 'listeners', (source,))]
    found = [getattr(source, 'listener', source) for source in found]  # a plot has a listener
    if not found:
        raise RoslabError(
            "timeline() expected listeners, as in timeline(listen('chatter', String))."
        )
    # A simulation begins at 0, and its times are those of the axis.
    zero = next((began for one in found if (began := getattr(one, 'began', 0.0))), 0.0)
    rows = [_row_of(source, zero) for source in found]
    rows += [_row_of_mark(label, times) for label, times in (marks or {}).items()]
    stamps = [stamp for row in rows for stamp in row.times]
    end = max([*stamps, 0.1])
    begin = min([*stamps, 0.0]) if seconds is None else end - seconds
    if seconds is not None:
        rows = [
            row._replace(
                times=tuple(t for t in row.times if t >= begin),
                texts=tuple(text for t, text in zip(row.times, row.texts) if t >= begin),
            )
            for row in rows
        ]
    return Timeline(rows, begin, end)


def _row_of(source: Any, zero: float) -> Row:
    if not (hasattr(source, 'times') and hasattr(source, 'began')):
        raise RoslabError(
            f'timeline() expected a listener, as listen() returns it, got {source!r}. '
            'Pass times of other events as marks={"label": [seconds, ...]}.'
        )
    shift = source.began - zero if source.began else 0.0
    times = tuple(time + shift for time in source.times)
    # Only a recorded run, recognised by `data`, is sure to keep its messages unchanged.
    texts = tuple(map(_short, source.messages)) if hasattr(source, 'data') else ()
    return Row(source.topic, times, more=type_name(source.msg_type), texts=texts)


def _short(message: Any) -> str:
    words = 'too large to show' if message is None else ' '.join(message_yaml(message).split())
    return words if len(words) <= _MOST_LETTERS else f'{words[:_MOST_LETTERS]}...'


def _moments(rows: Sequence[Row]) -> list[tuple[float, str]]:
    """Return the time of each message in a recorded run [s], with the latest message per row."""
    events = sorted(
        (time, index, text)
        for index, row in enumerate(rows)
        for time, text in zip(row.times, row.texts)
    )
    latest: dict[str, str] = {}
    moments = []
    for time, index, text in events:
        latest[rows[index].label] = text
        state = '; '.join(f'{label}: {newest}' for label, newest in latest.items())
        moments.append((time, f'{time:.2f} s, a message on {rows[index].label}. Latest: {state}'))
    return moments


def _row_of_mark(label: str, times: Iterable[float]) -> Row:
    try:
        return Row(str(label), tuple(sorted(float(time) for time in times)), mark=True)
    except (TypeError, ValueError):
        raise RoslabError(
            f'marks[{label!r}]: expected seconds in a list, as in [1.5, 3.0], got {times!r}.'
        ) from None


def _mark(row: Row, number: int, y: float, place: Place) -> str:
    kind = _MARK_SHAPES[number % len(_MARK_SHAPES)]
    colour = _MARK_COLOURS[number % len(_MARK_COLOURS)]
    return ''.join(svg.shape(kind, x, y, 5, colour) for x in distinct(row.times, place))

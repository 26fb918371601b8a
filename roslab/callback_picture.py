"""Draw on a time axis when callbacks were due, and when an executor ran them."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import ClassVar

from rclpy.node import Node

from drawing import svg
from roslab.callbacks import Call, Watch, watching
from roslab.output import text_table
from roslab.timeline_picture import draw_rows, Place, Row

_COLOURS = (svg.BLUE, svg.ORANGE, svg.GREEN, svg.RED)
_LEGEND = (
    'line: a message came, or a timer was due · box: the callback, with the number of its thread'
    ' · cross: no callback'
)
_HEAD = ('node', 'callback of', 'group', 'thread', 'came [s]', 'began [s]', 'ended [s]')
_LANE = 20.0


@dataclass(frozen=True)
class CallRow(Row):
    """
    The callbacks of one timer, subscription or service.

    :param calls: its callbacks, and the events that got none
    :param end: end of the axis [s]
    """

    calls: tuple[Call, ...] = ()
    end: float = 0.0
    middle: ClassVar[float] = 23.0

    @property
    def lanes(self) -> list[int]:
        """The lane of each callback; callbacks that overlap have different lanes."""
        free_at: list[float] = []
        lanes = []
        for call in self.calls:
            if call.began is None:
                lanes.append(0)
                continue
            lane = next((n for n, at in enumerate(free_at) if at <= call.began), len(free_at))
            free_at[lane : lane + 1] = [self.end if call.ended is None else call.ended]
            lanes.append(lane)
        return lanes

    @property
    def height(self) -> float:
        """Height of the row in the picture."""
        return 2 * self.middle + _LANE * max(self.lanes, default=0)

    @property
    def amount(self) -> str:
        """The numbers of callbacks, and of events without one, as text."""
        lost = sum(call.lost for call in self.calls)
        pending = sum(call.began is None for call in self.calls) - lost
        words = [f'{len(self.calls) - lost - pending} called']
        return ', '.join(
            words + [f'{lost} not'] * bool(lost) + [f'{pending} not yet'] * bool(pending)
        )


class Callbacks(Watch):
    """A record of callbacks: a picture as the last line of a cell, a table with ``str()``."""

    def __repr__(self) -> str:
        return text_table(self._table())

    def _repr_html_(self) -> str | None:
        rows = self._rows()
        if not rows:
            return None
        begin = min(time for row in rows for call in row.calls for time in call.times)
        axis = max(begin, 0.0), rows[0].end  # a message may have waited since long before
        title = (
            f'Callbacks in {axis[1] - axis[0]:.2f} seconds, '
            f'{len(rows)} row{"s" * (len(rows) != 1)}'
        )
        described = '. '.join(f'{row.more}, {row.label}: {row.amount}' for row in rows)
        return draw_rows(rows, axis, title, described, self._table(), _content, _LEGEND)

    def _rows(self) -> list[CallRow]:
        """Return one row per timer, subscription or service; rows of a group are neighbours."""
        events = self.events
        end = max((time for call in events for time in call.times), default=0.0)
        # A callback that has not ended is drawn until the end of the watch.
        if any(call.began is not None and call.ended is None for call in events):
            end = self.end or end
        found: dict[int, list[Call]] = {}
        for call in events:
            found.setdefault(id(call.source), []).append(call)
        first = [calls[0].source for calls in found.values()]
        nodes = list(dict.fromkeys(source.node for source in first))
        rows = [
            CallRow(
                source.name,
                (),
                more=' · '.join(filter(None, (source.node, source.function, source.group))),
                calls=tuple(found[id(source)]),
                end=end,
            )
            for source in sorted(first, key=lambda one: (nodes.index(one.node), one.group))
        ]
        return rows

    def _table(self) -> list[tuple[str, ...]]:
        """Return one row per callback in the order of their times."""
        events = sorted(self.events, key=lambda call: (call.came or call.began or 0, call.lost))
        rows = [_cells(call) for call in events[: svg.MAX_ROWS]]
        if len(events) > len(rows):
            rows.append((f'{len(events) - len(rows)} more', *[''] * (len(_HEAD) - 1)))
        if self.full:
            rows.append(('later ones are not recorded', *[''] * (len(_HEAD) - 1)))
        return [_HEAD, *rows]


def _cells(call: Call) -> tuple[str, ...]:
    source = call.source
    name = f'{source.name} {source.function}'.strip()
    came, began, ended = (
        '-' if one is None else f'{one:.3f}' for one in (call.came, call.began, call.ended)
    )
    if call.began is None:
        began = 'no callback' if call.lost else 'not yet'
    thread = str(call.thread or '-')
    return source.node, name, source.group or 'default', thread, came, began, ended


def _content(row: CallRow, y: float, place: Place, _: int) -> str:
    parts = []
    for call, lane in zip(row.calls, row.lanes):
        top = y + 1 + lane * _LANE
        x = place(max(call.came, 0.0)) if call.came is not None else None
        if x is not None and call.lost:
            parts.append(svg.shape('cross', x, y - 12, 4, svg.RED))
        elif x is not None:
            parts.append(svg.line(x, y - 18, x, y - 6, width=1.6))
        if call.began is None:
            continue
        begin = place(call.began)
        if x is not None:
            parts.append(svg.line(x, y - 6, begin, top))
        width = max(place(row.end if call.ended is None else call.ended) - begin, 1.5)
        colour = _COLOURS[(call.thread - 1) % len(_COLOURS)]
        parts.append(svg.box(begin, top, width, _LANE - 2, colour=colour))
        if width > 12:
            middle = begin + width / 2
            parts.append(svg.text(middle, top + 13, f'{call.thread}', anchor='middle', size=11))
    return ''.join(parts)


def watch_callbacks(*nodes: Node | str) -> AbstractContextManager[Callbacks]:
    """
    Record the callbacks that executors of this notebook run until the end of a ``with`` block.

    The record shows a picture as the last line of a cell, and a plain-text table with ``str()``.
    It knows lost messages only of publishers in this notebook, and late or skipped ticks only of
    timers on a real clock.

    :param nodes: nodes or their names; none for all nodes that are not hidden
    :returns: a context manager that gives the record, whose ``calls`` are the callbacks so far
    :raises RoslabError: if something else is given
    """
    return watching(Callbacks(nodes))

"""Draw on a time axis when callbacks were due, and when an executor ran them."""

from functools import partial

from rclpy.node import Node

from drawing import svg
from drawing.lanes import draw_lanes, Lane, Place
from roslab.callbacks import Call, Watch
from roslab.output import counted, text_table

_COLOURS = (svg.BLUE, svg.ORANGE, svg.GREEN, svg.RED)
_LEGEND = (
    'line: a message arrived, or a timer was due · box: the callback, with its thread number'
    ' · cross: no callback'
)
_HEAD = ('node', 'callback of', 'group', 'thread', 'came [s]', 'began [s]', 'ended [s]')
_LANE, _MIDDLE = 20.0, 23.0


class Callbacks(Watch):
    """A record of callbacks, shown as a picture in a notebook and as a table by ``str()``."""

    def __repr__(self) -> str:
        return text_table(self._table())

    def _repr_html_(self) -> str | None:
        events = self.events
        if not events:
            return None
        times = [time for call in events for time in call.times]
        # Extend the box of a callback that has not ended to the end of the watch.
        unended = any(call.began is not None and call.ended is None for call in events)
        end = (unended and self.end) or max(times)
        lanes = _lanes(events, end)
        begin = max(min(times), 0.0)  # a message may have arrived long before the watch
        title = f'Callbacks in {end - begin:.2f} seconds, {counted(lanes, "row")}'
        described = '. '.join(f'{lane.more}, {lane.label}: {lane.amount}' for lane in lanes)
        return draw_lanes(lanes, (begin, end), title, described, self._table(), legend=_LEGEND)

    def _table(self) -> list[tuple[str, ...]]:
        """Return one row per callback in chronological order."""
        events = sorted(self.events, key=lambda call: (call.came or call.began or 0, call.lost))
        rows = [_cells(call) for call in events[: svg.MAX_ROWS]]
        if len(events) > len(rows):
            rows.append((f'{len(events) - len(rows)} more', *[''] * (len(_HEAD) - 1)))
        if self.full:
            rows.append(('later callbacks are not recorded', *[''] * (len(_HEAD) - 1)))
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


def _lanes(events: list[Call], end: float) -> list[Lane]:
    """Return one row per timer, subscription or service, sorted by node and group."""
    found: dict[int, list[Call]] = {}
    for call in events:
        found.setdefault(id(call.source), []).append(call)
    lanes = []
    for calls in sorted(found.values(), key=lambda one: (one[0].source.node, one[0].source.group)):
        source, levels = calls[0].source, _levels(calls, end)
        more = ' · '.join(filter(None, (source.node, source.function, source.group)))
        draw = partial(_content, calls, levels, end)
        height = 2 * _MIDDLE + _LANE * max(levels, default=0)
        lanes.append(Lane(source.name, more, _amount(calls), draw, middle=_MIDDLE, height=height))
    return lanes


def _levels(calls: list[Call], end: float) -> list[int]:
    """Return the level of each callback; callbacks that overlap have different levels."""
    free_at: list[float] = []
    levels = []
    for call in calls:
        level = 0
        if call.began is not None:
            level = next((n for n, at in enumerate(free_at) if at <= call.began), len(free_at))
            free_at[level : level + 1] = [end if call.ended is None else call.ended]
        levels.append(level)
    return levels


def _amount(calls: list[Call]) -> str:
    """Return the numbers of callbacks and of events without a callback, as text."""
    lost = sum(call.lost for call in calls)
    pending = sum(call.began is None for call in calls) - lost
    words = [f'{len(calls) - lost - pending} called']
    return ', '.join(words + [f'{lost} not'] * bool(lost) + [f'{pending} waiting'] * bool(pending))


def _content(calls: list[Call], levels: list[int], end: float, y: float, place: Place) -> str:
    parts = []
    for call, level in zip(calls, levels):
        top = y + 1 + level * _LANE
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
        width = max(place(end if call.ended is None else call.ended) - begin, 1.5)
        colour = _COLOURS[(call.thread - 1) % len(_COLOURS)]
        parts.append(svg.box(begin, top, width, _LANE - 2, colour=colour))
        if width > 12:
            middle = begin + width / 2
            parts.append(svg.text(middle, top + 13, f'{call.thread}', anchor='middle', size=11))
    return ''.join(parts)


def watch_callbacks(*nodes: Node | str) -> Callbacks:
    """
    Record the callbacks that executors of this notebook run until the end of a ``with`` block.

    As the last line of a cell, the record shows a picture; ``str()`` returns a plain-text table.
    It shows lost messages only for publishers in this notebook, and late or skipped ticks only for
    timers on a real clock.

    :param nodes: nodes or their names; none for all nodes that are not hidden
    :returns: the record, for a ``with`` statement; its ``calls`` are the callbacks so far
    :raises RoslabError: if one of ``nodes`` is neither a node nor a name
    """
    return Callbacks(nodes)

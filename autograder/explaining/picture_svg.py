"""
Draw pictures of a run as SVG: a timeline of messages, and a graph of nodes and topics.

The data comes from :mod:`autograder.explaining.picture_data`.  Each picture has a name and a
description as text.  It uses the colours of the page, and all text in it is escaped.
"""

from collections.abc import Callable, Mapping, Sequence
import textwrap
from typing import Any

from autograder.results import shortened
from drawing import svg
from drawing.graph_layout import arrange, Arrow, Spot

_WIDTH = 760.0
_ROW = 30.0
_TOP = 24.0
_MARGIN = 8.0
_LEAST_LEFT = 60.0
_MOST_LEFT = 260.0
_TICK = 9.0
_LABEL = 34
_REMARK = 40
_LINE = 14.0
_BOX = 34.0
AXES = {
    'seconds': ('seconds', 'against time', 'times [s]'),
    'ros_seconds': ('ROS seconds', 'against time', 'times [s]'),
    'input': ('message sent', 'by the messages sent', 'at numbers'),
}
"""By unit: the words on the axis, in the title, and at the head of a column."""


def picture_html(picture: Mapping[str, Any]) -> str:
    """
    Return a picture as HTML, or an empty string if there is none.

    :param picture: from :func:`autograder.explaining.picture_data.pictures`
    """
    if picture.get('kind') == 'timeline':
        return _timeline(picture)
    return _graph(picture) if picture.get('kind') == 'graph' else ''


# -- timeline of messages --------------------------------------------------------------------


def _timeline(picture: Mapping[str, Any]) -> str:
    rows = picture['rows']
    begin, end = float(picture['begin']), float(picture['end'])
    axis, against, head = AXES[picture['unit']]
    labels = [_short(row['label']) for row in rows]
    amounts = [_amount(row) for row in rows]
    wide = max(svg.text_width(label, 12) for label in labels)
    left = _MARGIN + min(max(wide, _LEAST_LEFT), _MOST_LEFT) + 8
    right = _WIDTH - _MARGIN - max(svg.text_width(text, 11) for text in (*amounts, axis)) - 8
    span = max(end - begin, 1e-6)

    def place(value: float) -> float:
        return left + 8 + (value - begin) / span * (right - left - 16)

    bottom = _TOP + _ROW * len(rows)
    parts = []
    for tick in svg.ticks(begin, end):
        if picture['unit'] != 'input' or tick == int(tick):
            x = place(tick)
            parts.append(svg.line(x, _TOP, x, bottom + 3, faint=True))
            parts.append(svg.text(x, bottom + 16, f'{tick:g}', anchor='middle', size=11))
    parts.append(svg.text(right + 8, bottom + 16, axis, size=11, faint=True))
    for index, row in enumerate(rows):
        y = _TOP + _ROW * (index + 0.5)
        expected = row['what'] == 'expected'
        parts.append(svg.text(left, y + 4, labels[index], anchor='end', italic=expected))
        parts.append(svg.line(left + 2, y, right - 2, y, faint=True))
        parts.append(_ticks(row, y, place))
        parts.append(svg.text(right + 8, y + 4, amounts[index], size=11))
    if picture.get('deviation') is not None:
        parts.append(_deviation(place(float(picture['deviation'])), bottom, left, right))
    data = [(*row, svg.listed(one['times'])) for *row, one in zip(labels, amounts, rows)]
    title, words = f'Observed events, {against}', timeline_words(picture)
    return svg.picture(_WIDTH, bottom + 26, title, words, parts, [('row', 'amount', head), *data])


def _ticks(row: Mapping[str, Any], y: float, place: Callable[[float], float]) -> str:
    """Return the ticks of a row as one SVG path; ticks on the same half pixel are drawn once."""
    xs = sorted({round(place(float(time)) * 2) / 2 for time in row['times']})
    path = ''.join(f'M{x:g} {y - _TICK:g}v{2 * _TICK:g}' for x in xs)
    look = {
        'expected': 'stroke="currentColor" stroke-opacity=".65" stroke-dasharray="3 2"',
        'sent': f'stroke="{svg.GREEN}"',
    }.get(row['what'], f'stroke="{svg.BLUE}"')
    return f'<path d="{path}" fill="none" stroke-width="1.8" {look}/>' if path else ''


def _deviation(x: float, bottom: float, left: float, right: float) -> str:
    anchor = 'start' if x - left < 60 else 'end' if right - x < 60 else 'middle'
    return (
        svg.line(x, _TOP - 6, x, bottom, colour=svg.RED, width=1.6, dashed=True)
        + svg.shape('triangle', x, _TOP - 5, 4, svg.RED)
        + svg.text(x, _TOP - 13, 'first difference', anchor=anchor, size=11, bold=True)
    )


def timeline_words(picture: Mapping[str, Any]) -> str:
    """
    Return a description of a timeline as text.

    :param picture: a picture of the kind ``timeline``
    """
    by_input = picture['unit'] == 'input'
    word, unit = ('at numbers', '') if by_input else ('from', ' s')
    said = []
    for row in picture['rows']:
        times = row['times']
        where = f' {word} {times[0]:g} to {times[-1]:g}{unit}' if times else ''
        if times and not row.get('every_s') and len(times) < row['count']:
            where = f', {len(times)} of them shown,{where}'
        said.append(f'{_short(row["label"])}: {_amount(row)}{where}')
    at = picture.get('deviation')
    if at is not None:
        said.append(f'first difference at {f"message {at:g}" if by_input else f"{at:g} s"}')
    return '; '.join(said) + '.'


def _amount(row: Mapping[str, Any]) -> str:
    every = row.get('every_s')
    return f'one every {every:g} s' if every else f'{row["count"]} in the run'


def _short(name: str) -> str:
    return shortened(name, _LABEL)


# -- graph of nodes and topics ---------------------------------------------------------------


def _graph(picture: Mapping[str, Any]) -> str:
    arrows = picture['arrows']
    ends: dict[Arrow, Mapping[str, Any]] = {}
    remarks: dict[str, list[str]] = {arrow['topic']: [] for arrow in arrows}
    types = {arrow['topic']: _short(arrow['type']) for arrow in arrows}
    sizes: dict[str, tuple[float, float]] = {}
    for arrow in arrows:
        node, topic = f'n{arrow["node"]}', f't{arrow["topic"]}'
        sizes.setdefault(node, (max(80.0, svg.text_width(_short(arrow['node'])) + 24), _BOX))
        found = remarks[arrow['topic']]
        wrapped = textwrap.wrap(arrow['remark'], _REMARK, break_on_hyphens=False)
        found += [line for line in wrapped if line not in found][: 4 - len(found)]
        ends[(node, topic) if arrow['outward'] else (topic, node)] = arrow
    for name, kind in types.items():
        width = max(svg.text_width(line, 12) for line in (_short(name), kind, *remarks[name]))
        # Remarks are below the box; the same space above it keeps it vertically centred.
        sizes[f't{name}'] = max(100.0, width + 20), 42.0 + 2 * _LINE * len(remarks[name])
    layout = arrange(sizes, list(ends), frozenset(f't{name}' for name in types))
    parts = [_edge(layout.routes[pair], arrow) for pair, arrow in ends.items()]
    for key, spot in layout.spots.items():
        is_node, name = key[0] == 'n', key[1:]
        parts += [_node(spot, name) if is_node else _topic(spot, name, types[name], remarks[name])]
    low = layout.height + 2 * _LINE
    legend = 'rounded: node \u00b7 square: topic \u00b7 dashed with a cross: not as it should be'
    parts.append(svg.text(0, low - 2, legend, size=11, faint=True))
    width = max(layout.width, svg.text_width(legend, 11)) + 2 * _MARGIN
    moved = [f'<g transform="translate({_MARGIN:g} {_MARGIN:g})">', *parts, '</g>']
    title = 'Nodes and topics, expected and observed'
    height, table = low + 2 * _MARGIN, _graph_table(arrows)
    return svg.picture(width, height, title, _graph_words(table), moved, table)


def _graph_table(arrows: Sequence[Mapping[str, Any]]) -> Sequence[Sequence[str]]:
    """Return a table with one row per arrow, as an alternative to the picture."""
    rows = [
        (
            _short(arrow['node']),
            'publishes' if arrow['outward'] else 'subscribes to',
            _short(arrow['topic']),
            _short(arrow['type']),
            'yes' if arrow['matched'] else 'no',
            arrow['remark'],
        )
        for arrow in arrows
    ]
    return [('node', 'does', 'topic', 'type', 'as it should be', 'remark'), *rows]


def _graph_words(table: Sequence[Sequence[str]]) -> str:
    """Return the rows of the table as sentences."""
    said = (
        f'{node} {verb} {topic}{": not as it should be" if right == "no" else ""}'
        f'{f" ({remark})" if remark else ""}'
        for node, verb, topic, _, right, remark in table[1:]
    )
    return '; '.join(said) + '.'


def _node(spot: Spot, name: str) -> str:
    top = spot.y - spot.height / 2
    middle = spot.x + spot.width / 2
    return svg.box(
        spot.x, top, spot.width, spot.height, colour=svg.BLUE, rounded=spot.height / 2
    ) + svg.text(middle, spot.y + 4, _short(name), anchor='middle')


def _topic(spot: Spot, name: str, type_name: str, remarks: Sequence[str]) -> str:
    middle = spot.x + spot.width / 2
    parts = [
        svg.box(spot.x, spot.y - 21, spot.width, 42, colour=svg.ORANGE),
        svg.text(middle, spot.y - 3, _short(name), anchor='middle', bold=True),
        svg.text(middle, spot.y + 12, type_name, anchor='middle', size=11, faint=True),
    ]
    for index, remark in enumerate(remarks):
        y = spot.y + 21 + _LINE * (index + 1)
        parts.append(svg.text(middle, y, remark, anchor='middle', size=11, italic=True))
    return ''.join(parts)


def _edge(points: Sequence[tuple[float, float]], arrow: Mapping[str, Any]) -> str:
    colour = 'currentColor' if arrow['matched'] else svg.RED
    dashes = '' if arrow['matched'] else ' stroke-dasharray="6 4"'
    path = 'M' + 'L'.join(f'{x:.1f} {y:.1f}' for x, y in points)
    x, y = points[-1]
    back = -7 if points[-2][0] < x else 7
    parts = [
        f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.5"{dashes}/>',
        f'<path d="M{x:.1f} {y:.1f}l{back} -4.5v9z" fill="{colour}"/>',
    ]
    if not arrow['matched']:
        (x1, y1), (x2, y2) = points[0], points[1]
        parts.append(svg.shape('cross', (x1 + x2) / 2, (y1 + y2) / 2, 4.5, colour))
    return ''.join(parts)

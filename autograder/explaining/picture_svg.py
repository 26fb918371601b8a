"""
Draw pictures of a run as SVG: a timeline of messages, and a graph of nodes and topics.

The data comes from :mod:`autograder.explaining.picture_data`.  Each picture has a name and a
description as text.  It uses the colours of the page, and all text in it is escaped.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
import textwrap
from typing import Any

from autograder.results import shortened
from drawing import svg
from drawing.connections import arrow_row, draw_connections, Edge, TopicBox
from drawing.lanes import draw_lanes, draw_ticks, Lane, Place

_LABEL = 34
_REMARK = 40
_MOST_REMARKS = 4
AXES = {
    'seconds': ('seconds', 'against time', 'times [s]'),
    'ros_seconds': ('ROS seconds', 'against time', 'times [s]'),
    'input': ('message sent', 'by the messages sent', 'at numbers'),
}
"""By unit: the words on the axis, in the title, and at the head of a column."""
LOOKS = {
    'expected': ('currentColor', True),
    'sent': (svg.GREEN, False),
    'observed': (svg.BLUE, False),
}
"""Colour of the ticks by the kind of row, and whether they are dashed."""


def picture_html(picture: Mapping[str, Any]) -> str:
    """Return a picture from ``picture_data`` as HTML, or an empty string if there is none."""
    if picture.get('kind') == 'timeline':
        return _timeline(picture)
    return _graph(picture) if picture.get('kind') == 'graph' else ''


# -- timeline of messages --------------------------------------------------------------------


def _timeline(picture: Mapping[str, Any]) -> str:
    rows, deviation = picture['rows'], picture.get('deviation')
    axis, against, head = AXES[picture['unit']]
    lanes = [
        Lane(
            _short(row['label']),
            '',
            _amount(row),
            partial(draw_ticks, row['times'], *LOOKS[row['what']]),
            italic=row['what'] == 'expected',
        )
        for row in rows
    ]
    data = [(lane.label, lane.amount, svg.listed(row['times'])) for lane, row in zip(lanes, rows)]
    if deviation is not None:
        below = sum(lane.height for lane in lanes)
        draw = partial(_first_difference, float(deviation), below)
        lanes.insert(0, Lane('first difference', '', '', draw))
    return draw_lanes(
        lanes,
        (float(picture['begin']), float(picture['end'])),
        f'Observed events, {against}',
        timeline_words(picture),
        [('row', 'amount', head), *data],
        unit=axis,
        whole=picture['unit'] == 'input',
    )


def _first_difference(at: float, below: float, y: float, place: Place) -> str:
    """Return the mark of the first difference, with a line through all rows below its own."""
    x = place(at)
    return svg.shape('triangle', x, y, 4, svg.RED) + svg.line(
        x, y, x, y + below + 15, colour=svg.RED, width=1.6, dashed=True
    )


def timeline_words(picture: Mapping[str, Any]) -> str:
    """Return a description of a picture of the kind ``timeline`` as text."""
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
    nodes: dict[str, str] = {}
    topics: dict[str, TopicBox] = {}
    edges = []
    table: list[tuple[str, ...]] = [('node', 'does', 'topic', 'type', 'as it should be', 'remark')]
    for arrow in picture['arrows']:
        node, topic, kind = (arrow[part] for part in ('node', 'topic', 'type'))
        edge = Edge(node, topic, arrow['outward'], arrow['matched'], arrow['remark'])
        nodes[node] = _short(node)
        old = topics.get(topic, TopicBox(_short(topic), [_short(kind)]))
        new = textwrap.wrap(edge.remark, _REMARK, break_on_hyphens=False)
        remarks = dict.fromkeys((*old.remarks, *new))
        topics[topic] = replace(old, remarks=list(remarks)[:_MOST_REMARKS])
        edges.append(edge)
        shown = edge._replace(node=_short(node), topic=_short(topic))
        table.append(arrow_row(shown, _short(kind)))
    title, words = 'Nodes and topics, expected and observed', _graph_words(table)
    legend = 'rounded: node \u00b7 square: topic \u00b7 dashed with a cross: not as it should be'
    return draw_connections(nodes, topics, edges, title, words, table, [legend])


def _graph_words(table: Sequence[Sequence[str]]) -> str:
    """Return the rows of the table as sentences."""
    said = (
        f'{node} {verb} {topic}{": not as it should be" if right == "no" else ""}'
        f'{f" ({remark})" if remark else ""}'
        for node, verb, topic, _, right, remark in table[1:]
    )
    return '; '.join(said) + '.'

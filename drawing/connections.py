"""Draw nodes and topics as boxes with arrows between them."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from drawing import svg
from drawing.graph_layout import arrange, Arrow, Spot

_MARGIN = 10.0
_NODE_HEIGHT = 34.0
_TOPIC_HEIGHT = 42.0
_LINE = 15.0
_ARROW = 7.0
_MOST_PORTS = 3


class Edge(NamedTuple):
    """
    An arrow between a node and a topic.

    :param outward: True from node to topic (the node publishes), False from topic to node
    :param matched: whether the node's endpoint is matched
    :param remark: why it is not matched, or that only hidden endpoints match it
    """

    node: str
    topic: str
    outward: bool
    matched: bool
    remark: str = ''


@dataclass(frozen=True)
class TopicBox:
    """
    The texts of a topic.

    :param types: its types, inside the box
    :param remarks: lines below the box
    """

    label: str
    types: Sequence[str]
    remarks: Sequence[str] = ()

    @property
    def below(self) -> float:
        """Return the height of the remarks."""
        return _LINE * len(self.remarks)

    def size(self, ports: int) -> tuple[float, float]:
        """Return the width and height of the box with its remarks, for its number of arrows."""
        widths = [svg.text_width(self.label, 13), *(svg.text_width(t, 11) for t in self.types)]
        widths += [svg.text_width(remark, 11) - 10 for remark in self.remarks]
        more = len(self.types) - 1
        height = _height(_TOPIC_HEIGHT + _LINE * more if more >= 0 else _NODE_HEIGHT, ports)
        # The remarks are below the box; equal space above it keeps the box centred.
        return max(100.0, max(widths) + 20), height + 2 * self.below


def draw_connections(
    nodes: Mapping[str, str],
    topics: Mapping[str, TopicBox],
    edges: Sequence[Edge],
    title: str,
    described: str,
    table: svg.Table,
    notes: Sequence[str] = (),
) -> str:
    """
    Return a picture of nodes and topics.

    :param nodes: labels of the nodes by name
    :param topics: texts of the topics by name
    :param described: the contents of the picture as text
    :param notes: lines below the picture, such as a legend
    """
    arrows: dict[Arrow, Edge] = {}
    for edge in edges:
        ends = f'n{edge.node}', f't{edge.topic}'
        arrows[ends if edge.outward else ends[::-1]] = edge
    ports = Counter(key for arrow in arrows for key in arrow)
    sizes = {}
    for name, label in nodes.items():
        width = max(80.0, svg.text_width(label, 13) + 24)
        sizes[f'n{name}'] = width, _height(_NODE_HEIGHT, ports[f'n{name}'])
    boxes = {f't{name}': box for name, box in topics.items()}
    sizes |= {key: box.size(ports[key]) for key, box in boxes.items()}
    layout = arrange(sizes, list(arrows), frozenset(boxes))
    parts = [_edge(layout.routes[arrow], edge) for arrow, edge in arrows.items()]
    parts += [_node(layout.spots[f'n{name}'], label) for name, label in nodes.items()]
    parts += [_topic(layout.spots[key], box) for key, box in boxes.items()]
    # The layout reserves space above a box with remarks below; do not show it at the top.
    above = {key: box.below for key, box in boxes.items()}
    tops = (s.y - s.height / 2 + above.get(s.key, 0.0) for s in layout.spots.values())
    top = min(tops, default=0.0)
    low = layout.height + _LINE
    for note in notes:
        low += _LINE
        parts.append(svg.text(0, low - 4, note, size=11, faint=True))
    width = max([layout.width, *(svg.text_width(note, 11) for note in notes)]) + 2 * _MARGIN
    moved = f'<g transform="translate({_MARGIN:g} {_MARGIN - top:g})">{"".join(parts)}</g>'
    return svg.picture(width, low - top + 2 * _MARGIN, title, described, [moved], table)


def arrow_row(edge: Edge, types: str) -> tuple[str, ...]:
    """Return the row of an arrow in the table of a picture."""
    verb = 'publishes' if edge.outward else 'subscribes to'
    return edge.node, verb, edge.topic, types, 'yes' if edge.matched else 'no', edge.remark


def _height(least: float, ports: int) -> float:
    """Return the height of a box, which grows with the number of its arrows."""
    return least + 6.0 * max(0, ports - _MOST_PORTS)


def _node(spot: Spot, label: str) -> str:
    top = spot.y - spot.height / 2
    return svg.box(
        spot.x, top, spot.width, spot.height, colour=svg.BLUE, rounded=spot.height / 2
    ) + svg.text(spot.x + spot.width / 2, spot.y + 4.5, label, anchor='middle', size=13)


def _topic(spot: Spot, topic: TopicBox) -> str:
    height = spot.height - 2 * topic.below
    middle = spot.x + spot.width / 2
    parts = [svg.box(spot.x, spot.y - height / 2, spot.width, height, colour=svg.ORANGE)]
    y = spot.y - _LINE * len(topic.types) / 2 + 4.5
    parts.append(svg.text(middle, y, topic.label, anchor='middle', size=13, bold=True))
    for kind in topic.types:
        y += _LINE
        parts.append(svg.text(middle, y, kind, anchor='middle', size=11, faint=True))
    y = spot.y + height / 2 + 1
    for remark in topic.remarks:
        y += _LINE
        parts.append(svg.text(middle, y, remark, anchor='middle', size=11, italic=True))
    return ''.join(parts)


def _edge(points: Sequence[tuple[float, float]], edge: Edge) -> str:
    """Return an arrow that leaves and enters its boxes horizontally, crossed out if unmatched."""
    path = f'M{points[0][0]:.1f} {points[0][1]:.1f}'
    for (x1, y1), (x2, y2) in pairwise(points):
        half = (x2 - x1) / 2
        path += f'C{x1 + half:.1f} {y1:.1f} {x2 - half:.1f} {y2:.1f} {x2:.1f} {y2:.1f}'
    colour = 'currentColor' if edge.matched else svg.RED
    dashes = '' if edge.matched else ' stroke-dasharray="6 4"'
    x, y = points[-1]
    back = -_ARROW if points[-2][0] < x else _ARROW
    head = f'M{x:.1f} {y:.1f}l{back:.1f} -4.5v9z'
    parts = [
        f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.5"{dashes}/>',
        f'<path d="{head}" fill="{colour}"/>',
    ]
    if not edge.matched:
        (x1, y1), (x2, y2) = points[0], points[1]
        parts.append(svg.shape('cross', (x1 + x2) / 2, (y1 + y2) / 2, 4.5, colour))
    word = 'publishes' if edge.outward else 'subscribes'
    title = f'{edge.node} {word} {edge.topic}'
    return f'<g><title>{svg.escape(title)}</title>{"".join(parts)}</g>'

"""Show the current ROS graph as a picture or as lines of text."""

from collections import Counter
from itertools import pairwise
import textwrap

from drawing import svg
from drawing.graph_layout import arrange, Arrow, Layout, Spot
from roslab.graph_facts import Edge, Facts, only_topic, read_graph, Topic
from roslab.lookup import DISCOVERY_S, not_here, resolved
from roslab.output import counted
from roslab.ros2.graph import QUIET_TOPICS, topic_types, topics_of
from roslab.session import session
from roslab.waiting import wait_in

_MARGIN = 10.0
_NODE_HEIGHT = 34.0
_TOPIC_HEIGHT = 42.0
_LINE = 15.0
_REMARK_WIDTH = 34
_ARROW = 7.0
_MOST_PORTS = 3


class Graph:
    """The nodes and topics at one moment, shown as a picture in a notebook, otherwise as text."""

    def __init__(self, facts: Facts) -> None:
        self.facts = facts

    @property
    def nodes(self) -> list[str]:
        """Full names of the nodes."""
        return list(self.facts.nodes)

    @property
    def topics(self) -> list[str]:
        """Full names of the topics."""
        return [topic.name for topic in self.facts.topics]

    def __repr__(self) -> str:
        return graph_text(self.facts)

    def _repr_html_(self) -> str:
        return graph_html(self.facts)


def graph(topic: str | None = None, *, all: bool = False) -> Graph:
    """
    Return the current graph's nodes and topics as a picture, or as text with ``str()``.

    Nodes of this notebook appear at once, those of other programs after discovery.

    :param topic: show only this topic and its nodes
    :param all: include hidden nodes, ``/rosout`` and ``/parameter_events``
    :raises NotHereError: if the topic has no endpoint
    """
    node = session().helper
    if topic is None:
        return Graph(read_graph(node, all))
    name = resolved(node, topic)
    if not wait_in(lambda: topic_types(node, name), DISCOVERY_S):
        raise not_here('topic', name, topics_of(node))
    return Graph(only_topic(read_graph(node, all or name in QUIET_TOPICS), name))


def graph_text(facts: Facts) -> str:
    """Return one line per connection and one line per unconnected endpoint."""
    lines = []
    for topic in facts.topics:
        lines += _topic_lines(facts, topic)
    busy = {edge.node for edge in facts.edges}
    lines += [facts.label(node) for node in dict.fromkeys(facts.nodes) if node not in busy]
    return '\n'.join([*lines, _summary(facts)])


def _topic_lines(facts: Facts, topic: Topic) -> list[str]:
    middle = f'{topic.name} [{" | ".join(topic.types)}]'
    pairs = [pair for pair in facts.pairs if pair.topic == topic.name]
    lines = []
    for pair in pairs:
        arrow, reason = ('- ->', f'   {pair.reason}') if pair.reason else ('-->', '')
        names = facts.label(pair.publisher), facts.label(pair.subscription)
        lines.append(f'{names[0]} {arrow} {middle} {arrow} {names[1]}{reason}')
    if pairs:
        return lines
    for edge in facts.edges:
        if edge.topic == topic.name:
            arrow = '-->' if edge.matched else '- ->'
            ends = [facts.label(edge.node), middle]
            whole = f' {arrow} '.join(ends if edge.outward else ends[::-1])
            lines.append(f'{whole}   {edge.remark}')
    return lines or [f'{middle}   no visible endpoints']


def _summary(facts: Facts) -> str:
    if not facts.nodes and not facts.topics:
        return 'No nodes are visible now.'
    seen = f'{counted(facts.nodes, "node")}, {counted(facts.topics, "topic")}'
    without = '' if facts.everything else ' (without /rosout and /parameter_events)'
    return f'Seen now: {seen}{without}.'


def graph_html(facts: Facts) -> str:
    """Return the graph as HTML with an SVG picture."""
    nodes = list(dict.fromkeys(facts.nodes))
    remarks = {topic.name: _remarks(facts, topic) for topic in facts.topics}
    arrows: dict[Arrow, Edge] = {}
    for edge in facts.edges:
        ends = f'n{edge.node}', f't{edge.topic}'
        arrows[ends if edge.outward else ends[::-1]] = edge
    ports = Counter(key for arrow in arrows for key in arrow)
    sizes = {}
    for name in nodes:
        width = svg.text_width(facts.label(name), 13) + 24
        sizes[f'n{name}'] = max(80.0, width), _height(_NODE_HEIGHT, ports[f'n{name}'])
    for topic in facts.topics:
        key = f't{topic.name}'
        sizes[key] = _topic_size(topic, remarks[topic.name], ports[key])
    layout = arrange(sizes, list(arrows), frozenset(f't{topic.name}' for topic in facts.topics))
    parts = [_edge(layout.routes[arrow], edge) for arrow, edge in arrows.items()]
    parts += [_node(layout.spots[f'n{name}'], facts.label(name)) for name in nodes]
    parts += [
        _topic(layout.spots[f't{topic.name}'], topic, remarks[topic.name])
        for topic in facts.topics
    ]
    # The layout reserves space above a box with remarks below; do not show it at the top.
    room = {f't{name}': _LINE * len(found) for name, found in remarks.items()}
    tops = (s.y - s.height / 2 + room.get(s.key, 0.0) for s in layout.spots.values())
    return _whole(facts, layout, parts, min(tops, default=0.0))


def _whole(facts: Facts, layout: Layout, parts: list[str], top: float) -> str:
    """Return the picture with legend and summary; the drawing begins at ``top``."""
    legend = 'rounded: node \u00b7 square: topic \u00b7 dashed with a cross: not connected'
    width = max(layout.width, svg.text_width(legend, 11), svg.text_width(_summary(facts), 11))
    low = layout.height + 2 * _LINE
    moved = f'<g transform="translate({_MARGIN:g} {_MARGIN - top:g})">{"".join(parts)}'
    notes = [
        svg.text(0, low - 4, legend, size=11, faint=True) if facts.nodes else '',
        svg.text(0, low + 11, _summary(facts), size=11, faint=True),
        '</g>',
    ]
    return svg.picture(
        width + 2 * _MARGIN,
        low + _LINE - top + 2 * _MARGIN,
        'ROS graph',
        '. '.join(graph_text(facts).splitlines()),
        [moved, *notes],
        _table(facts),
    )


def _table(facts: Facts) -> svg.Table:
    """Return one row per arrow, and one per node without arrows."""
    types = {topic.name: ' | '.join(topic.types) for topic in facts.topics}
    rows = [
        (
            facts.label(edge.node),
            'publishes' if edge.outward else 'subscribes to',
            edge.topic,
            types[edge.topic],
            'yes' if edge.matched else 'no',
            edge.remark,
        )
        for edge in facts.edges
    ]
    busy = {edge.node for edge in facts.edges}
    idle = [node for node in dict.fromkeys(facts.nodes) if node not in busy]
    rows += [(facts.label(node), 'uses no topic', '', '', '', '') for node in idle]
    return [('node', 'does', 'topic', 'type', 'connected', 'remark'), *rows]


def _remarks(facts: Facts, topic: Topic) -> list[str]:
    """Return the reasons why endpoints of a topic do not match, as lines for the picture."""
    edges = [edge for edge in facts.edges if edge.topic == topic.name]
    lonely = not all(edge.matched for edge in edges)
    pairs = [pair for pair in facts.pairs if pair.topic == topic.name and pair.reason]
    found: list[str] = []
    for pair in pairs:
        if len(edges) > 2 or not lonely:
            found.append(f'{facts.label(pair.publisher)} - -> {facts.label(pair.subscription)}:')
        found.append(pair.reason)
    lone = [edge for edge in edges if edge.remark and not pairs]
    if len({edge.remark for edge in lone}) == 1:  # print a shared remark only once
        found.append(lone[0].remark)
    else:
        found += [f'{facts.label(edge.node)}: {edge.remark}' for edge in lone]
    return [
        line
        for remark in found
        for line in textwrap.wrap(remark, _REMARK_WIDTH, break_on_hyphens=False)
    ]


def _height(least: float, ports: int) -> float:
    """Return the height of a box, which grows with the number of its arrows."""
    return least + 6.0 * max(0, ports - _MOST_PORTS)


def _topic_size(topic: Topic, remarks: list[str], ports: int) -> tuple[float, float]:
    widths = [svg.text_width(topic.name, 13), *(svg.text_width(kind, 11) for kind in topic.types)]
    widths += [svg.text_width(remark, 11) - 10 for remark in remarks]
    more = len(topic.types) - 1
    height = _height(_TOPIC_HEIGHT + _LINE * more if more >= 0 else _NODE_HEIGHT, ports)
    # The remarks are below the box; equal space above it keeps the box centred.
    return max(100.0, max(widths) + 20), height + 2 * _LINE * len(remarks)


def _node(spot: Spot, label: str) -> str:
    top = spot.y - spot.height / 2
    return svg.box(
        spot.x, top, spot.width, spot.height, colour=svg.BLUE, rounded=spot.height / 2
    ) + svg.text(spot.x + spot.width / 2, spot.y + 4.5, label, anchor='middle', size=13)


def _topic(spot: Spot, topic: Topic, remarks: list[str]) -> str:
    height = spot.height - 2 * _LINE * len(remarks)
    middle = spot.x + spot.width / 2
    parts = [svg.box(spot.x, spot.y - height / 2, spot.width, height, colour=svg.ORANGE)]
    y = spot.y - _LINE * len(topic.types) / 2 + 4.5
    parts.append(svg.text(middle, y, topic.name, anchor='middle', size=13, bold=True))
    for kind in topic.types:
        y += _LINE
        parts.append(svg.text(middle, y, kind, anchor='middle', size=11, faint=True))
    y = spot.y + height / 2 + 1
    for remark in remarks:
        y += _LINE
        parts.append(svg.text(middle, y, remark, anchor='middle', size=11, italic=True))
    return ''.join(parts)


def _edge(points: list[tuple[float, float]], edge: Edge) -> str:
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

"""Show the current ROS graph as a picture or as lines of text."""

import textwrap

from drawing import svg
from drawing.connections import arrow_row, draw_connections, TopicBox
from roslab.graph_facts import Facts, only_topic, read_graph, Topic
from roslab.lookup import DISCOVERY_S, not_here, resolved
from roslab.output import counted
from roslab.ros2.graph import QUIET_TOPICS, topic_types, topics_of
from roslab.session import session, wait_in

_REMARK_WIDTH = 34


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
    legend = ['rounded: node \u00b7 square: topic \u00b7 dashed with a cross: not connected']
    return draw_connections(
        {name: facts.label(name) for name in facts.nodes},
        {one.name: TopicBox(one.name, one.types, _remarks(facts, one)) for one in facts.topics},
        facts.edges,
        'ROS graph',
        '. '.join(graph_text(facts).splitlines()),
        _table(facts),
        [*(legend if facts.nodes else []), _summary(facts)],
    )


def _table(facts: Facts) -> svg.Table:
    """Return one row per arrow, and one per node without arrows."""
    types = {topic.name: ' | '.join(topic.types) for topic in facts.topics}
    rows = [
        arrow_row(edge._replace(node=facts.label(edge.node)), types[edge.topic])
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

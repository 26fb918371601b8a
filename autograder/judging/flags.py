"""
What an instructor should look at in a recording, in words.  None of it changes a verdict.

Most of it has an innocent reason now and then, so a flag says what was seen and accuses nobody.
Nothing here depends on how fast the machine is: the same submission gets the same flags.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from autograder.exam.scenario import Scenario
from autograder.recording import Event, Recording

MANY_ENDPOINTS = 100
"""Publishers and subscriptions; a node of the course has fewer than ten."""

_OWN_TOPICS = ('/rosout', '/parameter_events')  # one publisher per node, created by rclpy


def flags_of(recording: Recording, scenario: Scenario) -> tuple[str, ...]:
    """
    Return what was noticed.

    :param scenario: what the probe did in this run
    """
    process = recording.process
    found = [*_about_topics(recording, scenario), *_about_nodes(recording)]
    if recording.of('graph') and max(_counts(recording)) > MANY_ENDPOINTS:
        found.append(f'more than {MANY_ENDPOINTS} publishers and subscriptions')
    if recording.end_reason == 'too_many_events':
        found.append('more messages and log lines than are recorded')
    if any('too_large' in message for message in recording.of('message')):
        found.append('a message too large to be recorded')
    for domain in process.get('domains', ()):
        found.append(f'the program also takes part in ROS domain {domain}')
    if process.get('left'):
        found.append('other processes of the program were still running at the end')
    if process.get('killed'):
        found.append(f'ended by the grader: {process["killed"]}')
    return tuple(found)


def _counts(recording: Recording) -> Iterator[int]:
    for graph in recording.of('graph'):
        yield graph.get('count', len(graph['endpoints']))


def _about_topics(recording: Recording, scenario: Scenario) -> Iterator[str]:
    """Say who publishes where the grader does, or where only rclpy should."""
    if recording.endpoints('publisher', '/clock'):
        yield 'the program publishes on /clock, which the grader owns'
    inputs = {topic for kind, topic, _ in scenario.endpoints() if kind == 'subscription'}
    for topic in sorted(inputs):
        if recording.endpoints('publisher', topic):
            yield f'the program publishes on {topic}, from which it gets its inputs'
    for topic in _OWN_TOPICS:
        if any(_extra_publishers(graph, topic) for graph in recording.of('graph')):
            yield f'the program publishes on {topic} by itself'


def _extra_publishers(graph: Event, topic: str) -> bool:
    """Return whether a topic has more publishers of a name than there are nodes of it."""
    nodes: Counter[str] = Counter(graph['nodes'])
    makers = Counter(
        end['node']
        for end in graph['endpoints']
        if end['topic'] == topic and end['kind'] == 'publisher'
    )
    # One may be the first news of a node whose name is not known yet.
    return any(count > max(1, nodes[node]) for node, count in makers.items())


def _about_nodes(recording: Recording) -> Iterator[str]:
    """Say which nodes are not what they seem to be."""
    if recording.of('imitated'):
        yield "a node has the name of the grader's own node"
    names = [name for graph in recording.of('graph', when='end') for name in graph['nodes']]
    if len(names) != len(set(names)):
        yield 'two nodes have the same name'
    if any(not is_a_name(name) for name in recording.nodes):
        yield 'a node has a name that ROS 2 does not allow'


def is_a_name(name: str) -> bool:
    """Return whether rclpy would have let a node have this full name."""
    return all(part.isascii() and part.isidentifier() for part in name.split('/')[1:])

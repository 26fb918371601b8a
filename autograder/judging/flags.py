"""
List facts in a recording that an instructor should look at; they do not affect a verdict.

Most flags can have an innocent explanation, so they only state a fact.  Flags do not depend on the
speed of the machine.
"""

from collections import Counter
from collections.abc import Iterator
import signal

from autograder.exam.scenario import Scenario
from autograder.judging.causes.builds import output_of
from autograder.recording import Event, Recording

_SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT)
# Exit codes after a signal by which people and systems end a process; errors cause other signals.
_ENDING = {code for one in _SIGNALS for code in (-one, 128 + one)}
MANY_ENDPOINTS = 100
"""More publishers and subscriptions than this are flagged; the course needs fewer than ten."""

_OWN_TOPICS = ('/rosout', '/parameter_events')  # one publisher per node, created by rclpy


def flags_of(recording: Recording, scenario: Scenario) -> tuple[str, ...]:
    """
    Return the flags of a run and of its second start, each only once.

    :param scenario: what the probe did in this run
    """
    starts = zip(recording.starts, scenario.starts)
    return tuple(dict.fromkeys(flag for start in starts for flag in _of_start(*start)))


def _of_start(recording: Recording, scenario: Scenario) -> Iterator[str]:
    process = recording.process
    yield from _about_topics(recording, scenario)
    yield from _about_nodes(recording)
    counts = (one.get('count', len(one['endpoints'])) for one in recording.of('graph'))
    if max(counts, default=0) > MANY_ENDPOINTS:
        yield f'more than {MANY_ENDPOINTS} publishers and subscriptions'
    if recording.end_reason == 'too_many_events':
        yield 'more messages and log lines than the grader records'
    if any('too_large' in message for message in recording.of('message')):
        yield 'a message too large to be recorded'
    if process.get('left'):
        yield 'other processes of the program were still running at the end'
    if process.get('killed'):
        yield f'ended by the grader: {process["killed"]}'
    elif process.get('exit') in _ENDING:
        yield f'ended with exit code {process["exit"]}, as after a signal from outside'
    elif process.get('exit') and scenario.build_type and 'Killed' in output_of(recording):
        yield 'printed "Killed", as after a compiler was killed'


def _about_topics(recording: Recording, scenario: Scenario) -> Iterator[str]:
    """Yield flags about topics on which only the grader or only rclpy should publish."""
    if recording.endpoints('publisher', '/clock'):
        yield 'the program publishes on /clock, which the grader owns'
    inputs = {topic for kind, topic, _ in scenario.endpoints() if kind == 'subscription'}
    for topic in sorted(inputs):
        if recording.endpoints('publisher', topic):
            yield f'the program publishes on {topic}, from which it gets its inputs'
    for topic in _OWN_TOPICS:
        if any(_extra_publishers(graph, topic) for graph in recording.of('graph')):
            yield f'the program publishes on {topic}, where only rclpy should publish'


def _extra_publishers(graph: Event, topic: str) -> bool:
    """Return whether a node name has more publishers on a topic than it has nodes."""
    nodes: Counter[str] = Counter(graph['nodes'])
    makers = Counter(
        end['node']
        for end in graph['endpoints']
        if end['topic'] == topic and end['kind'] == 'publisher'
    )
    # The first publisher may be discovered before the name of its node, so always allow one.
    return any(count > max(1, nodes[node]) for node, count in makers.items())


def _about_nodes(recording: Recording) -> Iterator[str]:
    """Yield flags about imitated, duplicate and invalid node names."""
    if recording.of('imitated'):
        yield "a node has the name of the grader's own node"
    names = [name for graph in recording.of('graph', when='end') for name in graph['nodes']]
    if len(names) != len(set(names)):
        yield 'two nodes have the same name'
    parts = (part for name in recording.nodes for part in name.split('/')[1:])
    if not all(part.isascii() and part.isidentifier() for part in parts):
        yield 'a node has a name that ROS 2 does not allow'

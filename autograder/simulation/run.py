"""
Run a program for some virtual time, with inputs at exact times and without an exam.

A first, short run shows which topics the program has.  A second run records their messages.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
import json
import re

from autograder.errors import ProbeFailed, UsageError
from autograder.exam.scenario import Scenario
from autograder.exam.steps import Advance, Feed, Join, Qos, Step
from autograder.recording import Event, Recording
from autograder.runs.observe import observe
from autograder.sandboxes.sandbox import Sandbox
from autograder.simulation.documents import Input, Order

LOOK_S = 2.0
"""Length of the first run [s]."""
MAX_RUNS = 3
"""Maximum number of full runs; a run is repeated if the program created a new topic in it."""
JOIN_NS = 200_000_000
"""Time that a late subscription needs to connect, during which no input can be sent [ns]."""
MARGIN_NS = 1_000_000
"""Time to listen beyond the end, so that events exactly at the end are recorded [ns]."""
_looks: dict[str, Recording] = {}
"""Recordings of first runs, kept because several tests often run the same program."""
_MESSAGE = re.compile(r'^\w+/msg/\w+$')


def record(order: Order, files: Mapping[str, str], sandbox: Sandbox) -> Recording:
    """
    Run a program in a sandbox on the virtual clock.

    :param files: text by relative path, including the node file
    :returns: the recording for :func:`autograder.simulation.documents.read_simulation`; if the run
        exceeded a limit, the recording ends at that time
    :raises UsageError: if an input cannot be sent, or a topic is missing
    :raises GraderError: if the grader failed
    """
    steps = (Advance(min(LOOK_S, order.seconds)),)
    scenario = Scenario(file=order.file, arguments=order.arguments, steps=steps)
    key = json.dumps([scenario.to_json(), dict(files), sandbox.mode], sort_keys=True)
    recording = _looks.get(key) or _run(scenario, files, sandbox)
    _looks[key] = recording
    for _ in range(MAX_RUNS):
        scenario = planned(order, scenario, recording)
        recording = _run(scenario, files, sandbox)
        if _types(recording, 'publisher').keys() <= scenario.watch.keys():
            break
    facts = {
        'seconds': order.seconds,
        'published': dict(sorted(scenario.watch.items())),
        'sent': {topic: feed.type for topic, feed in scenario.feeds.items()},
    }
    return Recording({**recording.header, **facts}, recording.events)


def _run(scenario: Scenario, files: Mapping[str, str], sandbox: Sandbox) -> Recording:
    try:
        return observe(scenario.file, scenario.to_json(), files, sandbox)[0]
    except ProbeFailed as error:
        if '(feed)' not in error.what:
            raise
        why = error.what.rpartition('Error: ')[2]
        raise UsageError(f'inputs: a message does not fit its type: {why}') from error


def planned(order: Order, before: Scenario, seen: Recording) -> Scenario:
    """
    Return the scenario that sends the inputs at their times and watches all known topics.

    :raises UsageError: if the program does not have a topic that the order names
    """
    watch = {**before.watch, **_types(seen, 'publisher')}
    begins = seen.of('graph', when='start')
    if not begins:  # the program ended before its first input, and would do so again
        return replace(before, watch=watch, steps=(Advance(order.seconds),))
    types = _types(seen, 'subscription')
    feed = {one.topic: _type_of(one, types) for one in order.inputs}
    end_ns = round(order.seconds * 1e9) + MARGIN_NS
    steps = tuple(_timed(begins[0]['clock_ns'], _moments(order, seen), end_ns))
    return replace(before, watch=watch, feed=feed, steps=steps)


def _moments(order: Order, seen: Recording) -> list[tuple[int, Feed | Join]]:
    """Return the steps with their times [ns], sorted; at equal times, inputs come first."""
    feeds: list[tuple[int, Feed | Join]] = [
        (round(one.at_s * 1e9), Feed(one.topic, (one.fields,), every_s=0.0, rest_s=0.0))
        for one in order.inputs
    ]
    joins = [(round(at_s * 1e9), _join(topic, seen)) for topic, at_s in order.late.items()]
    return sorted([*feeds, *joins], key=lambda moment: moment[0])


def _timed(now_ns: int, moments: Sequence[tuple[int, Feed | Join]], end_ns: int) -> Iterator[Step]:
    """Yield the steps with the waits between them; UsageError if a time is too early."""
    for at_ns, step in moments:
        if at_ns < now_ns:
            raise UsageError(
                f'{step.topic}: expected a time of at least {now_ns / 1e9:g} s, got '
                f'{at_ns / 1e9:g} s. Until then, the program or a subscription is connecting.'
            )
        if at_ns > now_ns:
            yield Advance((at_ns - now_ns) / 1e9)
        yield step
        now_ns = at_ns + (JOIN_NS if isinstance(step, Join) else 0)
    if end_ns > now_ns:
        yield Advance((end_ns - now_ns) / 1e9)


def _type_of(one: Input, types: Mapping[str, str]) -> str:
    expected = types.get(one.topic)
    if expected is None:
        raise _unknown_topic('subscribes to', one.topic, types)
    if one.type not in ('', expected):
        raise UsageError(
            f'{one.topic}: the program subscribes with the type {expected}, but the input has the '
            f'type {one.type}.'
        )
    return expected


def _join(topic: str, seen: Recording) -> Join:
    """Return a late subscription with the QoS profile of the topic's first publisher."""
    publishers = seen.endpoints('publisher', topic)
    if not publishers:
        raise _unknown_topic('publishes on', topic, _types(seen, 'publisher'))
    offered: Event = publishers[0]['qos']
    qos = Qos(offered['reliability'], offered['durability'], depth=100)
    return Join(f'late{topic}', topic, publishers[0]['type'], qos, listen_s=0.0)


def _unknown_topic(does: str, topic: str, known: Mapping[str, str]) -> UsageError:
    close = get_close_matches(topic, known, n=1, cutoff=0.6)
    fix = f'Did you mean {close[0]}?' if close else f'Known: {", ".join(sorted(known)) or "none"}.'
    return UsageError(f'{topic}: the program never {does} this topic.', fix)


def _types(recording: Recording, kind: str) -> dict[str, str]:
    """Return the types of the program's topics by name, without the topics of actions."""
    ends = recording.endpoints(kind)
    return {end['topic']: end['type'] for end in ends if _MESSAGE.match(end['type'])}

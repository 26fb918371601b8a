"""What a scenario contradicts in itself, each mistake a line with its place."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import get_close_matches
import re

from autograder.exam.scenario import Advance, Call, Feed, FeedTopic, Join, Leave, Offer, Scenario

_TYPE = re.compile(r'^[a-z]\w*/(msg|srv)/[A-Z]\w*$')
MOST_IN_A_BURST = 10


def scenario_mistakes(scenario: Scenario) -> Iterator[str]:
    """
    Yield what a scenario contradicts in itself, each with its place.

    :param scenario: of an exam
    """
    for place, topic, name in types_of(scenario):
        kind = 'msg' if topic else 'srv'
        if not _TYPE.match(name) or f'/{kind}/' not in name:
            yield f'{place}: expected a type such as {_example(kind)}, got {name!r}'
    for word, topics in (('watch', scenario.watch), ('feed', scenario.feed)):
        for topic in topics:
            if not topic.startswith('/'):
                yield f'{word} {topic!r}: expected a full topic name, got no slash at its start'
    yield from _step_mistakes(scenario)


def _example(kind: str) -> str:
    return 'std_msgs/msg/String' if kind == 'msg' else 'rcl_interfaces/srv/GetParameters'


def _step_mistakes(scenario: Scenario) -> Iterator[str]:
    """Follow what comes and goes, step by step."""
    senders, listeners = set(scenario.feed), set()
    for number, step in enumerate(scenario.steps, 1):
        place = f'step {number} ({type(step).__name__})'
        if isinstance(step, Feed):
            if step.topic not in senders:
                yield f'{place}: {_not_announced(step.topic, senders)}'
            if step.burst and len(step.messages) > MOST_IN_A_BURST:
                count = len(step.messages)
                yield f'{place}: expected at most {MOST_IN_A_BURST} messages a burst, got {count}'
        elif isinstance(step, Offer):
            senders.add(step.name)
        elif isinstance(step, Join):
            listeners.add(step.name)
        elif isinstance(step, Leave):
            if step.name not in senders | listeners:
                yield f'{place}: {_not_announced(step.name, senders | listeners)}'
            senders.discard(step.name)
            listeners.discard(step.name)
        elif isinstance(step, Advance) and not step.seconds > 0:
            yield f'{place}: expected time to pass, got {step.seconds} s'


def _not_announced(name: str, there: set[str]) -> str:
    close = get_close_matches(name, there, n=1, cutoff=0.6)
    hint = f'; did you mean {close[0]!r}?' if close else ''
    known = ', '.join(sorted(map(repr, there))) or 'nothing'
    return (
        f'expected what Scenario(feed=...), an Offer or a Join has announced, which is {known}, '
        f'got {name!r}{hint}'
    )


def types_of(scenario: Scenario) -> Iterator[tuple[str, str, str]]:
    """Yield every type the probe will load: its place, the topic or no name, and the type."""
    for topic, name in scenario.watch.items():
        yield f'watch {topic!r}', topic, name
    for topic, feed in scenario.feed.items():
        yield f'feed {topic!r}', topic, feed.type if isinstance(feed, FeedTopic) else feed
    for number, step in enumerate(scenario.steps, 1):
        if isinstance(step, Call):
            yield f'step {number} (Call) {step.service!r}', '', step.type
        elif isinstance(step, (Join, Offer)):
            yield f'step {number} ({type(step).__name__}) {step.name!r}', step.name, step.type

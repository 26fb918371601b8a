"""
Lesson 03, part 3: the courier.

The specification, as the lesson gives it: node ``courier``; a publisher of ``std_msgs/msg/String``
on ``parcels`` with depth 10; the text ``for you`` exactly once, as soon as somebody is connected.
The subscriptions come late and are volatile and reliable, so that what was published before they
came is lost, and what was published when they came is not.
"""

from __future__ import annotations

import re

from autograder.judging.causes import why_no_message, why_silent
from autograder.judging.checks import (
    require_endpoint,
    require_field,
    require_node,
    require_partner,
)
from autograder.judging.exam import Cause, Exam, Failed, Run
from autograder.runs.recording import Event
from autograder.runs.scenario import Advance, Await, Join, Mark, Scenario, Step

NODE = '/courier'
TOPIC = '/parcels'
TYPE = 'std_msgs/msg/String'
TEXT = 'for you'
AFTER_S = 3.0  # simulated time for a node that looks around with a timer [s]
EXERCISE = 'Exercise 2: the courier who waits'


def parcels(run: Run, listener: str) -> list[Event]:
    """Return what one of our subscriptions received, in order."""
    return run.recording.messages(TOPIC, listener)


def _ends(run: Run) -> list[Event]:
    """Return the publishers on the topic."""
    return run.recording.endpoints('publisher', TOPIC)


def starts_its_node(run: Run) -> None:
    """Your program starts a node called courier."""
    require_node(run, NODE)


def offers_parcels(run: Run) -> None:
    """It has a publisher of String messages on parcels."""
    require_partner(require_endpoint(run, 'publisher', TOPIC, TYPE))


def delivers_to_who_comes_late(run: Run) -> None:
    """It waits: a subscription that comes late receives the parcel."""
    # What is sent by a program that ends at once arrives, or not, by chance.
    ended = run.recording.end_reason != 'complete' and run.recording.process.get('exit') == 0
    if run.recording.phase('first').messages(TOPIC, 'first') and not ended:
        return
    if run.recording.of('joined', listener='first') and ended:
        why = Cause(
            'exited_early',
            'The program ended as soon as somebody was connected, and its message with it.',
            'Let the node live on after the delivery: self.timer.cancel() ends the search.',
        )
    elif parcels(run, 'first') and not ended:
        why = Cause(
            'waits_for_two',
            'Nothing is delivered until a second subscription is there.',
            'Deliver as soon as get_subscription_count() is above 0.',
        )
    else:
        why = why_silent(run) or _why_nothing(run)
    raise Failed(
        expected='one message for a subscription that comes after some seconds',
        observed='a program that is gone' if ended else 'a subscription that receives nothing',
        why=why,
    )


def _why_nothing(run: Run) -> Cause:
    """Explain a courier that is connected and lives, and from whom nothing comes."""
    code = '\n'.join(run.files.values())
    if '.publish(' not in code:
        return why_no_message(run)
    if not re.search(r'create_timer|matched\s*=|\bwhile\b', code):
        return Cause(
            'published_too_early',
            'What your program does at its start, it does before anybody is connected, and '
            'nothing looks again later.',
            'Let a timer look: publish when get_subscription_count() is above 0.',
        )
    if 'get_subscription_count' in code or 'matched' in code:
        return Cause(
            'looks_wrong',
            'Your program looks who is connected, and yet delivers nothing when somebody is: it '
            'stops looking too early, or its condition is not true then.',
            'Deliver when get_subscription_count() > 0, and cancel the timer after the delivery '
            'and not before.',
        )
    return Cause(
        'published_too_early',
        'Nothing came once somebody was connected. Most likely the parcel was published '
        'before, and what nobody receives is lost.',
        'Publish when get_subscription_count() is above 0, or in a callback for matched.',
    )


def addresses_the_parcel(run: Run) -> None:
    """The text of the parcel is: for you."""
    require_field(run, parcels(run, 'first')[:1], 'data', TEXT)


def delivers_once(run: Run) -> None:
    """It delivers exactly once: no second message, whoever else comes."""
    if any(end['qos']['durability'] != 'VOLATILE' for end in _ends(run)):
        raise Failed(
            expected='a publisher that keeps nothing for those who come later',
            observed='durability TRANSIENT_LOCAL',
            why=Cause(
                'qos_durability',
                'With this durability everybody who comes later and asks for old messages gets '
                'the parcel again.',
                'Pass the depth 10 as quality of service.',
            ),
        )
    first, second = len(parcels(run, 'first')), len(parcels(run, 'second'))
    if (first, second) == (1, 0) and run.recording.of('joined', listener='second'):
        return
    why = why_silent(run)
    if not why and (first > 2 or (first > 1 and not second)):
        why = Cause(
            'repeats',
            'The parcel is published again and again.',
            'Remember that it was delivered: cancel the timer, or set a flag and look at it.',
        )
    elif not why and second:
        why = Cause(
            'repeats',
            'Who comes second receives a parcel too.',
            'Remember that it was delivered: cancel the timer, or set a flag and look at it.',
        )
    raise Failed(
        expected='1 message for who comes first, none for who comes second',
        observed=f'{first} for the first, {second or "none"} for the second',
        why=why,
    )


def build(alone_s: float, between_s: float = AFTER_S) -> Exam:
    """
    Return the exam for one late comer and one who comes later still.

    :param alone_s: simulated time before the first comes [s]
    :param between_s: simulated time between the two [s]
    """
    steps: tuple[Step, ...] = (
        Advance(alone_s, phase_s=0.1),
        Mark('first'),
        Join('first', TOPIC, TYPE),
        Advance(between_s, phase_s=0.25),
        Await(messages=1, seconds=1.0),
        Mark('second'),
        Join('second', TOPIC, TYPE),
        Advance(AFTER_S, phase_s=0.25),
    )
    exam = Exam(
        'courier',
        title='The courier',
        assignment='03_topics',
        part=2,
        cells=('courier',),
        requires=('courier.py',),
        scenario=Scenario(file='courier.py', steps=steps),
        read='Part 3: Discovery takes time',
    )
    exam.check(points=1, read=EXERCISE)(starts_its_node)
    exam.check(points=1, read='Part 1: Speaking and listening')(offers_parcels)
    exam.check(points=4, needs=['offers_parcels'])(delivers_to_who_comes_late)
    for points, judge, read in (
        (1, addresses_the_parcel, EXERCISE),
        (3, delivers_once, ''),
    ):
        exam.check(points=points, needs=['delivers_to_who_comes_late'], read=read)(judge)
    return exam


exam = build(alone_s=4.0)

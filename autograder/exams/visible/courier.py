"""
Lesson 03, part 3: the courier.

The specification, as the lesson gives it: node ``courier``; a publisher of ``std_msgs/msg/String``
on ``parcels`` with depth 10; the text ``for you`` exactly once, as soon as somebody is connected.
The subscriptions come late and are volatile and reliable, so that what was published before they
came is lost, and what was published when they came is not.
"""

from __future__ import annotations

from autograder.causes import why_silent
from autograder.checks import require_endpoint, require_field, require_node
from autograder.exam import Cause, Exam, Failed, Run
from autograder.recording import Event
from autograder.scenario import Advance, Await, Join, Mark, Scenario, Step

NODE = '/courier'
TOPIC = '/parcels'
TYPE = 'std_msgs/msg/String'
TEXT = 'for you'
AFTER_S = 3.0  # simulated time for a node that looks around with a timer [s]


def parcels(run: Run, listener: str) -> list[Event]:
    """Return what one of our subscriptions received, in order."""
    return run.recording.messages(TOPIC, listener)


def starts_its_node(run: Run) -> None:
    """Your program starts a node called courier."""
    require_node(run, NODE)


def offers_parcels(run: Run) -> None:
    """It has a publisher of String messages on parcels."""
    require_endpoint(run, 'publisher', TOPIC, TYPE)


def delivers_to_who_comes_late(run: Run) -> None:
    """It waits: a subscription that comes late receives the parcel."""
    # What is sent by a program that ends at once arrives, or not, by chance.
    ended = run.recording.end_reason != 'complete' and run.recording.process.get('exit') == 0
    if parcels(run, 'first') and not ended:
        return
    joined = run.recording.of('joined', listener='first')
    if joined and not joined[0]['matched']:
        refused = ', '.join(joined[0]['refused']).lower() or 'no policy'
        why = why_silent(run) or Cause(
            'qos_incompatible',
            f'The subscription was not connected: the two do not agree on {refused}.',
            'Pass the depth 10 as quality of service.',
        )
    elif joined and ended:
        why = Cause(
            'ended_too_soon',
            'The program ended as soon as somebody was connected, and its message with it.',
            'Let the node live on after the delivery: self.timer.cancel() ends the search.',
        )
    else:
        why = why_silent(run) or Cause(
            'published_too_early',
            'Nothing came once somebody was connected. Most likely the parcel was published '
            'before, and what nobody receives is lost.',
            'Publish when get_subscription_count() is above 0, or in a callback for matched.',
        )
    raise Failed(
        expected='one message for a subscription that comes after some seconds',
        observed='a program that is gone' if ended else 'a subscription that receives nothing',
        why=why,
    )


def addresses_the_parcel(run: Run) -> None:
    """The text of the parcel is: for you."""
    require_field(parcels(run, 'first')[:1], 'data', TEXT)


def delivers_once(run: Run) -> None:
    """It delivers exactly once: no second message, whoever else comes."""
    first, second = len(parcels(run, 'first')), len(parcels(run, 'second'))
    if (first, second) == (1, 0) and run.recording.of('joined', listener='second'):
        return
    why = why_silent(run)
    if not why and first > 1 and not second:
        why = Cause(
            'repeats',
            'The parcel is published again and again, or for each who comes.',
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
    exam.check(points=1)(starts_its_node)
    exam.check(points=1)(offers_parcels)
    exam.check(points=4, needs=['offers_parcels'])(delivers_to_who_comes_late)
    for points, judge in ((1, addresses_the_parcel), (3, delivers_once)):
        exam.check(points=points, needs=['delivers_to_who_comes_late'])(judge)
    return exam


exam = build(alone_s=4.0)

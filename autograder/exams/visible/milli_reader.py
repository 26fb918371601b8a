"""
Lesson 04, part 2: from one message type to another.

The specification, as the lesson gives it: node ``milli_reader`` hears ``temp_monitor_pkg/msg/Num``
on ``raw`` and publishes, one for one, a ``temp_monitor_pkg/msg/Temperature`` on ``readings``: the
number divided by 1000, Celsius, the description as sensor, and the time of the node's own clock.
The program follows a ROS clock that is far from the computer's, so a stamp from any other shows.
"""

from __future__ import annotations

from collections.abc import Sequence
import math

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Advance, Feed, RosClock, Scenario, Step
from autograder.judging.causes.ended import why_silent
from autograder.judging.causes.redaction import own_words
from autograder.judging.checks import (
    field_of,
    require_endpoint,
    require_field,
    require_node,
    require_partner,
    SECOND,
)
from autograder.recording import Event

NODE = '/milli_reader'
SOURCE, TARGET = '/raw', '/readings'
SOURCE_TYPE = 'temp_monitor_pkg/msg/Num'
TARGET_TYPE = 'temp_monitor_pkg/msg/Temperature'
MOST_MICROSECONDS = 1_000_000  # in a second
OTHER_CLOCK_S = 1000  # this far from the ROS clock, a stamp is from another one
CLOCK = RosClock(begins_s=5_000.1)  # so no tick has whole seconds
EXERCISE = 'Exercise 4.2: from one type to another'


def readings(run: Run) -> list[Event]:
    """Return what came on the target topic, that of a burst in the order of its numbers."""
    found = [event for event in run.recording.messages(TARGET) if 'data' in event]
    names, burst = run.facts['names'], run.facts['burst']
    by_name = {field_of(event, 'sensor_id'): event for event in found[len(found) - burst :]}
    last = names[len(names) - burst :]
    # Several threads may answer it in any order.
    if len(found) != len(names) or set(by_name) != set(last):
        return found
    return [*found[: len(found) - burst], *(by_name[name] for name in last)]


def starts_its_node(run: Run) -> None:
    """Your program starts a node called milli_reader."""
    require_node(run, NODE)


def hears_and_publishes(run: Run) -> None:
    """It subscribes to Num on raw and publishes Temperature on readings."""
    require_partner(require_endpoint(run, 'subscription', SOURCE, SOURCE_TYPE))
    require_partner(require_endpoint(run, 'publisher', TARGET, TARGET_TYPE))


def answers_one_for_one(run: Run) -> None:
    """For each number it publishes exactly one reading."""
    found, numbers = run.recording.messages(TARGET), len(run.facts['numbers'])
    for count, event in enumerate(found, 1):
        sent = 0 if event['after_input'] is None else event['after_input'] + 1
        if count > sent:
            raise Failed(
                expected='1 message on readings for each number',
                observed=f'{count} after {sent} number{"" if sent == 1 else "s"}',
                why=_why_too_many(sent),
            )
    if len(found) < numbers:
        raise Failed(
            expected=f'{numbers} messages on readings for as many numbers',
            observed=f'{len(found) or "none"}',
            why=why_silent(run) or _why_too_few(len(found)),
        )


def _why_too_many(sent: int) -> Cause:
    if not sent:
        return Cause(
            'speaks_unasked',
            'Your node publishes a reading before any number has come.',
            'Publish in the callback of the subscription, and from nowhere else.',
        )
    return Cause(
        'several_answers',
        'More than one reading is published for one number.',
        'Publish once in the callback, and from nowhere else.',
    )


def _why_too_few(found: int) -> Cause:
    if not found:
        return Cause(
            'no_answer',
            'Nothing is published when a number arrives.',
            'Publish in the callback of the subscription, for each message.',
        )
    return Cause(
        'misses_some',
        'Not every number gets a reading. Several numbers may come at once.',
        'Publish in the callback of the subscription, once for each message.',
    )


def divides_by_a_thousand(run: Run) -> None:
    """temperature_value is the number divided by 1000, as a float."""
    numbers: Sequence[int] = run.facts['numbers']
    values = [float(field_of(event, 'temperature_value')) for event in readings(run)]
    for number, value in zip(numbers, values, strict=False):
        if not math.isclose(value, number / 1000, rel_tol=1e-9, abs_tol=1e-9):
            raise Failed(
                expected='the number divided by 1000, with its fraction',
                observed='another value' if run.secret and value else f'{value:.12g}',
                why=_why_value(numbers, values),
            )


def _why_value(numbers: Sequence[int], values: Sequence[float]) -> Cause | None:
    pairs = list(zip(numbers, values, strict=False))
    if all(math.isclose(value, abs(number) / 1000) for number, value in pairs):
        return Cause('sign_lost', 'Numbers below zero lose their sign.', 'Leave out abs().')
    if all(value in (number // 1000, int(number / 1000)) for number, value in pairs):
        return Cause(
            'whole_numbers',
            'The fraction is lost: //, int() and round() give whole numbers.',
            'Divide with / and a float, and leave it so: number.num / 1000.0.',
        )
    if all(value == number for number, value in pairs):
        return Cause('not_divided', 'The number is passed on as it came.', 'Divide it by 1000.0.')
    if not any(values):
        return Cause(
            'value_not_set',
            'temperature_value is 0.0: it was never set.',
            'Set reading.temperature_value = number.num / 1000.0.',
        )
    if all(math.isnan(value) or abs(value) < 1e-300 for value in values):
        return Cause(
            'field_value',
            'A whole number was put into a float64 with field checks off.',
            'Assign a float: number.num / 1000.0.',
        )
    ratios = [number / value for number, value in pairs if value]
    if len(ratios) == len([number for number in numbers if number]) and math.isclose(
        min(ratios), max(ratios), rel_tol=1e-9
    ):
        return Cause(
            'wrong_factor',
            f'The number is divided by {ratios[0]:g}.',
            'A thousand thousandths are one: divide by 1000.0.',
        )
    if all(abs(value - number / 1000) < 2 for number, value in pairs):
        return Cause(
            'rounded',
            'The fraction is not right: the value is rounded, or put together from digits.',
            'Divide, and neither round nor format: number.num / 1000.0.',
        )
    return None


def names_unit_and_sensor(run: Run) -> None:
    """The unit is Celsius, and the sensor is the description of the number."""
    found = readings(run)
    require_field(run, found, 'unit', 'Celsius')
    for event, name in zip(found, run.facts['names'], strict=False):
        if field_of(event, 'sensor_id') != name:
            raise Failed(
                expected='the description of the Num in sensor_id',
                observed=own_words(run, field_of(event, 'sensor_id'), 'another text')[:60],
                why=Cause(
                    'sensor_id',
                    'sensor_id is something else than the description that arrived.',
                    'Set reading.sensor_id = number.description.',
                ),
            )


def stamps_with_its_own_clock(run: Run) -> None:
    """The timestamp is the time of the node's own clock when the number arrives."""
    for number, event in zip(run.recording.of('input'), readings(run), strict=False):
        sec, nanosec = (field_of(event, f'timestamp.{part}') for part in ('sec', 'nanosec'))
        told = CLOCK.at(number['clock_ns'])
        # Between the number and a late answer to it, the time has gone on.
        if not told <= sec * SECOND + nanosec <= CLOCK.at(event['clock_ns']):
            raise Failed(
                expected=f'the time on the ROS clock when the number came, {told / SECOND:.2f} s',
                # A hidden number may be in it.
                observed='another time' if run.secret else f'{sec}.{nanosec:09d} s',
                why=_why_stamp(sec, nanosec, told // SECOND),
            )


def _why_stamp(sec: int, nanosec: int, told_s: int) -> Cause:
    take = 'Take it in the callback: reading.timestamp = self.get_clock().now().to_msg().'
    if sec == nanosec == 0:
        return Cause(
            'missing_stamp',
            'The stamp is 0: it was never set, or taken before the clock ran, as in __init__.',
            take,
        )
    if abs(sec - told_s) > OTHER_CLOCK_S:
        return Cause(
            'other_clock',
            "The stamp is not from the node's own clock: a clock of another kind does not follow "
            'the ROS time, and sec counts seconds.',
            take,
        )
    if nanosec == 0 and sec == told_s:
        return Cause(
            'no_nanoseconds',
            'The stamp has whole seconds only: nanosec was never set.',
            take,
        )
    if sec == told_s and nanosec < MOST_MICROSECONDS:
        slip = 'nanosec counts milliseconds or microseconds, not nanoseconds.'
        return Cause('nanoseconds', slip, take)
    return Cause(
        'stale_stamp', 'The stamp was taken at another moment, or its parts are wrong.', take
    )


def build(numbers: Sequence[int], names: Sequence[str], burst: int = 0) -> Exam:
    """
    Return the exam for some numbers.

    :param numbers: thousandths of a degree; but for zero, none is a multiple of 1000
    :param names: the description of each, those of the burst different
    :param burst: how many of them are sent at once at the end, at most five
    """
    sent = [
        {'num': number, 'description': name} for number, name in zip(numbers, names, strict=True)
    ]
    singles = len(sent) - burst
    steps: list[Step] = [Advance(2.0), Feed(SOURCE, sent[:singles])]
    if burst:
        steps.append(Feed(SOURCE, sent[singles:], burst=True))
    exam = Exam(
        'milli_reader',
        title='From one message type to another',
        assignment='04_messages',
        part=2,
        cells=('milli_reader',),
        requires=('milli_reader.py',),
        scenario=Scenario(
            file='milli_reader.py',
            watch={TARGET: TARGET_TYPE},
            feed={SOURCE: SOURCE_TYPE},
            steps=tuple(steps),
            ros_clock=CLOCK,
        ),
        read='Part 5: The choice',
        facts={'numbers': tuple(numbers), 'names': tuple(names), 'burst': burst},
    )
    exam.check(points=1, read=EXERCISE)(starts_its_node)
    exam.check(
        points=1, needs=['starts_its_node'], read='lesson 03, Part 1: Speaking and listening'
    )(hears_and_publishes)
    exam.check(points=2, needs=['hears_and_publishes'], read=EXERCISE)(answers_one_for_one)
    for points, judge, read in (
        (2, divides_by_a_thousand, EXERCISE),
        (2, names_unit_and_sensor, EXERCISE),
        (2, stamps_with_its_own_clock, 'Part 4: Time'),
    ):
        exam.check(points=points, needs=['answers_one_for_one'], read=read)(judge)
    return exam


exam = build([21500, -40, 0, 100001], ['oven', 'fridge', '', 'kettle'])

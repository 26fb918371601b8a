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
from autograder.exam.slips import MISSES_SOME, NO_ANSWER, SEVERAL_ANSWERS, UNASKED
from autograder.exam.specification import each, Slip, Specification
from autograder.judging.causes.ended import why_silent
from autograder.judging.causes.redaction import own_words
from autograder.judging.checks import field_of, require_field
from autograder.judging.claims import node, passes
from autograder.judging.stamps import require_stamps
from autograder.recording import Event

NODE = '/milli_reader'
SOURCE, TARGET = '/raw', '/readings'
SOURCE_TYPE = 'temp_monitor_pkg/msg/Num'
TARGET_TYPE = 'temp_monitor_pkg/msg/Temperature'
CLOCK = RosClock(begins_s=5_000.1)  # so no tick has whole seconds
EXERCISE = 'Exercise 4.2: from one type to another'


ROUNDED = Cause(
    'rounded',
    'The fraction is not right: the value is rounded, or put together from digits.',
    'Divide, and neither round nor format: number.num / 1000.0.',
)
WHOLE = Cause(
    'whole_numbers',
    'The fraction is lost: //, int() and round() give whole numbers.',
    'Divide with / and a float, and leave it so: number.num / 1000.0.',
)


SLIPS = (
    Slip(
        'sign_lost',
        'Numbers below zero lose their sign.',
        'Leave out abs().',
        each(lambda number: abs(number) / 1000),
    ),
    Slip.of(WHOLE, each(lambda number: float(number // 1000))),
    Slip.of(WHOLE, each(lambda number: float(int(number / 1000)))),
    Slip.of(WHOLE, each(lambda number: float(round(number / 1000)))),
    Slip(
        'not_divided',
        'The number is passed on as it came.',
        'Divide it by 1000.0.',
        each(float),
    ),
    Slip(
        'value_not_set',
        'temperature_value is 0.0: it was never set.',
        'Set reading.temperature_value = number.num / 1000.0.',
        each(lambda number: 0.0),
    ),
    # CPython reads what is no float as one: the size of a whole number, which has its sign.
    Slip(
        'field_value',
        'A whole number was put into a float64 with field checks off.',
        'Assign a float: number.num / 1000.0.',
        each(lambda number: math.nan if number < 0 else 0.0),
    ),
    *(
        Slip.of(ROUNDED, each(lambda number, digits=digits: round(number / 1000, digits)))
        for digits in (1, 2)
    ),
)


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


def answers_one_for_one(run: Run) -> None:
    """For each number it publishes exactly one reading."""
    found, numbers = run.recording.messages(TARGET), len(run.facts['numbers'])
    for count, event in enumerate(found, 1):
        sent = 0 if event['after_input'] is None else event['after_input'] + 1
        if count > sent:
            raise Failed(
                expected='1 message on readings for each number',
                observed=f'{count} after {sent} number{"" if sent == 1 else "s"}',
                why=SEVERAL_ANSWERS if sent else UNASKED,
            )
    if len(found) < numbers:
        raise Failed(
            expected=f'{numbers} messages on readings for as many numbers',
            observed=f'{len(found) or "none"}',
            why=why_silent(run) or (MISSES_SOME if found else NO_ANSWER),
        )


def divides_by_a_thousand(run: Run) -> None:
    """temperature_value is the number divided by 1000, as a float."""
    asked: Specification = run.facts['values']
    found = readings(run)[: len(asked.inputs)]
    values = [field_of(event, 'temperature_value') for event in found]
    for place in asked.wrong(values)[:1]:
        raise Failed(
            expected='the number divided by 1000, with its fraction',
            observed='another value' if run.secret and values[place] else f'{values[place]:.12g}',
            why=asked.cause(values, place) or _why_near(asked, values),
        )


def _why_near(asked: Specification, values: Sequence[float]) -> Cause | None:
    """Explain values that come from another factor, or are nearly right."""
    pairs = list(zip(values, asked.answers, strict=False))
    factors = {f'{1000 * due / value:.9g}' for value, due in pairs if value}
    if len(factors) == 1 and all(value or not due for value, due in pairs):
        return Cause(
            'wrong_factor',
            f'The number is divided by {factors.pop()}.',
            'A thousand thousandths are one: divide by 1000.0.',
        )
    return ROUNDED if all(abs(value - due) < 2 for value, due in pairs) else None


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
    sent = run.recording.of('input')
    found = zip(readings(run), (one['clock_ns'] for one in sent), strict=False)
    require_stamps(run, found, CLOCK)


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
        scenario=Scenario(
            file='milli_reader.py',
            watch={TARGET: TARGET_TYPE},
            feed={SOURCE: SOURCE_TYPE},
            steps=tuple(steps),
            ros_clock=CLOCK,
        ),
        read='Part 5: The choice',
        facts={'numbers': tuple(numbers), 'names': tuple(names), 'burst': burst},
        asks={'values': Specification(numbers, each(lambda number: number / 1000), SLIPS)},
    )
    exam.check(points=1, read=EXERCISE)(node(NODE))
    exam.check(
        points=1, needs=['starts_its_node'], read='lesson 03, Part 1: Speaking and listening'
    )(passes((SOURCE, SOURCE_TYPE), (TARGET, TARGET_TYPE), 'hears_and_publishes'))
    exam.check(points=2, needs=['hears_and_publishes'], read=EXERCISE)(answers_one_for_one)
    for points, judge, read in (
        (2, divides_by_a_thousand, EXERCISE),
        (2, names_unit_and_sensor, EXERCISE),
        (2, stamps_with_its_own_clock, 'Part 4: Time'),
    ):
        exam.check(points=points, needs=['answers_one_for_one'], read=read)(judge)
    return exam


exam = build([21500, -40, 0, 100001], ['oven', 'fridge', '', 'kettle'])

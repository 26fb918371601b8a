"""
Lesson 04, part 2: from one message type to another.

Specification from the lesson: node ``milli_reader`` subscribes to ``temp_monitor_pkg/msg/Num`` on
``raw`` and publishes one ``temp_monitor_pkg/msg/Temperature`` on ``readings`` for each message:
the number divided by 1000, Celsius, the description as sensor id, and the time of the node's own
clock.

The program follows a ROS clock that is far from the computer's clock, so a stamp from any other
clock is detected.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import RosClock, Scenario
from autograder.exam.slips import changing, leaving_out
from autograder.exam.specification import each, Rule, Specification
from autograder.exam.steps import Advance, feeds
from autograder.exam.words import Causes
from autograder.judging.causes.redaction import safe_quotation
from autograder.judging.checks import require_field
from autograder.judging.claims import node, one_for_one, passes
from autograder.judging.rows import published, rows, shown_values
from autograder.judging.stamps import require_stamps

NODE = '/milli_reader'
SOURCE, TARGET = '/raw', '/readings'
SOURCE_TYPE = 'temp_monitor_pkg/msg/Num'
TARGET_TYPE = 'temp_monitor_pkg/msg/Temperature'
CLOCK = RosClock(begins_s=5_000.1)  # no tick falls on a whole second
EVERY_S = 2.3
"""
Time between two numbers [s], enough for a thread that answers late.

No timer of 0.5 s or 1 s ticks with every number, so a stamp that a timer took is detected.
"""
SMALLEST = 1e-300  # no thousandth of a number is smaller, except zero
EXERCISE = 'Exercise 2: from one type to another'

WHY = Causes(__file__)


@dataclass(frozen=True)
class Num:
    """One message that the probe sends."""

    num: int
    description: str
    values: Sequence[float] = ()


def converting(change: Callable[[int], float] = lambda number: number / 1000) -> Rule:
    """Return the rule of a reader with a given conversion, by default the correct one."""
    return each(lambda one: (change(one.num),))


def renaming(change: Callable[[str], str] = str) -> Rule:
    """Return the rule of a reader that changes the name of the sensor; by default, unchanged."""
    return each(lambda one: (change(one.description),))


SLIPS = (
    *leaving_out(converting(), lambda one: one.num),
    WHY.slip(
        'out_of_range', each(lambda one: (one.num / 1000,) if -40 <= one.num / 1000 <= 125 else ())
    ),
    *changing(lambda change: converting(lambda number: change(number / 1000))),
    WHY.slip(
        'sign_lost_near_zero',
        converting(lambda number: abs(number) / 1000 if -1000 < number < 0 else number / 1000),
    ),
    WHY.slip('not_divided', converting(float)),
    WHY.slip('value_not_set', converting(lambda number: 0.0)),
)

NAME_SLIPS = (
    WHY.slip('first_name', lambda inputs: [(inputs[0].description,) for _ in inputs]),
    WHY.slip(
        'name_changed', *(renaming(one) for one in (str.strip, str.lower, str.upper, str.title))
    ),
)


def divides_by_a_thousand(run: Run) -> None:
    """temperature_value is the number divided by 1000, as a float."""
    asked = run.asked('values')
    came = published(run, 'values', TARGET, 'temperature_value')
    for place in asked.wrong(came)[:1]:
        raise Failed(
            expected='the number divided by 1000, with its fraction',
            observed=shown_values(run, came[place], 'a different value'),
            why=_why_unchecked(came) or asked.cause(came, place) or _why_near(asked, came),
        )


def _why_unchecked(came: Sequence[tuple[Any, ...] | None]) -> Cause | None:
    """
    Explain values that no calculation gives.

    Without field checks, the C code of a message reads the size and sign of an int as if they were
    a double: a number below 1e-300, or NaN for negative numbers before Python 3.12.
    """
    values = [value for row in came for value in row or () if isinstance(value, float)]
    return WHY['field_value'] if any(0 < value < SMALLEST for value in values) else None


def _why_near(asked: Specification, came: Sequence[tuple[Any, ...] | None]) -> Cause | None:
    """Explain values that are nearly right or result from a wrong factor."""
    pairs = [
        (float(value), due)
        for values, row in zip(came, asked.answers)
        for value, due in zip(values or (), row)
        if value is not None
    ]
    factors = {f'{1000 * due / value:.9g}' for value, due in pairs if value}
    if len(factors) == 1 and all(value or not due for value, due in pairs):
        return WHY.of('wrong_factor', factor=factors.pop())
    if all(abs(value - due) < 1e-9 for value, due in pairs if due >= 0):
        return WHY['wrong_below_zero']
    return WHY['rounded'] if all(abs(value - due) < 2 for value, due in pairs) else None


def names_unit_and_sensor(run: Run) -> None:
    """The unit is Celsius, and the sensor is the description of the number."""
    require_field(run, run.recording.messages(TARGET), 'unit', 'Celsius')
    asked = run.asked('names')
    came = published(run, 'names', TARGET, 'sensor_id')
    wrong = asked.wrong(came)
    for place in wrong[:1]:
        others = (one for one in came[place] or () if one and one not in asked.answers[place])
        unnamed = all('' in asked.answers[one] for one in wrong)
        raise Failed(
            expected='the description of the Num in sensor_id',
            observed=safe_quotation(run, next(others, ''), 'a different sensor_id')[:60],
            why=asked.cause(came, place) or (WHY['fills_empty'] if unnamed else WHY['sensor_id']),
        )


def stamps_with_its_own_clock(run: Run) -> None:
    """The timestamp is the time on the node's own clock when the number arrives."""
    found = rows(run, 'values', run.recording.messages(TARGET))
    sent = [one['clock_ns'] for one in run.recording.of('input')]
    pairs = ((one, at) for row, at in zip(found, sent) for one in row or () if 'data' in one)
    require_stamps(run, pairs, CLOCK)


def build(numbers: Sequence[int], names: Sequence[str], burst: int = 0) -> Exam:
    """
    Return the exam for some numbers.

    :param numbers: thousandths of a degree; none except zero is a multiple of 1000
    :param names: the description of each number; those in the burst are all different
    :param burst: number of messages at the end that are sent at once
    """
    # Vary the field ``values``, which the exercise does not use, to detect a node that reads it.
    # It depends on the number, so that a repeated message is the same in every field.
    inputs = [
        Num(number, name, [1.5] * (number % 3))
        for number, name in zip(numbers, names, strict=True)
    ]
    sent = [asdict(one) for one in inputs]
    exam = Exam(
        'milli_reader',
        title='From one message type to another',
        assignment='04_messages',
        part=2,
        scenario=Scenario(
            file='milli_reader.py',
            watch={TARGET: TARGET_TYPE},
            feed={SOURCE: SOURCE_TYPE},
            steps=(Advance(2.0), *feeds(SOURCE, sent, burst, every_s=EVERY_S)),
            ros_clock=CLOCK,
        ),
        read='Part 5: The choice',
        asks={
            'values': Specification(inputs, converting(), SLIPS, burst),
            'names': Specification(inputs, renaming(), NAME_SLIPS, burst),
        },
    )
    exam.check(points=1, read=EXERCISE)(node(NODE, only_named=True))
    exam.check(
        points=1, needs=['starts_its_node'], read='lesson 03, Part 1: Speaking and listening'
    )(passes((SOURCE, SOURCE_TYPE), (TARGET, TARGET_TYPE), 'hears_and_publishes'))
    exam.check(points=2, needs=['hears_and_publishes'], read=EXERCISE)(
        one_for_one(
            'values',
            TARGET,
            'answers_one_for_one',
            'For each number it publishes exactly one reading.',
        )
    )
    needs = ['answers_one_for_one']
    exam.check(points=2, needs=needs, read=EXERCISE)(divides_by_a_thousand)
    exam.check(points=2, needs=needs, read=EXERCISE)(names_unit_and_sensor)
    exam.check(points=2, needs=needs, read='Part 4: Time')(stamps_with_its_own_clock)
    return exam


exam = build([21500, -40, 0, 100001], ['oven', 'fridge', '', 'kettle'])

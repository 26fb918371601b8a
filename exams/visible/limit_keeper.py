"""
Lesson 07, part 5: a node that accepts only sensible limits.

Specification from the lesson: node ``limit_keeper`` with the parameters ``limit_c``, a float with
the default 30.0, and ``place``, any string, at first ``motor``; the node refuses a new
``limit_c``, with a reason, unless it is from -40.0 to 125.0, and keeps the old limit; each
``std_msgs/msg/Float64`` on ``motor_temperature`` above the limit in force causes one WARN line.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
import math
import operator
from typing import NamedTuple

from autograder.exam.exam import Exam, Run, Scenario
from autograder.exam.slips import Accepts, Compare, in_force_slips, range_slips, warning_slips
from autograder.exam.specification import each, Rule, Specification
from autograder.exam.steps import BURST, feeds, read_parameters, set_parameters, Step
from autograder.exam.words import Causes
from autograder.judging.checks import field_of, own_logs, require_answers
from autograder.judging.claims import answers, declares, hears, node
from autograder.judging.log_rows import require_warnings
from autograder.judging.rows import require_all_sent, rows

LIMIT, PLACE = 'limit_c', 'place'
LOWEST_C, HIGHEST_C = -40.0, 125.0
NO_NUMBERS = (float('nan'), float('inf'), float('-inf'))
JUST_OUTSIDE = (LOWEST_C * (1 + 1e-9), HIGHEST_C * (1 + 1e-9))
ACCEPTED = 'results.0.successful'
"""Field of the ``set_parameters`` response that says whether a change was accepted."""
Change = tuple[str, float | int | str]
"""The name of a parameter and its requested value."""
NODE, SOURCE, TYPE = '/limit_keeper', '/motor_temperature', 'std_msgs/msg/Float64'
SERVICE, DEFAULT_C = f'{NODE}/set_parameters', 30.0
DEFAULTS: Mapping[str, float | str] = {LIMIT: DEFAULT_C, PLACE: 'motor'}
ATOMIC, RESULT = 'set_parameters_atomically', 'result.successful'

WHY = Causes(__file__, LIMIT=LIMIT, PLACE=PLACE, DEFAULT_C=DEFAULT_C)


class Reading(NamedTuple):
    """
    A temperature that the probe sends.

    :param limit: the limit in force [degC]
    :param start: the limit at the start [degC]
    :param tried: the last requested limit, accepted or not [degC]
    :param changes: number of changes requested before this temperature
    """

    value: float
    kind: str
    limit: float
    start: float
    tried: float
    changes: int = 0


def sensible(value: float) -> bool:
    """Return whether a limit is in the valid range."""
    return LOWEST_C <= value <= HIGHEST_C


def kind_of(value: float | str) -> str:
    """Return a description of a limit that makes no sense, which feedback may show."""
    if not isinstance(value, float):
        return 'a value of a different type'
    if not math.isfinite(value):
        return 'NaN' if math.isnan(value) else 'infinity'
    return 'a value that is too low' if value < LOWEST_C else 'a value that is too high'


def deciding(
    accepts: Accepts = sensible,
    other: Callable[[object], bool] = lambda text: True,
    kinds: Sequence[type] = (float,),
) -> Rule:
    """
    Return the rule of a program that accepts or refuses changes; by default, the correct one.

    :param other: returns whether the program accepts a value of another parameter
    :param kinds: types of limits that it accepts
    """

    def decide(change: Change) -> bool:
        name, value = change
        if name != LIMIT:
            return other(value)
        return type(value) in kinds and accepts(float(value))

    return each(lambda change: {ACCEPTED: decide(change)})


def warns(
    above: Compare = operator.gt, limit: Callable[[Reading], float] = lambda one: one.limit
) -> Rule:
    """Return the rule of a program with the given parts, by default the correct ones."""
    return each(lambda one: int(above(one.value, limit(one))))


def readings(start: float, changes: Sequence[Change]) -> Iterator[Reading]:
    """
    Yield temperatures before the first change, two near the limit after each, and a hot burst.

    :param start: limit at the start, with one decimal; its fraction is below 0.5 [degC]
    """
    first = (start - 1.5, start + 1.25, start + 2.5, start + 2.5, start, start + 0.004)
    for value in (*first, -90.0, math.nan, 300.0, math.inf):
        yield Reading(value, 'a temperature', start, start, start)
    limit = tried = start
    for number, (name, wanted) in enumerate(changes, 1):
        if name == LIMIT and isinstance(wanted, float):
            tried = wanted
            limit = wanted if sensible(wanted) else limit
        for near in (limit - 1.0, limit + 1.0):
            yield Reading(near, 'a temperature near the limit', limit, start, tried, number)
    for more in range(BURST):
        high = limit + 1.5 + more
        yield Reading(high, 'a temperature in a burst', limit, start, tried, len(changes))


def in_force(
    asked: Specification, changes: Sequence[Change], accepted: Sequence[bool | None]
) -> Specification:
    """Return the specification of the warnings for the limits that a node has accepted."""
    limits = [asked.inputs[0].start]
    for (name, value), taken in zip(changes, accepted):
        limits.append(float(value) if name == LIMIT and taken else limits[-1])
    inputs = [
        one._replace(limit=limits[min(one.changes, len(limits) - 1)]) for one in asked.inputs
    ]
    return replace(asked, inputs=inputs)


DECISIONS = (
    *range_slips(deciding, LOWEST_C, HIGHEST_C),
    WHY.slip('other_parameter_refused', deciding(other=lambda text: False)),
    WHY.slip('empty_refused', deciding(other=bool)),
    WHY.slip('takes_other_types', deciding(kinds=(int, float))),
    WHY.slip('declared_as_integer', deciding(kinds=(int,))),
)

WARNINGS = (
    WHY.slip('zero_is_none', warns(limit=lambda one: one.limit or DEFAULT_C)),
    *in_force_slips(lambda limit: warns(limit=limit), LIMIT, DEFAULT_C),
    *warning_slips(warns, LIMIT, BURST),
)


def _require_warnings(run: Run, before: bool) -> None:
    accepted = [field_of(one, ACCEPTED) for one in run.recording.answers(SERVICE)]
    asked = in_force(run.asked('warnings'), run.asked('changes').inputs, accepted)
    found = rows(run, 'warnings', own_logs(run, NODE))
    places = [
        place
        for place, one in enumerate(asked.inputs[: len(found)])
        if before is not bool(one.changes)
    ]
    require_warnings(run, asked, found, places, places)
    require_all_sent(run, found[: places[-1] + 1])


def warns_above_the_limit(run: Run) -> None:
    """Each temperature strictly above the limit gives one WARN line, and nothing else does."""
    _require_warnings(run, before=True)


def follows_the_limit(run: Run) -> None:
    """After a change, the new limit is in force; after a refused change, the old limit."""
    _require_warnings(run, before=False)


def gives_a_reason(run: Run) -> None:
    """It gives a reason for each refusal."""
    pairs = zip(run.recording.answers(SERVICE), run.asked('changes').inputs)
    for one, (_, value) in pairs:
        refused = field_of(one, ACCEPTED) is False
        if refused and not str(field_of(one, 'results.0.reason')).strip():
            raise WHY.failed('no_reason', value=kind_of(value))
    both = [{RESULT: False}] * 2
    what = f'a call that sets {PLACE} and a limit that makes no sense'
    require_answers(run, f'{NODE}/{ATOMIC}', both, what, explain=lambda place: WHY['looks_at_one'])


def build(start: float, changes: Sequence[Change]) -> Exam:
    """
    Return the exam for some changes.

    :param start: limit with which the node is started, see :func:`readings` [degC]
    :param changes: the first one sets a valid float
    """
    sent = list(readings(start, changes))
    steps: list[Step] = []
    for number in range(len(changes) + 1):
        steps += [set_parameters(NODE, dict([changes[number - 1]]))] if number else []
        values = [one.value for one in sent if one.changes == number]
        messages = [{'data': one} for one in values]
        steps += feeds(SOURCE, messages, BURST if number == len(changes) else 0)
    both = (PLACE, 'roof'), (LIMIT, HIGHEST_C + 1.0)
    steps += [set_parameters(NODE, dict(order), atomically=True) for order in (both, both[::-1])]
    exam = Exam(
        'limit_keeper',
        title='Limits that make no sense',
        assignment='07_temperature_monitor',
        part=4,
        scenario=Scenario(
            file='limit_keeper.py',
            arguments=('-p', f'{LIMIT}:={start}'),
            feed={SOURCE: TYPE},
            steps=steps,
            again=Scenario(file='limit_keeper.py', steps=read_parameters(NODE, DEFAULTS)),
        ),
        read='Part 5: A threshold that can be changed',
        asks={
            'changes': Specification(tuple(changes), deciding(), DECISIONS),
            'warnings': Specification(sent, warns(), WARNINGS, BURST),
        },
    )
    exam.check(points=1)(node(NODE))
    exam.check(points=1)(hears(SOURCE, TYPE))
    exam.check(points=2, needs=['hears_motor_temperature'])(warns_above_the_limit)
    exam.check(points=1, needs=['starts_its_node'], again=True)(
        declares(
            NODE,
            DEFAULTS,
            'declares_its_parameters',
            'Without arguments, its limit is 30.0, and its place is motor.',
        )
    )
    exam.check(points=2, needs=['starts_its_node'])(
        answers(
            'changes',
            SERVICE,
            'refuses_what_makes_no_sense',
            'It accepts limits that make sense and any place, and refuses everything else.',
        )
    )
    exam.check(points=1, needs=['refuses_what_makes_no_sense'])(gives_a_reason)
    exam.check(points=2, needs=['warns_above_the_limit'])(follows_the_limit)
    return exam


limits = (
    35.0,
    0.0,
    *NO_NUMBERS,
    200.0,
    40,
    LOWEST_C,
    -300.0,
    HIGHEST_C,
    *JUST_OUTSIDE,
    130.0,
    60.5,
)
exam = build(28.4, [*((LIMIT, one) for one in limits), (PLACE, 'pump'), (PLACE, '')])

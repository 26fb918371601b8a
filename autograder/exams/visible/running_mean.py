"""
Lesson 03, part 4: the running mean.

The specification, as the lesson gives it: node ``running_mean`` reads ``std_msgs/msg/Float64`` on
``readings`` and publishes on ``mean``, for each number exactly one message with the mean of all
numbers so far; NaN is ignored, neither counted nor answered.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
import math

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Advance, Feed, Scenario, Step
from autograder.judging.causes.ended import why_silent
from autograder.judging.checks import require_endpoint, require_node, require_partner

NODE = '/running_mean'
SOURCE, TARGET = '/readings', '/mean'
TYPE = 'std_msgs/msg/Float64'
EXERCISE = 'Exercise 3: a running mean'
EVERY_S = 2.5  # from one number to the next: a thread may answer some seconds late [s]


def means_of(numbers: Sequence[float]) -> list[float]:
    """Return the means that are due, one for each number that is not NaN."""
    total = 0.0
    found: list[float] = []
    for number in numbers:
        if not math.isnan(number):
            total += number
            found.append(total / (len(found) + 1))
    return found


def answers(run: Run, numbers: range | None = None) -> list[float]:
    """
    Return the means that came, in order.

    :param numbers: only after these inputs; None for all
    """
    return [
        float(event['data']['data'])
        for event in run.recording.messages(TARGET)
        if 'data' in event and (numbers is None or event['after_input'] in numbers)
    ]


def first_nan(run: Run) -> int:
    """Return the index of the first NaN."""
    numbers: Sequence[float] = (*run.facts['singles'], *run.facts['burst'])
    return next(index for index, number in enumerate(numbers) if math.isnan(number))


def starts_its_node(run: Run) -> None:
    """Your program starts a node called running_mean."""
    require_node(run, NODE)


def reads_and_writes(run: Run) -> None:
    """It subscribes to readings and publishes on mean, both Float64."""
    recording = run.recording
    if recording.endpoints('subscription', TARGET) and recording.endpoints('publisher', SOURCE):
        raise Failed(
            expected=f'a subscription on {SOURCE} and a publisher on {TARGET}',
            observed='the other way round',
            why=Cause(
                'swapped',
                'The two topics have changed places.',
                "Give create_subscription() the name 'readings', create_publisher() 'mean'.",
            ),
        )
    ends = require_endpoint(run, 'subscription', SOURCE, TYPE)
    require_partner(ends)
    require_partner(require_endpoint(run, 'publisher', TARGET, TYPE))
    if recording.of('not_connected') or not recording.of('input'):
        raise Failed(
            expected=f'a subscription on {SOURCE} that receives',
            observed='a subscription that gets nothing',
            why=why_silent(run),
        )


def answers_every_number(run: Run) -> None:
    """For each number it publishes exactly one message."""
    if run.recording.of('message', topic=TARGET, after_input=None):
        raise Failed(
            expected='nothing before the first number', observed='a message', why=_UNASKED
        )
    for index in range(first_nan(run)):
        found = answers(run, range(index, index + 1))
        if len(found) != 1:
            raise Failed(
                expected=f'1 message on {TARGET} after number {index + 1}',
                observed=f'{len(found) or "none"}',
                why=why_silent(run)
                or (_REPEATS if found else _LEAVES_OUT if answers(run) else _SILENT),
            )


_SILENT = Cause(
    'no_answer',
    'Nothing is published when a number arrives.',
    'Publish in the callback of the subscription, for each message.',
)
_LEAVES_OUT = Cause(
    'leaves_out',
    'Some numbers are answered, and this one is not.',
    'Publish for each number that is not NaN, the first one and those below zero included.',
)
_UNASKED = Cause(
    'speaks_unasked',
    'A message is published although no number has come.',
    'Publish in the callback of the subscription, and from nowhere else.',
)
_REPEATS = Cause(
    'several_answers',
    'More than one message is published for one number.',
    'Publish once in the callback, and from nowhere else.',
)


def publishes_the_mean(run: Run) -> None:
    """Each message is the mean of all numbers so far, the newest included."""
    before = first_nan(run)
    found, due = answers(run, range(before)), means_of(run.facts['singles'][:before])
    _compare(run, found, due)


def _compare(run: Run, found: list[float], due: list[float]) -> None:
    for index, mean in enumerate(due):
        if index >= len(found):
            raise Failed(
                expected=f'{len(due)} means', observed=f'only {len(found)}', why=why_silent(run)
            )
        if not _is_close(found[index], mean):
            raise Failed(
                expected=_value(run, mean, index, 'the mean of all numbers so far'),
                observed=_value(run, found[index], index, 'something else'),
                why=_why_value(run, found, index),
            )


def _value(run: Run, value: float, index: int, instead: str) -> str:
    """Show a value, unless it gives away a hidden input."""
    shown = instead if run.secret else f'{value:g}'
    return f'{shown} in answer {index + 1}'


def _why_value(run: Run, found: list[float], index: int) -> Cause | None:
    numbers = [number for number in run.facts['singles'] if not math.isnan(number)]
    shown = found[: index + 1]

    def like(wanted: list[float]) -> bool:
        return all(map(math.isclose, shown, wanted))

    if like(numbers):
        return Cause(
            'passes_on', 'Each number is passed on as it came.', 'Keep a sum and a count.'
        )
    totals = [sum(numbers[: size + 1]) for size in range(len(numbers))]
    if like(totals):
        return Cause('sum', 'That is the sum.', 'Divide by how many numbers there were.')
    if like([0.0, *means_of(numbers)]):
        return Cause('one_behind', 'The newest number is missing in the mean.', 'Add it up first.')
    means = means_of(numbers)
    if any(like([float(cut(mean)) for mean in means]) for cut in (math.floor, math.trunc)):
        advice = 'Divide with /, not with //, and leave out int().'
        return Cause('cut_off', 'The decimals are cut off.', advice)
    if any(like([round(mean, digits) for mean in means]) for digits in range(4)):
        return Cause('rounded', 'The mean is rounded.', 'Publish it as it is, without round().')
    for extra in (1, -1):
        counts = [number + extra for number in range(1, len(totals) + 1)]
        if all(counts) and like([a / b for a, b in zip(totals, counts, strict=True)]):
            return Cause(
                'wrong_count',
                'The sum is divided by one number too ' + ('many.' if extra > 0 else 'few.'),
                'Begin with self.count = 0, and add 1 for each number, before you divide.',
            )
    pairs = [(a + b) / 2 for a, b in pairwise(numbers)]
    if like([numbers[0], *pairs]):
        return Cause('last_two', 'That is the mean of the last two.', 'Keep a sum of all.')
    return None


def ignores_nan(run: Run) -> None:
    """NaN is ignored: nothing is published for it, and later means are right."""
    singles: Sequence[float] = run.facts['singles']
    for index in (i for i, number in enumerate(singles) if math.isnan(number)):
        if answers(run, range(index, index + 1)):
            raise Failed(
                expected='nothing after NaN',
                observed='a message',
                why=Cause(
                    'answers_nan',
                    'NaN is treated as a number.',
                    'Return from the callback before anything else if math.isnan(message.data).',
                ),
            )
    inputs = len(run.recording.of('input'))
    if inputs < len(singles) + len(run.facts['burst']):
        raise Failed(
            expected='a node that goes on after NaN',
            observed='a node that does not',
            why=why_silent(run),
        )
    since = first_nan(run)
    found = answers(run)[len(means_of(singles[:since])) :]
    due = means_of((*singles, *run.facts['burst']))[len(means_of(singles[:since])) :]
    found = _in_order(found, due, len(run.facts['burst']))
    if any(math.isnan(mean) for mean in found):
        raise Failed(
            expected='means that are numbers after NaN',
            observed='means that are NaN',
            why=Cause(
                'sum_spoiled',
                'One NaN in a sum makes the sum NaN for ever.',
                'Return before you add: if math.isnan(message.data).',
            ),
        )
    if len(found) != len(due) or not all(map(_is_close, found, due)):
        raise Failed(
            expected=f'{len(due)} right means after the first NaN',
            observed=f'{len(found)} means, not all of them right'
            if len(found) == len(due)
            else f'{len(found) or "no"} means',
            why=why_silent(run) or _why_not_after_nan(run, found, len(means_of(singles[:since]))),
        )


def _in_order(found: list[float], due: Sequence[float], burst: int) -> list[float]:
    """
    Return means with those of a burst in their order, if all are there.

    Several threads may answer in any order.

    :param burst: how many of those due belong to it
    """
    if not burst or len(found) != len(due):
        return found
    pairs = zip(sorted(found[-burst:]), sorted(due[-burst:]), strict=True)
    return [*found[:-burst], *due[-burst:]] if all(_is_close(*pair) for pair in pairs) else found


def _is_close(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=1e-6, abs_tol=1e-6)


def _why_not_after_nan(run: Run, found: Sequence[float], before: int) -> Cause | None:
    """
    Explain means after NaN that are wrong or missing.

    :param found: those that came after the first NaN
    :param before: how many came before it
    """
    numbers: Sequence[float] = (*run.facts['singles'], *run.facts['burst'])
    if not found:
        return Cause(
            'stops_at_nan',
            'Numbers are answered until NaN comes, and then no more.',
            'Leave the callback when NaN comes, and keep nothing of it.',
        )
    total, counted = 0.0, []
    for place, number in enumerate(numbers, 1):
        if not math.isnan(number):
            total += number
            counted.append(total / place)

    def like(wanted: Sequence[float]) -> bool:
        return bool(found) and all(map(math.isclose, found, wanted[before:]))

    if like(counted):
        return Cause(
            'counts_nan',
            'NaN is not added up, and yet it is counted: the sum is divided by too much.',
            'Return before you count: if math.isnan(message.data).',
        )
    again, no_zeros = _begun_again(numbers), means_of([one for one in numbers if one])[before:]
    if len(found) == len(again) and like([0.0] * before + again):
        return Cause(
            'forgets_at_nan',
            'After NaN the mean begins anew, without the numbers before it.',
            'Leave the sum and the count as they are when NaN comes.',
        )
    if len(found) == len(no_zeros) and like([0.0] * before + no_zeros):
        return Cause(
            'skips_zero',
            'A 0.0 is left out like NaN, and it is a number like any other.',
            'Ask with math.isnan(message.data): a bare if not message.data is true for 0.0, too.',
        )
    right = means_of(numbers)[before:]
    if len(found) > len(right):
        return _REPEATS
    alone = len(right) - len(run.facts['burst'])
    if alone <= len(found) < len(right) and all(map(_is_close, found[:alone], right)):
        return Cause(
            'misses_some',
            'Where several numbers come at once, they do not get an answer each.',
            'Publish in the callback of the subscription, once for each message.',
        )
    return None


def _begun_again(numbers: Sequence[float]) -> list[float]:
    """Return the means after the first NaN of who forgets all numbers at each NaN."""
    parts: list[list[float]] = [[]]
    for number in numbers:
        if math.isnan(number):
            parts.append([])
        else:
            parts[-1].append(number)
    return [mean for part in parts[1:] for mean in means_of(part)]


def build(singles: Sequence[float], burst: Sequence[float] = ()) -> Exam:
    """
    Return the exam for some numbers.

    :param singles: sent one by one; the first three are no NaN, a later one is, the last is not
    :param burst: sent at once at the end, at most five, none of them NaN
    """
    numbers = [{'data': 'nan' if math.isnan(one) else one} for one in (*singles, *burst)]
    steps: list[Step] = [Advance(EVERY_S), Feed(SOURCE, numbers[: len(singles)], every_s=EVERY_S)]
    if burst:
        steps.append(Feed(SOURCE, numbers[len(singles) :], burst=True, every_s=EVERY_S))
    exam = Exam(
        'running_mean',
        title='The running mean',
        assignment='03_topics',
        part=3,
        cells=('running_mean',),
        requires=('running_mean.py',),
        scenario=Scenario(
            file='running_mean.py',
            watch={TARGET: TYPE},
            feed={SOURCE: TYPE},
            steps=tuple(steps),
        ),
        read='Part 4: One topic, one type',
        facts={'singles': tuple(singles), 'burst': tuple(burst)},
    )
    exam.check(points=1, read=EXERCISE)(starts_its_node)
    exam.check(points=2)(reads_and_writes)
    exam.check(points=2, needs=['reads_and_writes'], read='Part 1: Speaking and listening')(
        answers_every_number
    )
    exam.check(points=3, needs=['answers_every_number'], read=EXERCISE)(publishes_the_mean)
    exam.check(points=2, needs=['publishes_the_mean'], read=EXERCISE)(ignores_nan)
    return exam


exam = build([4.0, 8.0, -2.5, 11.0, math.nan, 2.5, 0.0])

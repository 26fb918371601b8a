"""
Lesson 03, part 4: the running mean.

The specification, as the lesson gives it: node ``running_mean`` reads ``std_msgs/msg/Float64`` on
``readings`` and publishes on ``mean``, for each number exactly one message with the mean of all
numbers so far; NaN is ignored, neither counted nor answered.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from itertools import accumulate
import math
from statistics import fmean

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Advance, Feed, Scenario, Step
from autograder.exam.specification import Rule, Slip, Specification
from autograder.judging.causes.ended import why_silent
from autograder.judging.claims import node, passes
from autograder.judging.rows import (
    published,
    require_one_for_one,
    require_values,
    why_other_answer,
)

NODE = '/running_mean'
SOURCE, TARGET = '/readings', '/mean'
TYPE = 'std_msgs/msg/Float64'
EXERCISE = 'Exercise 3: a running mean'
EVERY_S = 2.5  # from one number to the next: a thread may answer some seconds late [s]
PAUSE_S = 60.0  # in which no number comes [s]
Means = tuple[float, ...]
"""What is published for one number: one mean, or none."""


def averaging(
    answer: Callable[[list[float]], float] = fmean,
    counts: Callable[[float], bool] = lambda number: not math.isnan(number),
) -> Rule:
    """
    Return the rule of a program that answers each number that counts by those so far.

    By default, it is the right one.
    """

    def rule(numbers: Sequence[float]) -> list[Means]:
        so_far = accumulate([one] if counts(one) else [] for one in numbers)
        return [(answer(seen),) if counts(one) else () for one, seen in zip(numbers, so_far)]

    return rule


def stops(numbers: Sequence[float]) -> list[Means]:
    """Answer until the first NaN."""
    first = first_nan(numbers)
    return [*averaging()(numbers[:first]), *(() for _ in numbers[first:])]


def starts_over(place: int) -> Rule:
    """Return the rule of a program that begins again at a number."""
    rule = averaging()
    return lambda numbers: [*rule(numbers[:place]), *rule(numbers[place:])]


def changes_only(numbers: Sequence[float]) -> list[Means]:
    """Answer where the mean differs from the last one."""
    found: list[Means] = []
    last: Means = ()
    for mean in averaging()(numbers):
        found.append(() if mean == last else mean)
        last = mean or last
    return found


def skips_equal(numbers: Sequence[float]) -> list[Means]:
    """Take a number that equals the one before for no news."""
    kept = [one for place, one in enumerate(numbers) if one not in numbers[:place][-1:]]
    means = iter(averaging()(kept))
    return [
        () if one in numbers[:place][-1:] else next(means) for place, one in enumerate(numbers)
    ]


def forgets(numbers: Sequence[float]) -> list[Means]:
    """Start again after each NaN."""
    found: list[Means] = []
    seen: list[float] = []
    for number in numbers:
        seen = [] if math.isnan(number) else [*seen, number]
        found.append((fmean(seen),) if seen else ())
    return found


def counts_nan(numbers: Sequence[float]) -> list[Means]:
    """Divide by how many numbers there were, NaN included."""
    totals = accumulate(0.0 if math.isnan(one) else one for one in numbers)
    means = [(total / count,) for count, total in enumerate(totals, 1)]
    return [() if math.isnan(one) else mean for one, mean in zip(numbers, means)]


def spoils(numbers: Sequence[float]) -> list[Means]:
    """Add NaN to the sum, but do not answer it."""
    totals = [(total / count,) for count, total in enumerate(accumulate(numbers), 1)]
    return [() if math.isnan(one) else mean for one, mean in zip(numbers, totals)]


ANSWERS_NAN = Cause(
    'answers_nan',
    'A message comes for NaN, and none is due.',
    'Return from the callback before anything else if math.isnan(message.data).',
)
CUT_OFF = Cause(
    'cut_off', 'The decimals are cut off.', 'Divide with /, not with //, and leave out int().'
)
ROUNDED = Cause('rounded', 'The mean is rounded.', 'Publish it as it is, without round().')
WRONG_COUNT = Cause(
    'wrong_count',
    'The sum is divided by something else than how many numbers there were.',
    'Begin with self.count = 0, and add 1 for each number, before you divide.',
)
STARTS_OVER = Cause(
    'starts_over',
    'After a minute without a number, your node begins a new mean.',
    'Keep the sum and the count as long as the node exists, however late a number comes.',
)
SLIPS = (
    Slip(
        'passes_on',
        'Each number is passed on as it came.',
        'Keep a sum and a count.',
        averaging(lambda seen: seen[-1]),
    ),
    Slip('sum', 'That is the sum.', 'Divide by how many numbers there were.', averaging(sum)),
    Slip(
        'half_and_half',
        'The newest number has as much weight as all before it together.',
        'Keep a sum and a count, and divide: (mean + number) / 2 is right for two numbers only.',
        averaging(lambda seen: reduce(lambda mean, one: (mean + one) / 2, seen)),
    ),
    Slip(
        'one_behind',
        'The newest number is missing in the mean.',
        'Add it up first.',
        averaging(lambda seen: fmean(seen[:-1] or seen)),
    ),
    Slip(
        'one_behind',
        'The newest number is missing in the mean.',
        'Add it up first.',
        averaging(lambda seen: fmean(seen[:-1] or [0.0])),
    ),
    Slip.of(CUT_OFF, averaging(lambda seen: float(math.floor(fmean(seen))))),
    Slip.of(CUT_OFF, averaging(lambda seen: float(math.trunc(fmean(seen))))),
    *(
        Slip.of(ROUNDED, averaging(lambda seen, digits=digits: round(fmean(seen), digits)))  # type: ignore[misc]
        for digits in range(6)
    ),
    Slip.of(WRONG_COUNT, averaging(lambda seen: sum(seen) / (len(seen) + 1))),
    Slip.of(WRONG_COUNT, averaging(lambda seen: sum(seen) / (len(seen) - 1 or 1))),
    Slip.of(WRONG_COUNT, averaging(lambda seen: sum(seen) / (2 * len(seen)))),
    Slip(
        'never_adds',
        'The mean is 0.0 each time: nothing is added up.',
        'Add each number to self.total before you divide.',
        averaging(lambda seen: 0.0),
    ),
    *(
        Slip(
            'last_few',
            'That is the mean of the last numbers only.',
            'Keep a sum of all, and how many there were.',
            averaging(lambda seen, few=few: fmean(seen[-few:])),  # type: ignore[misc]
        )
        for few in (2, 3, 5, 10)
    ),
    Slip(
        'each_once',
        'A number that came before is not counted again.',
        'Keep a sum and a count instead of a set.',
        averaging(lambda seen: fmean(set(seen))),
    ),
    Slip(
        'changes_only',
        'No answer comes where the mean is the same as the one before.',
        'Publish for each number that is not NaN, whatever the mean was before.',
        changes_only,
    ),
    Slip(
        'skips_equal',
        'A number that equals the one before is neither counted nor answered.',
        'Count each number that is not NaN, whatever came before.',
        skips_equal,
    ),
    Slip(
        'stops_at_nan',
        'Numbers are answered until NaN comes, and then no more.',
        'Leave the callback when NaN comes, and keep nothing of it.',
        stops,
    ),
    Slip(
        'counts_nan',
        'NaN is not added up, and yet it is counted: the sum is divided by too much.',
        'Return before you count: if math.isnan(message.data).',
        counts_nan,
    ),
    Slip(
        'forgets_at_nan',
        'After NaN the mean starts again, without the numbers before it.',
        'Leave the sum and the count as they are when NaN comes.',
        forgets,
    ),
    Slip(
        'skips_zero',
        'A 0.0 is left out like NaN, and it is a number like any other.',
        'Ask with math.isnan(message.data): a bare if not message.data is true for 0.0, too.',
        averaging(counts=lambda one: bool(one) and not math.isnan(one)),
    ),
    Slip(
        'sum_spoiled',
        'One NaN in a sum makes the sum NaN for ever.',
        'Return before you add: if math.isnan(message.data).',
        spoils,
    ),
)


def first_nan(numbers: Sequence[float]) -> int:
    """Return the index of the first NaN."""
    return next(index for index, number in enumerate(numbers) if math.isnan(number))


def came(run: Run) -> tuple[Specification, list[Means | None]]:
    """Return what is due in this exam, and the means that came after each number."""
    return run.facts['means'], published(run, 'means', TARGET)


def answers_every_number(run: Run) -> None:
    """For each number it publishes exactly one message."""
    asked, found = came(run)
    require_one_for_one(run, asked, TARGET, found, range(first_nan(asked.inputs)))


def publishes_the_mean(run: Run) -> None:
    """Each message is the mean of all numbers so far, the newest included."""
    asked, found = came(run)
    before = range(first_nan(asked.inputs))
    require_values(run, asked, found, before, 'the mean of all numbers so far')


def ignores_nan(run: Run) -> None:
    """NaN is ignored: nothing is published for it, and later means are right."""
    asked, found = came(run)
    wrong, first = asked.wrong(found), first_nan(asked.inputs)
    if not wrong and found[-1] is not None:
        return
    if any(found[place] for place in wrong if asked.answers[place] == ()):
        raise Failed(expected='nothing after NaN', observed='a message', why=ANSWERS_NAN)
    due = sum(map(len, asked.answers[first:]))
    count = sum(len(one or ()) for one in found[first:])
    how_many = (
        f'{count or "no"} means' if count != due else f'{count} means, not all of them right'
    )
    raise Failed(
        expected=f'{due} right means after the first NaN',
        observed=how_many if found[-1] is not None else 'a node that does not go on',
        why=why_silent(run) or (why_other_answer(asked, found, wrong[0]) if wrong else None),
    )


def build(singles: Sequence[float], burst: Sequence[float] = (), pause: int = 0) -> Exam:
    """
    Return the exam for some numbers.

    :param singles: sent one by one; the first three are no NaN, a later one is, the last is not
    :param burst: sent at once at the end, at most five, none of them NaN
    :param pause: how many numbers come before a long pause, before the first NaN; 0 for none
    """
    numbers = [{'data': 'nan' if math.isnan(one) else one} for one in (*singles, *burst)]
    steps: list[Step] = [Advance(EVERY_S)]
    if pause:
        steps += [Feed(SOURCE, numbers[:pause], every_s=EVERY_S), Advance(PAUSE_S)]
    steps.append(Feed(SOURCE, numbers[pause : len(singles)], every_s=EVERY_S))
    if burst:
        steps.append(Feed(SOURCE, numbers[len(singles) :], burst=True, every_s=EVERY_S))
    slips = (*SLIPS, Slip.of(STARTS_OVER, starts_over(pause))) if pause else SLIPS
    exam = Exam(
        'running_mean',
        title='The running mean',
        assignment='03_topics',
        part=3,
        scenario=Scenario(
            file='running_mean.py',
            watch={TARGET: TYPE},
            feed={SOURCE: TYPE},
            steps=tuple(steps),
        ),
        read='Part 4: One topic, one type',
        asks={'means': Specification((*singles, *burst), averaging(), slips, len(burst))},
    )
    exam.check(points=1, read=EXERCISE)(node(NODE))
    exam.check(points=2)(
        passes(
            (SOURCE, TYPE),
            (TARGET, TYPE),
        )
    )
    exam.check(points=2, needs=['reads_and_writes'], read='Part 1: Speaking and listening')(
        answers_every_number
    )
    exam.check(points=3, needs=['answers_every_number'], read=EXERCISE)(publishes_the_mean)
    exam.check(points=2, needs=['publishes_the_mean'], read=EXERCISE)(ignores_nan)
    return exam


exam = build([4.0, 8.0, -2.5, 11.0, math.nan, 2.5, 0.0])

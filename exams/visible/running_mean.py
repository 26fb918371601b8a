"""
Lesson 03, part 4: the running mean.

Specification from the lesson: node ``running_mean`` subscribes to ``std_msgs/msg/Float64`` on
``readings`` and publishes on ``mean``, for each number exactly one message with the mean of all
numbers so far.  It ignores NaN: no answer, no effect on later means.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import reduce
from itertools import accumulate, pairwise
import math
import operator
from statistics import fmean
import struct

from autograder.exam.exam import Exam, Failed, Run, Scenario
from autograder.exam.slips import Change, changing
from autograder.exam.specification import Rule, Specification
from autograder.exam.steps import Advance, Feed, feeds
from autograder.exam.words import Causes
from autograder.judging.causes.ended import why_silent
from autograder.judging.claims import node, one_for_one, passes, publishes
from autograder.judging.rows import delays, published, why_other_answer

NODE = '/running_mean'
SOURCE, TARGET = '/readings', '/mean'
TYPE = 'std_msgs/msg/Float64'
EXERCISE = 'Exercise 3: a running mean'
EVERY_S = 2.5  # between two numbers: enough for a thread that answers late [s]
PAUSE_S = 60.0  # without a number [s]
Means = tuple[float, ...]
"""The means published for one number: one or none."""

WHY = Causes(__file__)


def averaging(
    answer: Callable[[list[float]], float] = fmean,
    counts: Callable[[float, float], bool] = lambda number, last: not math.isnan(number),
) -> Rule:
    """
    Return the rule of a program that computes each answer from the numbers so far.

    :param answer: computes an answer from these numbers, by default their mean
    :param counts: returns whether a number is used and answered, given the number before it (NaN
        for the first one); by default, every number except NaN
    """

    def rule(numbers: Sequence[float]) -> list[Means]:
        used = list(map(counts, numbers, (math.nan, *numbers)))
        so_far = accumulate([one] if counted else [] for one, counted in zip(numbers, used))
        return [(answer(seen),) if counted else () for counted, seen in zip(used, so_far)]

    return rule


DUE = averaging()


def stops(numbers: Sequence[float]) -> list[Means]:
    """Return the answers of a program that stops at the first NaN."""
    first = first_nan(numbers)
    return [*DUE(numbers[:first]), *(() for _ in numbers[first:])]


def starts_over(numbers: Sequence[float], *places: int) -> list[Means]:
    """Return the answers of a program that starts a new mean at some indices."""
    parts = pairwise((0, *places, len(numbers)))
    return [mean for begin, end in parts for mean in DUE(numbers[begin:end])]


def begins_at_zero(numbers: Sequence[float]) -> list[Means]:
    """Return the answers of a program that starts a new mean after a mean of 0.0."""
    return starts_over(numbers, *(n for n, mean in enumerate(DUE(numbers), 1) if mean == (0.0,)))


def forgets(numbers: Sequence[float]) -> list[Means]:
    """Return the answers of a program that starts a new mean after each NaN."""
    return starts_over(numbers, *(n for n, one in enumerate(numbers) if math.isnan(one)))


def changes_only(numbers: Sequence[float]) -> list[Means]:
    """Return the answers of a program that publishes only means that differ from the last one."""
    found: list[Means] = []
    last: Means = ()
    for mean in DUE(numbers):
        found.append(() if mean == last else mean)
        last = mean or last
    return found


def dividing(add: Callable[[float], float]) -> Rule:
    """Return the rule of a program that counts NaN as a number, and adds ``add(number)``."""
    return lambda numbers: [
        () if math.isnan(one) else (sum(map(add, numbers[:n])) / n,)
        for n, one in enumerate(numbers, 1)
    ]


def of_the_last(few: int) -> Rule:
    """Return the rule of a program that computes the mean of only the last few numbers."""
    return averaging(lambda seen: fmean(seen[-few:]))


def kept(change: Change) -> Rule:
    """Return the rule of a program that changes each mean and computes the next one from it."""
    return averaging(
        lambda seen: reduce(
            lambda mean, one: change((mean * one[0] + one[1]) / (one[0] + 1)), enumerate(seen), 0.0
        )
    )


def adding(store: Change, change: Change) -> Rule:
    """Return the rule of a program that changes each number, and the sum when it stores it."""
    return averaging(
        lambda seen: reduce(lambda sum_, one: store(sum_ + change(one)), seen, 0.0) / len(seen)
    )


def single(number: float) -> float:
    """Return a number rounded to a 32-bit float."""
    return float(struct.unpack('f', struct.pack('f', number))[0])


SLIPS = (
    WHY.slip('zero_is_nothing', begins_at_zero),
    WHY.slip('passes_on', averaging(lambda seen: seen[-1])),
    WHY.slip('sum', averaging(sum)),
    WHY.slip(
        'half_and_half', averaging(lambda seen: reduce(lambda mean, one: (mean + one) / 2, seen))
    ),
    WHY.slip(
        'one_behind',
        averaging(lambda seen: fmean(seen[:-1] or seen)),
        averaging(lambda seen: fmean(seen[:-1] or [0.0])),
    ),
    *changing(
        # A running total may be rounded to another last digit than the exact sum.
        lambda change: averaging(lambda seen: change(fmean(seen))),
        lambda change: averaging(lambda seen: change(reduce(operator.add, seen) / len(seen))),
        kept,
        digits=range(1, 7),
    ),
    WHY.slip(
        'wrong_count',
        averaging(lambda seen: sum(seen) / (len(seen) + 1)),
        averaging(lambda seen: sum(seen) / (len(seen) - 1 or 1)),
        averaging(lambda seen: sum(seen) / (2 * len(seen))),
    ),
    WHY.slip(
        'single_precision',
        *(adding(*both) for both in ((single, float), (float, single), (single, single))),
    ),
    WHY.slip('never_adds', averaging(lambda seen: 0.0)),
    WHY.slip('last_few', *map(of_the_last, (2, 3, 5, 10, 20, 25, 30, 50, 64, 100))),
    WHY.slip('each_once', averaging(lambda seen: fmean(set(seen)))),
    WHY.slip('changes_only', changes_only),
    WHY.slip(
        'skips_equal', averaging(counts=lambda one, last: not math.isnan(one) and one != last)
    ),
    WHY.slip('stops_at_nan', stops),
    WHY.slip('counts_nan', dividing(lambda one: 0.0 if math.isnan(one) else one)),
    WHY.slip('forgets_at_nan', forgets),
    WHY.slip('skips_negative', averaging(counts=lambda one, last: one >= 0.0)),
    WHY.slip('skips_zero', averaging(counts=lambda one, last: bool(one) and not math.isnan(one))),
    WHY.slip('skips_large', averaging(counts=lambda one, last: abs(one) < 1e6)),
    WHY.slip('sum_spoiled', dividing(lambda one: one)),
)

NAN_FIRST = (math.nan, 4.0, 6.0)
FIRST_COUNTS = WHY.slip(
    'first_counts',
    *((lambda numbers, first=first: [(first,), *DUE(numbers)[1:]]) for first in (math.nan, 0.0)),
    lambda numbers: [(math.nan,)] * len(numbers),
    lambda numbers: [(), *[(math.nan,)] * (len(numbers) - 1)],
)


def first_nan(numbers: Sequence[float]) -> int:
    """Return the index of the first NaN."""
    return next(index for index, number in enumerate(numbers) if math.isnan(number))


def ignores_nan(run: Run) -> None:
    """It ignores NaN: it publishes nothing for NaN, and later mean values are correct."""
    asked, found = run.asked('means'), published(run, 'means', TARGET)
    wrong, first = asked.wrong(found), first_nan(asked.inputs)
    if not wrong and found[-1] is not None:
        return
    if any(found[place] for place in wrong if asked.answers[place] == ()):
        raise WHY.failed('answers_nan')
    due = sum(map(len, asked.answers[first:]))
    count = sum(len(one or ()) for one in found[first:])
    how_many = f'mean values: {count or "none"}' + (', not all correct' if count == due else '')
    why = why_silent(run)
    if wrong and not why:
        why = why_other_answer(asked, found, wrong[0], delays(run, 'means', TARGET))
    raise Failed(
        expected=f'{due} correct mean values after the first NaN',
        observed=how_many if found[-1] is not None else 'a node that stops answering',
        why=why,
    )


def build(numbers: Sequence[float], burst: int = 0, pause: int = 0) -> Exam:
    """
    Return the exam for some numbers.

    :param numbers: the first three and the last are not NaN; at least one between them is
    :param burst: number of messages at the end that are sent at once, at most ten, none of them
        NaN
    :param pause: number of messages before a long pause, which precedes the first NaN; 0 for no
        pause
    """
    sent = [{'data': one} for one in numbers]
    begins = [Feed(SOURCE, sent[:pause], every_s=EVERY_S), Advance(PAUSE_S)] if pause else []
    rest = feeds(SOURCE, sent[pause:], burst, every_s=EVERY_S)
    first = [{'data': one} for one in NAN_FIRST]
    once = Scenario(
        file='running_mean.py',
        watch={TARGET: TYPE},
        feed={SOURCE: TYPE},
        steps=(Advance(EVERY_S), Feed(SOURCE, first, every_s=EVERY_S)),
    )
    after_pause = WHY.slip('starts_over', lambda numbers: starts_over(numbers, pause))
    exam = Exam(
        'running_mean',
        title='The running mean',
        assignment='03_topics',
        part=3,
        scenario=replace(once, steps=(Advance(EVERY_S), *begins, *rest), again=once),
        read='Part 4: One topic, one type',
        asks={
            'means': Specification(numbers, DUE, (*SLIPS, after_pause), burst),
            'from nan': Specification(NAN_FIRST, DUE, (FIRST_COUNTS,)),
        },
    )
    before = range(first_nan(numbers))
    exam.check(points=1, read=EXERCISE)(node(NODE))
    exam.check(points=2)(passes((SOURCE, TYPE), (TARGET, TYPE)))
    exam.check(points=2, needs=['reads_and_writes'], read='Part 1: Speaking and listening')(
        one_for_one(
            'means',
            TARGET,
            'answers_every_number',
            'For each number it publishes exactly one message.',
            places=before,
        )
    )
    exam.check(points=3, needs=['answers_every_number'], read=EXERCISE)(
        publishes(
            'means',
            TARGET,
            check='publishes_the_mean',
            sentence='Each message is the mean of all numbers so far, including the newest.',
            places=before,
            what='the mean of all numbers so far',
        )
    )
    exam.check(points=1, needs=['publishes_the_mean'], read=EXERCISE)(ignores_nan)
    exam.check(points=1, needs=['ignores_nan'], read=EXERCISE, again=True)(
        publishes(
            'from nan',
            TARGET,
            check='ignores_nan_at_first',
            sentence='It ignores NaN even if it is the first number.',
        )
    )
    return exam


exam = build([4.0, 8.0, -2.5, 11.0, math.nan, 2.5, 0.0])

"""
Lesson 03, part 4: the running mean.

Specification from the lesson: node ``running_mean`` subscribes to ``std_msgs/msg/Float64`` on
``readings`` and publishes on ``mean``, for each number exactly one message with the mean of all
numbers so far.  It ignores NaN: no answer, no effect on later means.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from itertools import accumulate, pairwise
import math
from statistics import fmean

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Advance, Feed, feeds, Scenario
from autograder.exam.slips import Change, changing, SKIPS_EQUAL
from autograder.exam.specification import Rule, Slip, Specification
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


def averaging(
    answer: Callable[[list[float]], float] = fmean,
    counts: Callable[[float, float], bool] = lambda number, last: not math.isnan(number),
) -> Rule:
    """
    Return the rule of a program that computes each answer from the numbers so far.

    :param answer: computes an answer from these numbers, by default their mean
    :param counts: returns whether a number is used and answered, given the number before it (NaN
        for the first one); by default unless it is NaN
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
    """
    Return the rule of a program that counts NaN as a number.

    :param add: returns the value that the program adds to its sum for a number
    """

    def rule(numbers: Sequence[float]) -> list[Means]:
        totals = enumerate(accumulate(map(add, numbers)), 1)
        return [() if math.isnan(one) else (sum_ / n,) for one, (n, sum_) in zip(numbers, totals)]

    return rule


def kept(change: Change) -> Rule:
    """Return the rule of a program that computes each mean from the last one, changed."""

    def answer(seen: list[float]) -> float:
        return reduce(
            lambda mean, one: change((mean * one[0] + one[1]) / (one[0] + 1)), enumerate(seen), 0.0
        )

    return averaging(answer)


ANSWERS_NAN = Cause(
    'answers_nan',
    'Your node publishes a message for NaN, but should ignore NaN.',
    'Begin the callback with: if math.isnan(message.data): return.',
)
STARTS_OVER = Cause(
    'starts_over',
    'After a minute without a number, your node begins a new mean.',
    'Keep the sum and the count as long as the node exists, however late a number comes.',
)
SLIPS = (
    Slip(
        'passes_on',
        'Your node publishes each number unchanged.',
        'Keep a sum and a count.',
        averaging(lambda seen: seen[-1]),
    ),
    Slip(
        'sum',
        'Your node publishes the sum.',
        'Divide the sum by the count of numbers.',
        averaging(sum),
    ),
    Slip(
        'half_and_half',
        'The newest number has the same weight as all earlier numbers together.',
        'Keep a sum and a count, and divide: (mean + number) / 2 is right for two numbers only.',
        averaging(lambda seen: reduce(lambda mean, one: (mean + one) / 2, seen)),
    ),
    Slip(
        'one_behind',
        'The newest number is missing in the mean.',
        'Add it up first.',
        averaging(lambda seen: fmean(seen[:-1] or seen)),
        averaging(lambda seen: fmean(seen[:-1] or [0.0])),
    ),
    *changing(
        lambda change: averaging(lambda seen: change(fmean(seen))),
        kept,
        digits=range(1, 6),
    ),
    Slip(
        'wrong_count',
        'Your code does not divide the sum by the count of numbers.',
        'Begin with self.count = 0, and add 1 for each number, before you divide.',
        averaging(lambda seen: sum(seen) / (len(seen) + 1)),
        averaging(lambda seen: sum(seen) / (len(seen) - 1 or 1)),
        averaging(lambda seen: sum(seen) / (2 * len(seen))),
    ),
    Slip(
        'never_adds',
        'The mean is 0.0 each time: nothing is added up.',
        'Add each number to self.total before you divide.',
        averaging(lambda seen: 0.0),
    ),
    Slip(
        'last_few',
        'Your node publishes the mean of only the last numbers.',
        'Keep the sum and the count of all numbers.',
        *(averaging(lambda seen, few=few: fmean(seen[-few:])) for few in (2, 3, 5, 10, 20, 50)),
    ),
    Slip(
        'each_once',
        'Your code counts a repeated number only once.',
        'Keep a sum and a count instead of a set.',
        averaging(lambda seen: fmean(set(seen))),
    ),
    Slip(
        'changes_only',
        'Your node publishes nothing if the mean has not changed.',
        'Publish for each number that is not NaN, whatever the mean was before.',
        changes_only,
    ),
    Slip.of(SKIPS_EQUAL, averaging(counts=lambda one, last: not math.isnan(one) and one != last)),
    Slip(
        'stops_at_nan',
        'Your node stops answering after the first NaN.',
        'Return from the callback if the number is NaN, and store nothing.',
        stops,
    ),
    Slip(
        'counts_nan',
        'Your code does not add NaN but counts it, so it divides by too large a count.',
        'Before you count, write: if math.isnan(message.data): return',
        dividing(lambda one: 0.0 if math.isnan(one) else one),
    ),
    Slip(
        'forgets_at_nan',
        'After NaN the mean starts again, without the numbers before it.',
        'Leave the sum and the count as they are when NaN comes.',
        forgets,
    ),
    Slip(
        'skips_zero',
        'Your node ignores 0.0 like NaN, but 0.0 is an ordinary number.',
        'Test with math.isnan(message.data): if not message.data is also true for 0.0.',
        averaging(counts=lambda one, last: bool(one) and not math.isnan(one)),
    ),
    Slip(
        'sum_spoiled',
        'After one NaN, the sum is NaN forever.',
        'Return before you add: if math.isnan(message.data).',
        dividing(lambda one: one),
    ),
)


def first_nan(numbers: Sequence[float]) -> int:
    """Return the index of the first NaN."""
    return next(index for index, number in enumerate(numbers) if math.isnan(number))


def ignores_nan(run: Run) -> None:
    """NaN is ignored: nothing is published for it, and later means are right."""
    asked, found = run.asked('means'), published(run, 'means', TARGET)
    wrong, first = asked.wrong(found), first_nan(asked.inputs)
    if not wrong and found[-1] is not None:
        return
    if any(found[place] for place in wrong if asked.answers[place] == ()):
        raise Failed(expected='nothing after NaN', observed='a message', why=ANSWERS_NAN)
    due = sum(map(len, asked.answers[first:]))
    count = sum(len(one or ()) for one in found[first:])
    how_many = f'{count or "no"} means' + (', not all of them right' if count == due else '')
    why = why_silent(run)
    if wrong and not why:
        why = why_other_answer(asked, found, wrong[0], delays(run, 'means', TARGET))
    raise Failed(
        expected=f'{due} right means after the first NaN',
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
    after_pause = Slip.of(STARTS_OVER, lambda numbers: starts_over(numbers, pause))
    slips = (*SLIPS, after_pause) if pause else SLIPS
    exam = Exam(
        'running_mean',
        title='The running mean',
        assignment='03_topics',
        part=3,
        scenario=Scenario(
            file='running_mean.py',
            watch={TARGET: TYPE},
            feed={SOURCE: TYPE},
            steps=(Advance(EVERY_S), *begins, *rest),
        ),
        read='Part 4: One topic, one type',
        asks={'means': Specification(numbers, DUE, slips, burst)},
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
            sentence='Each message is the mean of all numbers so far, the newest included.',
            places=before,
            what='the mean of all numbers so far',
        )
    )
    exam.check(points=2, needs=['publishes_the_mean'], read=EXERCISE)(ignores_nan)
    return exam


exam = build([4.0, 8.0, -2.5, 11.0, math.nan, 2.5, 0.0])

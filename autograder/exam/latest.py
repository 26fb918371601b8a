"""
Specify a node that combines the latest values of several topics, and its typical slips.

A timer publishes the latest value of each topic: nothing until every topic has had a message, and
a stop message while one of the values is too old.  The rules here return what the node publishes
after each input.  Repetitions of a message are merged, because their number depends on when the
node created its timer.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from functools import partial
from itertools import groupby
import math
from typing import Any, NamedTuple

from autograder.exam.ranges import within
from autograder.exam.slips import Change, changing
from autograder.exam.specification import Cause, Rule, Slip

TICK_S = 0.1
"""Time step at which a rule evaluates the timer after an input [s]."""
BEGINS_EARLY = Cause(
    'begins_early',
    'A message is published although not all of the inputs have come.',
    'Begin with None in each attribute, and return from the callback of the timer while one of '
    'them is None.',
)


class Told(NamedTuple):
    """
    One input.

    :param topic: index of its topic, from 0
    :param lasts_s: time to the next input [s]
    """

    topic: int
    value: float
    lasts_s: float


Heard = Sequence[Sequence[float]]
"""The values received so far on each topic, in order of arrival."""


def latest(heard: Heard) -> tuple[float, ...]:
    """Return the latest value of each topic, 0.0 for a topic without a message."""
    return tuple(one[-1] if one else 0.0 for one in heard)


def joining(
    topics: int,
    old: Callable[[Sequence[float]], bool],
    ready: Callable[[Heard], bool] = all,
    value: Callable[[Heard], tuple[float, ...]] = latest,
    stop: Callable[[Sequence[float], Sequence[float]], Any] = lambda now, ages: (0.0,) * len(now),
    for_good: bool = False,
    timer: bool = True,
    same_is_old: Collection[int] = (),
    keeps: Callable[[list[float]], list[float]] = list,
) -> Rule:
    """
    Return the rule of a node that combines topics; with the default values, the correct one.

    :param old: returns whether to stop, given the ages of the latest values [s]
    :param ready: returns whether to publish, given the values received so far
    :param value: returns the message to publish, given the values received so far
    :param stop: returns the message that replaces it, given the latest values and their ages [s];
        None publishes nothing
    :param for_good: whether the node stays stopped after its first stop
    :param timer: whether the node publishes from a timer; otherwise it publishes once per input
    :param same_is_old: the topics on which a value that equals the one before does not renew the
        age
    :param keeps: returns what remains of the values of each topic when the node stops
    """

    def rule(inputs: Sequence[Told]) -> list[tuple[Any, ...]]:
        heard: list[list[float]] = [[] for _ in range(topics)]
        came_s, now_s, stopped = [0.0] * topics, 0.0, False
        found = []
        for topic, number, lasts_s in inputs:
            if topic not in same_is_old or heard[topic][-1:] != [number]:
                came_s[topic] = now_s
            heard[topic].append(number)
            row = []
            for tick in range(round(lasts_s / TICK_S) if timer else 1):
                ages = [now_s + (tick + 0.5) * TICK_S - one for one in came_s]
                if ready(heard):
                    stopped = old(ages) or (for_good and stopped)
                    row.append(stop(latest(heard), ages) if stopped else value(heard))
                if stopped:
                    heard = [keeps(one) for one in heard]
                    stopped = all(heard)
            now_s += lasts_s
            found.append(tuple(one for one, _ in groupby(row) if one is not None))
        return found

    return rule


def queueing(topics: int, old_s: float, period_s: float, begins_s: float) -> Rule:
    """
    Return the rule of a node that keeps values in queues, and takes one of each per tick.

    :param begins_s: time from the first input to the next tick [s]
    """

    def rule(inputs: Sequence[Told]) -> list[tuple[Any, ...]]:
        waiting: list[list[float]] = [[] for _ in range(topics)]
        came_s, now_s, ticks, found = [0.0] * topics, 0.0, 0, []
        for topic, number, lasts_s in inputs:
            waiting[topic].append(number)
            came_s[topic] = now_s
            now_s += lasts_s
            row = []
            while (tick_s := begins_s + ticks * period_s) < now_s:
                ticks += 1
                if all(waiting):
                    taken = tuple(one.pop(0) if len(one) > 1 else one[0] for one in waiting)
                    fresh = tick_s - min(came_s) <= old_s
                    row.append(taken if fresh else (0.0,) * topics)
            found.append(tuple(one for one, _ in groupby(row)))
        return found

    return rule


def joining_slips(topics: int, old_s: float, period_s: float) -> tuple[Slip, ...]:
    """
    Return the slips of a node that combines topics.

    :param old_s: age above which a value is too old [s]
    :param period_s: period of the timer [s]
    """

    def oldest(ages: Sequence[float]) -> bool:
        return max(ages) > old_s

    def rule(**changed: Any) -> Rule:
        return joining(topics, **{'old': oldest, **changed})

    def half(now: Sequence[float], ages: Sequence[float]) -> tuple[float, ...]:
        return tuple(0.0 if age > old_s else one for one, age in zip(now, ages))

    def changed(change: Change, *which: int) -> Rule:
        def value(heard: Heard) -> tuple[float, ...]:
            return tuple(
                change(one) if place in which else one for place, one in enumerate(latest(heard))
            )

        return rule(value=value)

    def only(which: int) -> Rule:
        return rule(
            stop=lambda now, ages: tuple(
                0.0 if place == which else one for place, one in enumerate(now)
            )
        )

    all_topics = range(topics)
    moments = [(place + 0.5) / 100 for place in range(round(100 * period_s))]
    own_times = 'Keep the time of the latest message of each topic, and compare each age'
    return (
        Slip.of(BEGINS_EARLY, rule(ready=any)),
        Slip(
            'never_old',
            'An old value is used like a new one.',
            f'{own_times} with {old_s:g} s when the timer ticks.',
            rule(old=lambda ages: False),
        ),
        Slip(
            'one_age_for_all',
            'A new value on one topic hides that the value of another one is old.',
            f'{own_times} with {old_s:g} s.',
            rule(old=lambda ages: min(ages) > old_s),
        ),
        Slip(
            'one_age_only',
            'The age of one topic counts, and the age of another one does not.',
            f'{own_times} with {old_s:g} s.',
            *(rule(old=lambda ages, which=which: ages[which] > old_s) for which in all_topics),
        ),
        Slip(
            'half_a_stop',
            'If a value is old, one field becomes 0.0, and the other still has its value.',
            'If one value is old, publish 0.0 in all fields: an empty message.',
            rule(stop=half),
            *map(only, all_topics),
        ),
        Slip(
            'forgets_values',
            'After a stop, your node waits until all inputs have come again.',
            'Keep the values when one of them is old: the timer publishes 0.0 until it is fresh.',
            rule(keeps=lambda values: []),
        ),
        Slip(
            'stop_overwrites',
            'A stop overwrites the kept values: a value that is still fresh is lost.',
            'Keep the values, and publish 0.0 in their place: set the fields of the message only.',
            rule(keeps=lambda values: [0.0]),
            act='reset',
        ),
        Slip(
            'silent_when_old',
            'Nothing is published while a value is old.',
            'If one value is old, publish a message with 0.0 in all fields.',
            rule(stop=lambda now, ages: None),
        ),
        Slip(
            'stops_for_good',
            'After the first stop, fresh values are not used any more.',
            'Decide by the ages each time the timer ticks, without a flag that stays set.',
            rule(for_good=True),
        ),
        Slip(
            'other_age',
            f'A value counts as old at a greater age than {old_s:g} s.',
            f'Compare each age with {old_s:g} s: one second has 1_000_000_000 nanoseconds.',
            rule(old=lambda ages: max(ages) > 2 * old_s),
        ),
        Slip(
            'whole_seconds',
            f'The age is cut to whole seconds: a value counts as old from {old_s + 1:g} s on.',
            f'Compare each age with {old_s:g} s unchanged, without // and int().',
            rule(old=lambda ages: math.floor(max(ages)) > old_s),
        ),
        Slip(
            'same_is_old',
            'A message with the same value as the one before does not count as a new one.',
            'Store the time of each message, whatever its value.',
            rule(same_is_old=all_topics),
            *(rule(same_is_old=[which]) for which in all_topics),
        ),
        Slip(
            'swapped',
            'The values have changed places.',
            'Which topic belongs to which field? Look at the table of the exercise.',
            rule(value=lambda heard: latest(heard)[::-1]),
        ),
        Slip(
            'first_value',
            'The first values are kept, and later ones are ignored.',
            'Store the value of each message, whatever was there before.',
            rule(value=lambda heard: tuple(one[0] if one else 0.0 for one in heard)),
        ),
        Slip(
            'zero_is_nothing',
            'A value of 0.0 is taken for one that has not come.',
            'Compare with None: if self.NAME is None.',
            rule(ready=lambda heard: all(one and one[-1] for one in heard)),
            *(
                rule(ready=lambda heard, which=which: all(heard) and bool(heard[which][-1]))
                for which in all_topics
            ),
        ),
        Slip(
            'limited',
            'Your node limits a value, but should publish each value unchanged.',
            'Store and publish message.data as it is, without min() and max().',
            *(
                changed(partial(within, most=1.0), *some)
                for some in (all_topics, *zip(all_topics))
            ),
            act='min() max() clip()',
        ),
        Slip(
            'answers_inputs',
            'A message is published when an input comes, and not by a timer.',
            'Only store values in the callbacks of the subscriptions. Publish in the callback of '
            'the timer.',
            rule(timer=False),
        ),
        Slip(
            'oldest_first',
            'The first message after a new value still has the value before it.',
            'Keep only the latest value of each topic, in an attribute, and no queue.',
            *(queueing(topics, old_s, period_s, begins_s) for begins_s in moments),
        ),
        *changing(
            lambda change: changed(change, *all_topics),
            *(lambda change, which=which: changed(change, which) for which in all_topics),
        ),
    )

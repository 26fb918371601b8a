"""
Lesson 02, part 5: the latest values of two topics, published by a timer.

Specification from the lesson: node ``pilot`` subscribes to ``std_msgs/msg/Float64`` on ``speed``
and ``turn``, and publishes ``geometry_msgs/msg/Twist`` on ``cmd_vel``: nothing until messages
have arrived on both; then, every 0.5 s, the latest speed as ``linear.x`` and the latest turn as
``angular.z``; zeros in both while the latest speed or the latest turn is older than 2 s.

The rules return the commands after each input.  Repetitions of a command are merged, because their
number depends on when the node created its timer.
"""

from collections.abc import Callable, Collection, Iterable, Sequence
from functools import partial
from itertools import groupby
import math
from typing import Any, NamedTuple

from autograder.exam.exam import Advance, Exam, Feed, Run, Scenario
from autograder.exam.slips import Change, changing, within
from autograder.exam.specification import Rule, Specification
from autograder.exam.words import Causes
from autograder.judging.checks import require_messages
from autograder.judging.claims import hears, node, offers
from autograder.judging.rhythm import require_period, seconds_between
from autograder.judging.rows import published, require_all_sent, require_values

FLOAT, TWIST = 'std_msgs/msg/Float64', 'geometry_msgs/msg/Twist'
SOURCES, TARGET = ('/speed', '/turn'), '/cmd_vel'
PERIOD_S, OLD_S = 0.5, 2.0
STOP = (0.0, 0.0)
BOTH = range(len(SOURCES))
FIELDS = 'linear.x', 'angular.z'
TICK_S = 0.1  # interval at which a rule evaluates the timer after an input [s]
QUIET_S = 0.9  # at the start, without an input [s]
# No two inputs are a multiple of the period apart.  So a timer created when an input arrives never
# ticks exactly when another one arrives.  ``FIRST_S`` is the age of the first value
# when the other topic begins.
SHORT_S, MIDDLE_S, FIRST_S, LONG_S = 0.91, 1.66, 3.02, 4.34
REPLACED_S = 0.03  # from a value to a new one on the same topic; few timers tick between [s]
Heard = Sequence[Sequence[float]]
"""The values received so far on each topic, in order of arrival."""

WHY = Causes(__file__, OLD_S=OLD_S)


class PilotInput(NamedTuple):
    """One input: the index of its topic, from 0, and the time to the next input [s]."""

    topic: int
    value: float
    lasts_s: float


def latest(heard: Heard) -> tuple[float, ...]:
    """Return the latest value of each topic, 0.0 for a topic without a message."""
    return tuple(one[-1] if one else 0.0 for one in heard)


def merged(row: Iterable[Any], lasts_s: float) -> tuple[Any, ...]:
    """Return commands without repetitions, and none after a value that is soon replaced."""
    found = (one for one, _ in groupby(row) if one is not None)
    return tuple(found) if lasts_s > REPLACED_S else ()


def joining(
    old: Callable[[Sequence[float]], bool] = lambda ages: max(ages) > OLD_S,
    ready: Callable[[Heard], bool] = all,
    value: Callable[[Heard], tuple[float, ...]] = latest,
    stop: Callable[[Sequence[float], Sequence[float]], Any] = lambda now, ages: STOP,
    for_good: bool = False,
    timer: bool = True,
    same_is_old: Collection[int] = (),
    keeps: Callable[[list[float]], list[float]] = list,
    clock: Callable[[float], float] = float,
) -> Rule:
    """
    Return the rule of a node that combines topics; with the default values, the correct one.

    :param old: returns whether to stop, given the ages of the latest values [s]
    :param ready: returns whether to publish, given the values received so far
    :param value: returns the command to publish, given the values received so far
    :param stop: returns the command to publish during a stop, given the latest values and their
        ages [s]; None publishes nothing
    :param for_good: whether the node stays stopped after its first stop
    :param timer: whether the node publishes from a timer; otherwise it publishes once per input
    :param same_is_old: the topics on which a repeated value does not reset the age
    :param keeps: returns the values of a topic that remain when the node stops
    :param clock: returns the time that the node reads, given the time since the first input [s]
    """

    def rule(inputs: Sequence[PilotInput]) -> list[tuple[Any, ...]]:
        heard: list[list[float]] = [[] for _ in BOTH]
        came_s, now_s, stopped = [0.0, 0.0], 0.0, False
        found = []
        for topic, number, lasts_s in inputs:
            if topic not in same_is_old or heard[topic][-1:] != [number]:
                came_s[topic] = now_s
            heard[topic].append(number)
            row = []
            for tick in range(round(lasts_s / TICK_S) if timer else 1):
                at_s = clock(now_s + (tick + 0.5) * TICK_S)
                ages = [at_s - clock(one) for one in came_s]
                if ready(heard):
                    stopped = old(ages) or (for_good and stopped)
                    row.append(stop(latest(heard), ages) if stopped else value(heard))
                if stopped:
                    heard = [keeps(one) for one in heard]
                    stopped = all(heard)
            now_s += lasts_s
            found.append(merged(row, lasts_s))
        return found

    return rule


def queueing(begins_s: float, skips: int) -> Rule:
    """
    Return the rule of a node that keeps values in queues, and drops one from each queue per tick.

    :param begins_s: time from the first input to the next tick [s]
    :param skips: how many values the node drops before it publishes, 0 or 1
    """

    def rule(inputs: Sequence[PilotInput]) -> list[tuple[Any, ...]]:
        waiting: list[list[float]] = [[] for _ in BOTH]
        came_s, now_s, ticks, found = [0.0, 0.0], 0.0, 0, []
        for topic, number, lasts_s in inputs:
            waiting[topic].append(number)
            came_s[topic] = now_s
            now_s += lasts_s
            row = []
            while (tick_s := begins_s + ticks * PERIOD_S) < now_s:
                ticks += 1
                if all(waiting):
                    taken = tuple(one[:2][-skips] for one in waiting)
                    waiting = [one[1:] or one for one in waiting]
                    fresh = tick_s - min(came_s) <= OLD_S
                    row.append(taken if fresh else STOP)
            found.append(merged(row, lasts_s))
        return found

    return rule


def changed(change: Change, *which: int) -> Rule:
    """Return the rule of a node that changes the values of some topics."""
    return joining(
        value=lambda heard: tuple(
            change(one) if place in which else one for place, one in enumerate(latest(heard))
        )
    )


def _silent_at_first(inputs: Sequence[PilotInput]) -> list[tuple[Any, ...]]:
    """Return the commands of a node that begins when no value is old."""
    due = joining()(inputs)
    begins = next(place for place, row in enumerate(due) if {*row} - {STOP})
    return [*[()] * begins, *due[begins:]]


def _whole_seconds(begins_s: float, time_s: float) -> float:
    """Return the whole seconds of a clock that shows ``begins_s`` at the first input [s]."""
    return math.floor(time_s + begins_s)


_MOMENTS_S = [(place + 0.5) / 100 for place in range(round(100 * PERIOD_S))]
SLIPS = (
    WHY.slip('begins_early', joining(ready=any)),
    WHY.slip('never_old', joining(old=lambda ages: False)),
    WHY.slip('one_age_for_all', joining(old=lambda ages: min(ages) > OLD_S)),
    WHY.slip(
        'one_age_only',
        joining(old=lambda ages: ages[0] > OLD_S),
        joining(old=lambda ages: ages[1] > OLD_S),
    ),
    WHY.slip(
        'half_a_stop',
        joining(
            stop=lambda now, ages: tuple(
                0.0 if age > OLD_S else one for one, age in zip(now, ages)
            )
        ),
        joining(stop=lambda now, ages: (0.0, now[1])),
        joining(stop=lambda now, ages: (now[0], 0.0)),
    ),
    WHY.slip('forgets_values', joining(keeps=lambda values: [])),
    WHY.slip('stop_overwrites', joining(keeps=lambda values: [0.0])),
    WHY.slip('silent_when_old', joining(stop=lambda now, ages: None)),
    WHY.slip('silent_at_first', _silent_at_first),
    WHY.slip('stops_for_good', joining(for_good=True)),
    WHY.slip('other_age', joining(old=lambda ages: max(ages) > 2 * OLD_S)),
    WHY.slip(
        'whole_seconds',
        joining(old=lambda ages: math.floor(max(ages)) > OLD_S),
        # If a clock starts at a different fraction of a second, each stop is only shorter.
        *(joining(clock=partial(_whole_seconds, one)) for one in (0.45, 0.55, 0.65, 0.75)),
    ),
    WHY.slip(
        'same_is_old', joining(same_is_old=BOTH), *(joining(same_is_old=[which]) for which in BOTH)
    ),
    *(
        WHY.slip('field_missing', changed(lambda value: 0.0, which), field=field)
        for which, field in enumerate(FIELDS)
    ),
    WHY.slip('swapped', joining(value=lambda heard: latest(heard)[::-1])),
    WHY.slip(
        'first_value', joining(value=lambda heard: tuple(one[0] if one else 0.0 for one in heard))
    ),
    WHY.slip(
        'zero_is_nothing',
        joining(ready=lambda heard: all(one and one[-1] for one in heard)),
        joining(ready=lambda heard: all(heard) and bool(heard[0][-1])),
        joining(ready=lambda heard: all(heard) and bool(heard[1][-1])),
    ),
    WHY.slip(
        'limited', *(changed(partial(within, most=1.0), *some) for some in (BOTH, *zip(BOTH)))
    ),
    WHY.slip('answers_inputs', joining(timer=False)),
    WHY.slip('oldest_first', *(queueing(one, skips) for skips in (0, 1) for one in _MOMENTS_S)),
    *changing(
        lambda change: changed(change, *BOTH),
        *(lambda change, which=which: changed(change, which) for which in BOTH),
    ),
)


def commands(run: Run) -> tuple[Specification, list[tuple[Any, ...] | None]]:
    """Return the specification and the commands after each input, with repetitions merged."""
    found = published(run, 'commands', TARGET, *FIELDS)
    asked = run.asked('commands')
    return asked, [
        row if row is None else merged(row, one.lasts_s) for one, row in zip(asked.inputs, found)
    ]


def first_complete(asked: Specification) -> int:
    """Return the index of the first input, above 0, after which both topics have had a message."""
    return next(place for place, due in enumerate(asked.answers) if due)


def waits_for_both(run: Run) -> None:
    """It publishes nothing until a speed and a turn have arrived."""
    asked, _ = commands(run)
    what = 'a command once a speed and a turn have arrived'
    first = require_messages(run, what=what, topic=TARGET)[0]['after_input']
    if first is None or first < first_complete(asked):
        raise WHY.failed('begins_early')


def keeps_its_rhythm(run: Run) -> None:
    """Once both have arrived, it publishes a command every 0.5 s."""
    asked, came = commands(run)
    begins = first_complete(asked)
    messages = run.recording.messages(TARGET)
    found = [one for one in messages if (one['after_input'] or 0) >= begins]
    during_s = sum(one.lasts_s for one in asked.inputs[begins:])
    waited_s = seconds_between(run.recording.of('input')[begins:], found)
    require_period(
        run, found, PERIOD_S, during_s, 'command', lambda: asked.cause(came), waited_s=waited_s
    )


def _require_commands(run: Run, stops: bool) -> None:
    asked, found = commands(run)
    places = [place for place, row in enumerate(asked.answers) if row and stops == (STOP in row)]
    for place in asked.wrong(found, () if stops else places)[:1]:
        moves = any(set(row or ()) - {STOP} for row in found)
        stops_early = moves and STOP in (found[place] or ())
        if stops_early and not asked.cause(found, place, places):
            raise WHY.failed('stops_early', place=place, number=place + 1)
    require_values(run, asked, found, places)
    require_all_sent(run, found)


def uses_the_latest(run: Run) -> None:
    """Each command has the latest speed in linear.x and the latest turn in angular.z."""
    _require_commands(run, stops=False)


def stops_when_one_is_old(run: Run) -> None:
    """While the latest speed or the latest turn is older than 2 s, both fields are 0.0."""
    _require_commands(run, stops=True)


def build(inputs: Sequence[PilotInput]) -> Exam:
    """
    Return the exam for some inputs.

    :param inputs: speeds (topic 0) and turns (topic 1).  The expected command must not change
        twice within one period, so that at least one command arrives in between, whenever the
        timer was created
    """
    feeds = [
        Feed(SOURCES[one.topic], [{'data': one.value}], every_s=one.lasts_s, rest_s=0.0)
        for one in inputs
    ]
    exam = Exam(
        'pilot',
        title='The latest of two',
        assignment='02_spinning',
        part=2,
        scenario=Scenario(
            file='pilot.py',
            watch={TARGET: TWIST},
            feed=dict.fromkeys(SOURCES, FLOAT),
            steps=(Advance(QUIET_S), *feeds),
        ),
        read='Exercise 2: the latest of two',
        asks={'commands': Specification(inputs, joining(), SLIPS)},
    )
    exam.check(points=1)(node('/pilot'))
    for source in SOURCES:
        exam.check(points=1)(hears(source, FLOAT))
    exam.check(points=1)(offers(TARGET, TWIST))
    needs = ['hears_speed', 'hears_turn', 'offers_cmd_vel']
    exam.check(points=2, needs=needs)(waits_for_both)
    exam.check(points=2, needs=needs, read='Part 2: Timers and clocks')(keeps_its_rhythm)
    exam.check(points=2, needs=['keeps_its_rhythm'])(uses_the_latest)
    exam.check(points=2, needs=['keeps_its_rhythm'])(stops_when_one_is_old)
    return exam


def journey(values: Sequence[float], first: int = 1) -> list[PilotInput]:
    """
    Return inputs in which the messages of each topic begin, pause, resume and repeat a value.

    :param values: fifteen different numbers other than 0.0; the third and fourth are beyond ±1.0
    :param first: topic of the first message, which is old when the other topic begins
    """
    one, two = 1 - first, first
    topics = [two, one, two, one, one, two, two, one, two, one, one, two, one, two, two, two, two]
    topics += [one, *[two, one] * 3]
    # Each topic has a 0.0, a value that is soon replaced, and at the end a value three times.
    numbers = [-values[1], *values[:2], -values[2], values[2], -values[3], values[3], 0.0]
    numbers += [*values[4:7], 0.0, *values[7:13], *list(values[13:]) * 3]
    lasts = {0: FIRST_S, 8: LONG_S, 13: MIDDLE_S, 15: MIDDLE_S}
    lasts |= {2: SHORT_S - REPLACED_S, 3: REPLACED_S, 4: SHORT_S - REPLACED_S, 5: REPLACED_S}
    return [
        PilotInput(topic, number, lasts.get(place, SHORT_S))
        for place, (topic, number) in enumerate(zip(topics, numbers, strict=True))
    ]


_values = (0.5, 0.2, 1.2, -1.5, 0.4, 0.6, -0.7, 0.1, 1.0, -0.2, 0.25, 0.9, 0.35, 0.7, 0.3)
exam = build(journey(_values))

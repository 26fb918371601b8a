"""
Lesson 02, part 5: the latest values of two topics, published by a timer.

Specification from the lesson: node ``pilot`` subscribes to ``std_msgs/msg/Float64`` on ``speed``
and ``turn``, and publishes ``geometry_msgs/msg/Twist`` on ``cmd_vel``: nothing until both topics
have had a message; then, every 0.5 s, the latest speed as ``linear.x`` and the latest turn as
``angular.z``; zeros in both while the latest speed or the latest turn is older than 2 s.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Any

from autograder.exam.exam import Exam, Failed, Run
from autograder.exam.latest import BEGINS_EARLY, joining, joining_slips, Told
from autograder.exam.scenario import Advance, Feed, Scenario
from autograder.exam.specification import Specification
from autograder.judging.checks import require_messages
from autograder.judging.claims import hears, node, offers
from autograder.judging.rhythm import require_period, seconds_between
from autograder.judging.rows import published, require_all_sent, require_values

FLOAT, TWIST = 'std_msgs/msg/Float64', 'geometry_msgs/msg/Twist'
SOURCES, TARGET = ('/speed', '/turn'), '/cmd_vel'
PERIOD_S, OLD_S = 0.5, 2.0
STOP = (0.0, 0.0)
QUIET_S = 0.9  # at the start, without an input [s]
# No interval between two inputs is a multiple of the period.  So a timer created when an input
# arrives never ticks exactly when another one arrives.
SHORT_S, MIDDLE_S, LONG_S = 0.91, 1.66, 4.34

right = joining(len(SOURCES), old=lambda ages: max(ages) > OLD_S)


def commands(run: Run) -> tuple[Specification, list[tuple[Any, ...] | None]]:
    """Return the specification and the commands after each input, with repetitions merged."""
    found = published(run, 'commands', TARGET, 'linear.x', 'angular.z')
    return run.facts['commands'], [
        row if row is None else tuple(one for one, _ in groupby(row)) for row in found
    ]


def first_complete(asked: Specification) -> int:
    """Return the index of the first input after which both topics have had a message."""
    return next(place for place, due in enumerate(asked.answers) if due)


def waits_for_both(run: Run) -> None:
    """It publishes nothing until a speed and a turn have come."""
    asked, _ = commands(run)
    first = require_messages(run, topic=TARGET)[0]['after_input']
    if first is None or first < first_complete(asked):
        raise Failed(
            expected='no command before a speed and a turn have come',
            observed='a command before that',
            why=BEGINS_EARLY,
        )


def keeps_its_rhythm(run: Run) -> None:
    """Once both have come, a command comes every 0.5 s."""
    asked, came = commands(run)
    begins = first_complete(asked)
    found = [
        one
        for one in run.recording.messages(TARGET)
        if one['after_input'] is not None and one['after_input'] >= begins
    ]
    during_s = sum(one.lasts_s for one in asked.inputs[begins:])
    causes = (asked.cause(came, place) for place in asked.wrong(came))
    waited_s = seconds_between(run.recording.of('input')[begins:], found)
    require_period(
        run, found, PERIOD_S, during_s, 'command', lambda: next(causes, None), waited_s=waited_s
    )


def _require_commands(run: Run, stops: bool) -> None:
    asked, found = commands(run)
    due = enumerate(asked.answers)
    require_values(
        run, asked, found, [place for place, row in due if row and stops == (STOP in row)]
    )
    require_all_sent(run, found)


def uses_the_latest(run: Run) -> None:
    """Each command has the latest speed in linear.x and the latest turn in angular.z."""
    _require_commands(run, stops=False)


def stops_when_one_is_old(run: Run) -> None:
    """While the latest speed or the latest turn is older than 2 s, both fields are 0.0."""
    _require_commands(run, stops=True)


def build(inputs: Sequence[Told]) -> Exam:
    """
    Return the exam for some inputs.

    :param inputs: speeds (topic 0) and turns (topic 1).  The expected command must not change
        twice within one period: then at least one command arrives in between, whenever the timer
        was created
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
        asks={
            'commands': Specification(inputs, right, joining_slips(len(SOURCES), OLD_S, PERIOD_S))
        },
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


def journey(values: Sequence[float], first: int = 0) -> list[Told]:
    """
    Return inputs in which the messages of each topic begin, pause, resume and repeat a value.

    :param values: fifteen different numbers other than 0.0
    :param first: topic of the first message
    """
    one, two = first, 1 - first
    topics = [one, two, one, two, one, two, one, one, two, one, two, two, two, two, one]
    topics += [two, one] * 3
    # Each topic has a 0.0, and at the end the same value three times.
    numbers = [*values[:4], 0.0, *values[4:7], 0.0, *values[7:13], *list(values[13:]) * 3]
    lasts = {5: LONG_S, 10: MIDDLE_S, 12: MIDDLE_S}
    return [
        Told(topic, number, lasts.get(place, SHORT_S))
        for place, (topic, number) in enumerate(zip(topics, numbers, strict=True))
    ]


exam = build(
    journey(
        [
            *(0.5, 0.2, 0.8, -0.3, 0.4, 0.6, -0.7, 0.1),
            *(1.0, -0.2, 0.25, 0.9, 0.35, 0.7, 0.3),
        ]
    )
)

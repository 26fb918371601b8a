"""
Programs that keep their own time: how long they are watched, and whether they went on to the end.

A program that answers none of the probe's questions, as a loop with ``time.sleep()`` does, cannot
be led through simulated time.  It is watched in real time instead.  How long is drawn from the
course secret where it counts, so that a program that works for a while only, and answers nothing
on purpose, cannot know when to stop.

A program may answer and publish from another clock all the same, such as ``threading.Timer``.
How many of its messages fall into a run depends on the machine then, so one that may be such, and
has not passed, is run again (:func:`patient`): if it publishes while the clock stands still, it is
watched in real time too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
import math
import re

from autograder.judging.code_periods import timer_periods
from autograder.judging.learners_code import without_texts
from autograder.runs.inputs import generator
from autograder.runs.recording import Recording
from autograder.runs.scenario import Advance, Feed, Join, Scenario

SHORTEST_S, LONGEST_S = 6.5, 9.5
SLOWEST, FASTEST = 1.5, 0.65
"""How many periods may lie between two messages; the room is for a busy machine."""
LATE_S = 0.5  # from the end of the watch to the end of the recording
FLOOD = 10
"""How many times what is due is a flood: how much of it is heard is luck, and not told."""
_OTHER_CLOCK = re.compile(
    r'\b(STEADY_TIME|SYSTEM_TIME|use_sim_time|asyncio|threading\.Timer|Timer\()'
    r'|\btime\.(time|time_ns|monotonic|monotonic_ns|perf_counter|sleep)\b|\bsleep\('
)

_ANY_CLOCK = re.compile(
    r'\b(time|threading|_thread|asyncio|sched|signal|select|queue|concurrent|multiprocessing'
    r'|subprocess|ctypes|timeout\w*|\w*Clock|ClockType|Timer|Event|Condition|\w*sleep|wait\w*'
    r'|datetime|selectors|spin_once|use_sim_time|use_global_arguments)\b'
    r'|\bargs\s*=\s*[\[(]|\binit\(\s*[\[(]'
)
STAND_STILL_S = 2.5
"""Longer than any period that an exam asks for."""


def watched_longer(exam: str, scenario: Scenario) -> Scenario:
    """
    Return a hidden exam's scenario with a watch that nobody can know beforehand.

    Only the first stretch of time is made longer: an exam may have many, and all of them together
    have to stay below the limit of a run.

    :param exam: name of the exam
    """
    seconds = round(generator(exam, 'watch in real time').uniform(SHORTEST_S, LONGEST_S), 2)
    steps = list(scenario.steps)
    for number, step in enumerate(steps):
        if isinstance(step, Advance):
            steps[number] = replace(step, watch_s=seconds)
            break
    return replace(scenario, steps=tuple(steps))


def least_messages(recording: Recording, period_s: float) -> int:
    """
    Return how many messages come at least from a program that goes on as long as it is watched.

    :param recording: of a program that keeps its own time
    :param period_s: of its messages [s]
    """
    watched = max(float(event['seconds']) for event in recording.of('wall_time'))
    return max(3, math.ceil(watched / (SLOWEST * period_s)))


def is_regular(recording: Recording, times_s: Sequence[float], period_s: float) -> bool:
    """
    Tell whether messages came once a period of real time, until the end of the recording.

    :param times_s: ``wall_s`` of the messages, in order
    :param period_s: as it should be [s]
    """
    gaps = [(later - earlier) / period_s for earlier, later in pairwise(times_s)]
    if len(times_s) < least_messages(recording, period_s):
        return False
    if not all(FASTEST <= gap <= SLOWEST for gap in gaps):
        return False
    end_s = max((float(event['wall_s']) for event in recording.of('end')), default=times_s[-1])
    return end_s - times_s[-1] <= SLOWEST * period_s + LATE_S


def patient(scenario: Scenario, files: Mapping[str, str], recording: Recording) -> Scenario | None:
    """
    Return how to run a program again that has not passed and may keep its own time.

    Only an exam whose programs publish of their own accord is such: for one that asks for answers
    see :mod:`autograder.judging.late_answers`.

    :param files: relative path to text
    :param recording: of the run before
    :returns: None if there is nothing to find out
    """
    kinds = {type(step) for step in scenario.steps}
    if (
        Advance not in kinds
        or kinds & {Feed, Join}
        or recording.in_wall_time
        or recording.end_reason != 'complete'
    ):
        return None
    if not may_have_a_clock(files):
        return None
    return replace(scenario, stand_still_s=STAND_STILL_S)


def may_have_a_clock(files: Mapping[str, str]) -> bool:
    """
    Tell whether code names anything that waits or paces, and generously.

    It decides only whether somebody looks.

    :param files: relative path to text
    """
    return any(_ANY_CLOCK.search(without_texts(text)) for text in files.values())


def names_another_clock(files: Mapping[str, str]) -> bool:
    """
    Tell whether a program names a clock that is not the node's, in its code and not in a comment.

    How much it then sends in simulated time depends on how fast the machine is, so no text should
    tell a count.  It decides words only, never a verdict.

    :param files: relative path to text
    """
    return any(_OTHER_CLOCK.search(without_texts(text)) for text in files.values())


def keeps_its_timer(files: Mapping[str, str], times_s: Sequence[float], step_s: float) -> bool:
    """
    Tell whether messages come in the period that the code gives a timer, and so on no other clock.

    A program may name another clock and be paced by its timer all the same: ``time.time()`` in a
    formula makes a value.  Its rhythm is then no luck, and may be told.

    :param files: relative path to text
    :param times_s: ``clock_ns`` of the messages in seconds, in order
    :param step_s: of the simulated clock, at which messages are seen [s]
    """
    return len(times_s) > 2 and any(
        all(
            abs(time_s - times_s[0] - number * max(period_s, step_s)) <= step_s
            for number, time_s in enumerate(times_s)
        )
        for period_s in timer_periods(files)
    )


def is_flood(count: float, due: float) -> bool:
    """Tell whether so many are far more than were due, so that no text should tell the count."""
    return count > FLOOD * max(due, 1.0)

"""
Programs that answer, or speak unasked, by a clock of their own, where an exam asks for answers.

A thread that sleeps, a ``threading.Timer`` or a steady timer are not led by the simulated clock.
How much of what they send falls between two inputs depends on the machine, and so would points.
For a program whose code names any clock, an exam with a ``Feed`` or a ``Join`` therefore ends with
a phase in which nothing is due: checks refuse what comes then (:func:`refuse_unasked`).  One that
has not passed, and can put things off, is run again slowly, with time for an answer after each
input: to be late is no mistake.  The pauses are longer than usual ones, and named in the threat
model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
import re

from autograder.judging.causes import why_silent
from autograder.judging.exam import Cause, Failed, Run
from autograder.judging.learners_code import without_texts
from autograder.judging.own_time import may_have_a_clock, STAND_STILL_S
from autograder.runs.recording import Event, Recording
from autograder.runs.scenario import Advance, Await, Feed, Join, Leave, Mark, Offer, Scenario, Step

STILL, STILL_AT_FIRST = 'nothing is due', 'nothing is due yet'
"""Phases of a run: in the end, and before the first input if somebody has joined."""
MORE_THAN_COME = 100_000
"""So that a whole pause is waited for, whatever comes."""
LONGEST_S = 55.0
"""Of all pauses after inputs together: a run has 75 s."""
_DEFERS = re.compile(
    r'\b(\w*[tT]hread\w*|Timer|asyncio|sched|signal|concurrent|multiprocessing|subprocess|ctypes'
    r'|\w*sleep|spin_once|spin_until\w*|Clock|ClockType|use_sim_time|use_global_arguments)\b'
    r'|\bargs\s*=\s*[\[(]|\binit\(\s*[\[(]'
)
UNASKED = Cause(
    'speaks_unasked',
    'Something comes when nothing is due: a part of your program follows the clock of the '
    'computer, and answers late or speaks unasked.',
    'Answer in the callback, once and at once, and from nowhere else: no thread with '
    'time.sleep(), no threading.Timer, no timer with another clock.',
)


@dataclass(frozen=True)
class Pauses:
    """
    Pauses of wall time [s].

    :param answer_s: after each input of a slow run
    :param still_s: in the end, when nothing is due
    """

    answer_s: float
    still_s: float


GRADED = Pauses(answer_s=2.2, still_s=STAND_STILL_S)
"""Long enough for a program that looks, or repeats something, every two seconds."""
CHECKED = Pauses(answer_s=1.0, still_s=1.2)
"""For a learner, who waits for it."""
SOON_S = 0.2
"""After each input, for a learner whose program was silent in the end: it is hardly later."""


def first_run(scenario: Scenario, files: Mapping[str, str], hidden: bool) -> Scenario:
    """
    Return how to run a program at first: as the exam says, and in the end it must be silent.

    Where others join and nothing is fed, it is the slow run at once: who sends blindly after some
    seconds would else meet or miss them by luck.  A learner does not wait for that.

    :param files: relative path to text
    :returns: the scenario itself, if no answers are asked for or the code names no clock
    """
    kinds = {type(step) for step in scenario.steps}
    # To our own offers belong deadlines, which speak in wall time.
    if scenario.program == 'build' or not kinds & {Feed, Join} or Offer in kinds:
        return scenario
    if not may_have_a_clock(files):
        return scenario
    pauses = GRADED if hidden else CHECKED
    if _is_slow_at_once(scenario, hidden):
        return _slowly(scenario, pauses)
    steps: list[Step] = []
    for step in scenario.steps:
        steps += [*_before_first_input(steps, step, pauses), step]
    return replace(scenario, steps=(*steps, *_still(STILL, pauses)))


def second_run(
    scenario: Scenario, files: Mapping[str, str], recording: Recording, hidden: bool
) -> Scenario | None:
    """
    Return how to run a program that has not passed, with time for an answer after each input.

    Only one that can put an answer off is such: to forgive a node that drops what comes quickly,
    the name of a clock is not enough.

    :param scenario: of the exam
    :param recording: of the first run
    :returns: None if that tells nothing new
    """
    if recording.end_reason != 'complete' or recording.in_wall_time:
        return None
    if first_run(scenario, files, hidden) is scenario or _is_slow_at_once(scenario, hidden):
        return None
    if not any(_DEFERS.search(without_texts(text)) for text in files.values()):
        return None
    pauses = GRADED if hidden else CHECKED
    if not hidden and not _spoke_unasked(recording):
        pauses = replace(pauses, answer_s=SOON_S)
    return _slowly(scenario, pauses)


def _is_slow_at_once(scenario: Scenario, hidden: bool) -> bool:
    return hidden and not _is_fed(scenario.steps)


def _spoke_unasked(recording: Recording) -> bool:
    phases = [recording.phase(name) for name in (STILL_AT_FIRST, STILL)]
    return any(phase.of('message') or phase.of('log') for phase in phases)


def _slowly(scenario: Scenario, pauses: Pauses) -> Scenario:
    inputs = sum(len(step.messages) for step in scenario.steps if isinstance(step, Feed))
    answer_s = min(pauses.answer_s, LONGEST_S / max(inputs, 1))
    first_join = next((step for step in scenario.steps if isinstance(step, Join)), None)
    steps: list[Step] = []
    around = zip(
        (None, *scenario.steps), scenario.steps, (*scenario.steps[1:], None), strict=False
    )
    for before, step, after in around:
        steps += _before_first_input(steps, step, pauses)
        if isinstance(step, Feed):
            steps += _one_by_one(step, answer_s)
            continue
        if isinstance(step, Await) and isinstance(before, Feed):
            continue  # it has been waited for
        if step is first_join and not _is_fed(scenario.steps):
            steps.append(_pause(_watch_s(scenario)))
        steps.append(step)
        left = isinstance(step, Leave) and not isinstance(after, Leave)
        if isinstance(step, Join) or left:
            steps.append(_pause(answer_s))
    return replace(scenario, steps=(*steps, *_still(STILL, pauses)))


def _one_by_one(feed: Feed, answer_s: float) -> list[Step]:
    """Return the steps that send the same, each with time for its answer; a burst stays one."""
    single = not feed.burst and len(feed.messages) > 1
    steps: list[Step] = []
    for part in [[one] for one in feed.messages] if single else [feed.messages]:
        steps += [replace(feed, messages=part), _pause(answer_s * len(part))]
    return steps


def _before_first_input(before: Sequence[Step], step: Step, pauses: Pauses) -> list[Step]:
    """Return the phase in which who has joined must hear nothing more."""
    joined = any(isinstance(one, Join) for one in before)
    if not isinstance(step, Feed) or not joined or _is_fed(before):
        return []
    phases = [one.name for one in before if isinstance(one, Mark)]
    return [*_still(STILL_AT_FIRST, pauses), Mark(phases[-1] if phases else 'inputs')]


def _is_fed(steps: Sequence[Step]) -> bool:
    return any(isinstance(step, Feed) for step in steps)


def _watch_s(scenario: Scenario) -> float:
    """Return a time that in a hidden exam nobody can know, see ``own_time.watched_longer``."""
    times = [step.watch_s for step in scenario.steps if isinstance(step, Advance)]
    return max(times, default=Advance.watch_s)


def _still(name: str, pauses: Pauses) -> list[Step]:
    return [Mark(name), _pause(pauses.still_s)]


def _pause(seconds: float) -> Await:
    return Await(messages=MORE_THAN_COME, seconds=seconds)


def refuse_unasked(
    run: Run, found: Sequence[Event], what: str, why: Cause = UNASKED, *, rest: str = 'arrives'
) -> None:
    """
    Fail if something came while nothing was due, by a clock of the program's own.

    How much of it came between the answers, and where, is luck, so nothing else is asked of it.

    :param found: of the phase :data:`STILL`, or of :data:`STILL_AT_FIRST`
    :param what: they are, with the topic or the level
    :param rest: what did not take place, after the word nothing
    """
    if found:
        raise Failed(
            expected=f'no {what} when nothing {rest}',
            observed='some, in seconds in which all was at rest',
            why=why_silent(run) or why,
        )

"""
Programs that answer, or speak unasked, by a clock of their own, where an exam asks for answers.

A thread that sleeps, a ``threading.Timer`` or a steady timer are not led by the simulated clock.
How much of what they send falls between two inputs depends on the machine, and so would points.
For a program whose code names any clock, an exam with a ``Feed`` or a ``Join`` therefore ends with
a phase in which nothing is due: checks refuse what comes then (:func:`refuse_unasked`).  One that
has not passed is run again slowly, with time for an answer after each input: to be late is no
mistake.  The pauses are longer than usual ones, and named in the threat model.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from autograder.judging.causes import why_silent
from autograder.judging.exam import Cause, Failed, Run
from autograder.judging.own_time import may_have_a_clock
from autograder.runs.recording import Event, Recording
from autograder.runs.scenario import Advance, Await, Feed, Join, Leave, Mark, Offer, Scenario, Step

STILL, STILL_AT_FIRST = 'nothing is due', 'nothing is due yet'
"""Phases of a run: in the end, and before the first input if somebody has joined."""
MORE_THAN_COME = 100_000
"""So that a whole pause is waited for, whatever comes."""
UNASKED = Cause(
    'other_clock',
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


GRADED = Pauses(answer_s=2.2, still_s=2.5)
"""Longer than those of who looks, or repeats something, every two seconds."""
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

    :param scenario: of the exam
    :param recording: of the first run
    :returns: None if that tells nothing new
    """
    if recording.end_reason != 'complete' or recording.in_wall_time:
        return None
    if first_run(scenario, files, hidden) is scenario or _is_slow_at_once(scenario, hidden):
        return None
    pauses = GRADED if hidden else CHECKED
    if not hidden and not _spoke_in_the_end(recording):
        pauses = replace(pauses, answer_s=SOON_S)
    return _slowly(scenario, pauses)


def _is_slow_at_once(scenario: Scenario, hidden: bool) -> bool:
    return hidden and not _is_fed(scenario.steps)


def _spoke_in_the_end(recording: Recording) -> bool:
    phases = [recording.phase(name) for name in (STILL_AT_FIRST, STILL)]
    return any(phase.of('message') or phase.of('log') for phase in phases)


def _slowly(scenario: Scenario, pauses: Pauses) -> Scenario:
    fed, joined = _is_fed(scenario.steps), False
    steps: list[Step] = []
    for step, after in zip(scenario.steps, (*scenario.steps[1:], None), strict=True):
        steps += _before_first_input(steps, step, pauses)
        if isinstance(step, Feed):
            parts = [[one] for one in step.messages] if not step.burst else [step.messages]
            for part in parts:
                steps.append(replace(step, messages=part))
                steps.append(_pause(pauses.answer_s * len(part)))
            continue
        if isinstance(step, Join) and not fed and not joined:
            steps.append(_pause(_watch_s(scenario)))
        joined = joined or isinstance(step, Join)
        steps.append(step)
        if isinstance(step, (Join, Leave)) and not isinstance(after, Leave):
            steps.append(_pause(pauses.answer_s))
    return replace(scenario, steps=(*steps, *_still(STILL, pauses)))


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

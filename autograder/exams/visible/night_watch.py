"""
Lesson 01, second exercise: a node that logs, in a namespace that is chosen from outside.

The specification, as the lesson gives it: node ``night_watch``; once a second one line with the
number of the watch, from 1; level INFO, and WARN for every fifth; the node's own logger; no
namespace in the code.
"""

from __future__ import annotations

import re

from autograder.causes import why_silent
from autograder.checks import (
    LEVELS,
    own_logs,
    require_node,
    require_ros_clock,
    SECOND,
    why_not_logged,
)
from autograder.exam import Cause, Exam, Failed, Run
from autograder.recording import Event, INFO, WARN
from autograder.scenario import Advance, Await, Scenario

STEP_S = 0.25
EVERY = 5


def node_of(run: Run) -> str:
    """Return the full name that the node has in this run."""
    return f'{run.facts["namespace"]}/night_watch'


def reports(run: Run) -> list[Event]:
    """Return what the node's own logger said, whatever the level."""
    return own_logs(run, node_of(run))


def starts_in_the_namespace(run: Run) -> None:
    """Your node is called night_watch, and its namespace is the one chosen at its start."""
    require_node(run, node_of(run))


def reports_every_second(run: Run) -> None:
    """It logs one line a second, with its own logger, from a timer."""
    require_ros_clock(run)
    seconds = run.facts['simulated_s']
    found = reports(run)
    # A timer fires on the first clock step at or after its time, and is seen one step later.
    seen = [round((entry['clock_ns'] or 0) / SECOND - STEP_S) for entry in found]
    if seen == list(range(1, seconds + 1)):
        return
    raise Failed(
        expected=f'{seconds} lines in {seconds} s, one in every second',
        observed=f'{len(found) or "no"} lines',
        why=_why_not_every_second(run, found),
    )


def _why_not_every_second(run: Run, found: list[Event]) -> Cause | None:
    seconds = run.facts['simulated_s']
    if not found:
        return why_not_logged(run, found, INFO)
    if len(found) < seconds and (ended := why_silent(run)):
        return ended
    fifth = seconds // EVERY
    if len(found) == seconds + fifth:
        return Cause(
            'both_levels',
            'A fifth watch is logged twice, at level INFO and at level WARN.',
            'Use if and else: one line a watch.',
        )
    return Cause(
        'wrong_period',
        f'There is about one line every {seconds / len(found):.2g} s.',
        'The first argument of create_timer() is the period in seconds: 1.0.',
    )


def lines_are_numbered(run: Run) -> None:
    """The lines carry the number of the watch: 1, 2, 3, and so on."""
    found = _enough(run)
    for number, entry in enumerate(found, 1):
        if str(number) not in re.findall(r'\d+', entry['text']):
            raise Failed(
                expected=f'the number {number} in line {number}',
                observed=f'{entry["text"][:60]!r}',
                why=_why_misnumbered(number, entry['text'], found[0]['text']),
            )


def _why_misnumbered(number: int, text: str, first: str) -> Cause | None:
    if number > 1 and text == first:
        return Cause(
            'never_counts',
            'The number is the same in every line.',
            'Keep it in self.number, made once in __init__(), and add 1 in the callback.',
        )
    if number == 1 and '0' in re.findall(r'\d+', text):
        return Cause(
            'counts_from_zero',
            'The first watch is number 0.',
            'Count first, then log; or begin at 1.',
        )
    return None


def every_fifth_is_a_warning(run: Run) -> None:
    """Every fifth line is a WARN, all others are INFO."""
    found = _enough(run)
    for number, entry in enumerate(found, 1):
        wanted = WARN if number % EVERY == 0 else INFO
        if entry['level'] != wanted:
            raise Failed(
                expected=f'level {LEVELS[wanted]} for watch {number}',
                observed=f'level {LEVELS.get(entry["level"], entry["level"])}',
                why=_why_wrong_level(number, entry['level'])
                if number == 1 or entry['text'] != found[0]['text']
                else None,
            )


def _why_wrong_level(number: int, level: int) -> Cause | None:
    if number % EVERY == 0 and level == INFO:
        return Cause(
            'no_warning',
            'A fifth watch is logged like any other.',
            'If number % 5 == 0, use self.get_logger().warning(...).',
        )
    if level == WARN and number % EVERY == EVERY - 1:
        return Cause(
            'warns_one_early',
            'The warning comes one watch early: the number is looked at before it is counted.',
            'Count first, then decide.',
        )
    if number % EVERY == 0:
        return Cause(
            'other_level',
            'A fifth watch is neither INFO nor WARN.',
            'Use self.get_logger().warning(...).',
        )
    if level == WARN:
        return Cause(
            'warns_too_often',
            f'{number} cannot be divided by {EVERY}, and yet watch {number} is a warning.',
            'Warn if number % 5 == 0, with the number that stands in the line.',
        )
    return None


def _enough(run: Run) -> list[Event]:
    """Return the lines, if a warning is among those that are due."""
    found = reports(run)
    if len(found) < 2 * EVERY:
        raise Failed(
            expected=f'at least {2 * EVERY} lines to look at',
            observed=f'{len(found) or "none"}',
            why=why_silent(run),
        )
    return found


def build(seconds: int, phase_s: float, namespace: str) -> Exam:
    """
    Return the exam over some simulated time.

    :param seconds: simulated seconds, >= 11
    :param phase_s: first clock value, 0 < phase_s < 0.25 [s]
    :param namespace: chosen on the command line, such as ``/harbour``
    """
    exam = Exam(
        'night_watch',
        title='The night watch',
        assignment='01_node_life',
        part=2,
        cells=('night_watch',),
        requires=('night_watch.py',),
        scenario=Scenario(
            file='night_watch.py',
            arguments=('-r', f'__ns:={namespace}'),
            steps=(
                Advance(1.5, phase_s=phase_s),
                Await(logs=1),
                Advance(seconds - 1.0, phase_s=STEP_S),
            ),
        ),
        read='Part 4: Logging',
        facts={'simulated_s': seconds, 'namespace': namespace},
    )
    exam.check(points=2)(starts_in_the_namespace)
    exam.check(points=3, needs=['starts_in_the_namespace'])(reports_every_second)
    exam.check(points=2, needs=['starts_in_the_namespace'])(lines_are_numbered)
    exam.check(points=3, needs=['starts_in_the_namespace'])(every_fifth_is_a_warning)
    return exam


exam = build(seconds=11, phase_s=0.1, namespace='/north')

"""
Lesson 01, second exercise: a node that logs, in a namespace that is chosen from outside.

The specification, as the lesson gives it: node ``night_watch``; once a second one line with the
number of the watch, from 1; level INFO, and WARN for every fifth; the node's own logger; no
namespace in the code.
"""

from __future__ import annotations

from collections.abc import Sequence
import re

from autograder.exams.visible.harbour import (
    require_timer,
    second_of,
    why_no_report,
    why_other_period,
)
from autograder.judging.causes import why_silent
from autograder.judging.checks import own_logs, require_node, require_ros_clock
from autograder.judging.code_periods import timer_periods
from autograder.judging.exam import Cause, Exam, Failed, Run
from autograder.judging.own_time import is_flood
from autograder.judging.results import shortened
from autograder.judging.unlogged import LEVELS, why_left_out, why_not_logged
from autograder.runs.recording import Event, INFO, WARN
from autograder.runs.scenario import Advance, Await, Scenario

STEP_S = 0.25
EVERY = 5
EXERCISE = 'Exercise 2: the night watch'


def node_of(run: Run) -> str:
    """Return the full name that the node has in this run."""
    return f'{run.facts["namespace"]}/night_watch'


def reports(run: Run) -> list[Event]:
    """Return what the node's own logger said once it had started, whatever the level."""
    return [entry for entry in own_logs(run, node_of(run)) if second_of(entry) > 0]


def numbers_in(entry: Event) -> list[int]:
    """Return the numbers in a line; 003 is 3, and digits of any script are digits."""
    return [int(digits) for digits in re.findall(r'\d{1,9}', entry['text'])]


def starts_in_the_namespace(run: Run) -> None:
    """Your node is called night_watch, and its namespace is the one chosen at its start."""
    require_node(run, node_of(run))


def reports_every_second(run: Run) -> None:
    """It logs one line a second, with its own logger, from a timer."""
    require_ros_clock(run)
    found, seconds = _no_flood(run), run.facts['simulated_s']
    if [second_of(entry) for entry in found] == list(range(1, seconds + 1)):
        return
    require_timer(run)
    raise Failed(
        expected=f'{seconds} lines in {seconds} s, one in every second',
        observed=f'{len(found) or "no"} lines',
        why=_why_not_every_second(run, found),
    )


def _no_flood(run: Run) -> list[Event]:
    """Return the lines, unless there are so many that which of them arrive is luck."""
    if is_flood(len(own_logs(run, node_of(run))), run.facts['simulated_s']):
        raise Failed(
            expected='one line a second',
            observed='far more lines than that',
            why=Cause(
                'flood',
                'Far more lines come than one a second.',
                'Log once in the callback of one timer, and nowhere else.',
            ),
        )
    return reports(run)


def _why_not_every_second(run: Run, found: list[Event]) -> Cause | None:
    seconds = run.facts['simulated_s']
    if not found:
        return why_not_logged(run, found, INFO, _has_another) or why_no_report(run, 1)
    if len(found) < seconds and (why := why_silent(run) or _why_left_out(run)):
        return why
    return (
        _why_not_one_line(run, found)
        or _why_some_missing(run, found)
        or why_other_period(run, found, 1)
    )


def _why_left_out(run: Run) -> Cause | None:
    return why_left_out(run, INFO) or why_left_out(run, WARN)


def _why_some_missing(run: Run, found: Sequence[Event]) -> Cause | None:
    """Explain lines that are too few, although the timer ticks once a second."""
    seconds = run.facts['simulated_s']
    fifths = list(range(EVERY, seconds + 1, EVERY))
    # The numbers show that it has counted the others.
    counted = all(second_of(entry) in numbers_in(entry) for entry in found)
    if counted and [second_of(entry) for entry in found] == fifths:
        return why_not_logged(run, [], INFO, _has_another) or Cause(
            'only_fifths',
            'Every fifth watch is logged, and the others are not.',
            'Use if and else: a WARN for the fifth, self.get_logger().info(...) for the others.',
        )
    if len(found) < seconds and timer_periods(run.files) == {1.0}:
        return Cause(
            'lines_missing',
            'The period of your timer is 1 s, and yet lines are missing.',
            'Does each call of the callback log a line? Is the timer made in __init__(), and '
            'never cancelled? Start the node, and look at logs().',
        )
    return None


def _has_a_fifth(text: str) -> bool:
    return any(number and number % EVERY == 0 for number in numbers_in({'text': text}))


def _has_another(text: str) -> bool:
    return any(number % EVERY for number in numbers_in({'text': text}))


def _why_not_one_line(run: Run, found: Sequence[Event]) -> Cause | None:
    """Explain watches with two lines or with none, which shift all that follow."""
    if run.recording.in_wall_time:
        return None  # how many are heard in real time is luck
    seconds = run.facts['simulated_s']
    fifths, moments = seconds // EVERY, {entry['clock_ns'] for entry in found}
    if len(found) - seconds == fifths and len(moments) <= seconds:
        return Cause(
            'both_levels',
            'A fifth watch is logged twice.',
            'Use if and else: one line a watch, either INFO or WARN.',
        )
    if seconds - len(found) == fifths and not _warned(found):
        return why_not_logged(run, [], WARN, _has_a_fifth) or Cause(
            'fifth_missing',
            'A fifth watch is not logged at all.',
            'Use if and else: one line a watch, also for the fifth.',
        )
    cause = why_other_period(run, found, 1)
    return cause if cause and cause.cause_id == 'several_at_once' else None


def _warned(found: Sequence[Event]) -> list[int]:
    """Return which lines are warnings, counted from 1."""
    return [number for number, entry in enumerate(found, 1) if entry['level'] == WARN]


def lines_are_numbered(run: Run) -> None:
    """The lines carry the number of the watch: 1, 2, 3, and so on."""
    found = _enough(run)
    first = _first_watch(run, found) or 1
    for line, entry in enumerate(found, 1):
        if first + line - 1 not in numbers_in(entry):
            raise Failed(
                expected=f'the number {first + line - 1} in line {line}',
                observed=repr(shortened(entry['text'])),
                why=_why_not_one_line(run, found)
                or (None if run.recording.in_wall_time else _why_misnumbered(line, found)),
            )


def _first_watch(run: Run, found: Sequence[Event]) -> int:
    """
    Return the watch of the first line, or 0 if nothing tells it.

    A program that keeps its own time may have spoken before anybody heard it: its first number
    counts if the others go on from it.
    """
    if not run.recording.in_wall_time:
        return 1
    for first in numbers_in(found[0]):
        if all(first + more in numbers_in(one) for more, one in enumerate(found)):
            return first
    return 0


def _why_misnumbered(number: int, found: Sequence[Event]) -> Cause | None:
    text, numbers = found[number - 1]['text'], numbers_in(found[number - 1])
    if '{' in text and '}' in text:
        return Cause(
            'no_f_string',
            'The text has braces in it: they are filled in only if an f stands before the quotes.',
            "Write f'Watch {self.number}'.",
        )
    if not numbers:
        return Cause('no_number', 'There is no number in the line.', "Log f'Watch {self.number}'.")
    if len({entry['text'] for entry in found}) == 1:
        return Cause(
            'never_counts',
            'The number is the same in every line.',
            'Keep it in self.number, made once in __init__(), and add 1 in the callback.',
        )
    if number == 1 and 0 in numbers:
        return Cause(
            'counts_from_zero',
            'The first watch is number 0.',
            'Count first, then log; or begin at 1.',
        )
    if number == 1 and 2 in numbers:
        return Cause(
            'counted_before',
            'The first line of the timer says 2: something has counted before it.',
            'Count in the callback only, from 0, and let the timer alone call it.',
        )
    if number > 1 and set(numbers) & set(numbers_in(found[0])):
        return Cause(
            'begins_again',
            f'The count goes back after {number - 1} lines.',
            'Set the number once, in __init__(), and let it grow for ever.',
        )
    if number == 2:
        return Cause(
            'wrong_step',
            'From one line to the next the number does not grow by 1.',
            'Add 1 in the callback, once: self.number += 1.',
        )
    return None


def every_fifth_is_a_warning(run: Run) -> None:
    """Every fifth line is a WARN, all others are INFO."""
    found = _enough(run)
    # Lines without the right numbers are fifths from the first warning on, where nobody counts.
    warned = _warned(found)
    first = _first_watch(run, found) or (1 - warned[0] if warned else 1) % EVERY
    for number, entry in enumerate(found, first):
        wanted = WARN if number % EVERY == 0 else INFO
        if entry['level'] != wanted:
            raise Failed(
                expected=f'level {LEVELS[wanted]} for watch {number}',
                observed=f'level {LEVELS.get(entry["level"], entry["level"])}',
                why=_why_not_one_line(run, found)
                or (_why_wrong_level(number, entry['level'], found) if first == 1 else None),
            )


def _why_wrong_level(number: int, level: int, found: Sequence[Event]) -> Cause | None:
    warned, every = _warned(found), range(1, len(found) + 1)
    misnumbered = any(one not in numbers_in(found[one - 1]) for one in every)
    if misnumbered and all(
        (entry['level'] == WARN) == any(one % EVERY == 0 for one in numbers_in(entry))
        for entry in found
    ):
        return Cause(
            'follows_number',
            'The level fits the number in the line, but the number is not that of the watch.',
            'Mend the count first.',
        )
    if level not in (INFO, WARN):
        wanted = 'warning' if number % EVERY == 0 else 'info'
        return Cause(
            'wrong_level',
            'A watch is neither INFO nor WARN.',
            f'Use self.get_logger().{wanted}(...) here.',
        )
    if not warned:
        return Cause(
            'no_warning',
            'A fifth watch is logged like any other.',
            'If number % 5 == 0, use self.get_logger().warning(...).',
        )
    if warned == [one for one in every if one % EVERY]:
        return Cause(
            'inverted',
            'INFO and WARN have changed places: number % 5 is 0 for every fifth, and 0 counts as '
            'false.',
            'Warn if number % 5 == 0.',
        )
    if warned == [one for one in every if one % EVERY == EVERY - 1]:
        return Cause(
            'warns_one_early',
            'The warning comes one watch early: the number is looked at before it is counted, or '
            'one is added for the text alone.',
            'Count first, then decide.',
        )
    if warned == [one for one in every if one % EVERY == 1 and (one > 1 or 1 in warned)]:
        return Cause(
            'warns_one_late',
            'The warning comes one watch late: number % 5 is looked at with a number that is one '
            'behind.',
            'Count first, then decide.',
        )
    if len(warned) > 1 and warned == [one for one in every if one % warned[0] == 0]:
        return Cause(
            'warns_otherwise',
            f'Watch {warned[0]} is a warning, and so is each of its multiples.'
            if warned[0] > 1
            else 'Every watch is a warning.',
            'Warn if number % 5 == 0, and log an INFO line below else.',
        )
    if warned == [EVERY]:
        return Cause(
            'warns_once',
            'The fifth watch is a warning, the tenth is not.',
            'Warn if number % 5 == 0: that holds for 5, 10, 15 and so on.',
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
    found = _no_flood(run)
    # Real time is watched for a few seconds only; one warning is among five lines.
    least = EVERY if run.recording.in_wall_time else 2 * EVERY
    if len(found) < least:
        require_timer(run)
        raise Failed(
            expected=f'at least {least} lines to look at',
            observed=f'{len(found) or "none"}',
            why=_why_not_every_second(run, found),
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
    exam.check(points=2, read='Part 3: Names and worlds')(starts_in_the_namespace)
    exam.check(points=3, needs=['starts_in_the_namespace'], read=EXERCISE)(reports_every_second)
    exam.check(points=2, needs=['starts_in_the_namespace'], read=EXERCISE)(lines_are_numbered)
    exam.check(points=3, needs=['starts_in_the_namespace'])(every_fifth_is_a_warning)
    return exam


exam = build(seconds=11, phase_s=0.1, namespace='/north')

"""
Lesson 01, second exercise: a node that logs, in a namespace that is chosen from outside.

The specification, as the lesson gives it: node ``night_watch``; once a second one line with the
number of the watch, from 1; level INFO, and WARN for every fifth; the node's own logger; no
namespace in the code.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
import re

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Advance, Mark, Scenario
from autograder.exams.visible.harbour import WATCH, watched_lines, why_no_report
from autograder.judging.causes.missing_logs import LEVELS, why_left_out, why_not_logged
from autograder.judging.checks import own_logs, require_node, SECOND
from autograder.judging.rhythm import GRAIN_S, require_period, why_other_rhythm
from autograder.recording import Event, INFO, WARN
from autograder.results import shortened

EVERY = 5
EXERCISE = 'Exercise 2: the night watch'


def node_of(run: Run) -> str:
    """Return the full name that the node has in this run."""
    return f'{run.facts["namespace"]}/night_watch'


def reports(run: Run) -> list[Event]:
    """Return the lines of the node's own logger, whatever their level, while it is watched."""
    return watched_lines(run, node_of(run))


def watches(run: Run) -> list[Event]:
    """Return the lines that are counted: the first watches may come when the program starts."""
    said, found = own_logs(run, node_of(run)), reports(run)
    until_first = said[: len(said) - len(found) + 1]
    ones = [place for place, entry in enumerate(until_first) if 1 in numbers_in(entry)]
    return said[ones[-1] :] if ones else found


def numbers_in(entry: Event) -> list[int]:
    """Return the numbers in a line; 003 is 3, and digits of any script are digits."""
    return [int(digits) for digits in re.findall(r'\d{1,9}', entry['text'])]


def starts_in_the_namespace(run: Run) -> None:
    """Your node is called night_watch, and its namespace is the one chosen at its start."""
    require_node(run, node_of(run))


def reports_every_second(run: Run) -> None:
    """It logs one line a second, with its own logger."""
    found = reports(run)
    require_period(
        run, found, 1.0, run.facts['seconds'], 'line', lambda: _why_not_every_second(run, found)
    )


def _why_not_every_second(run: Run, found: Sequence[Event]) -> Cause | None:
    if not found:
        return why_not_logged(run, found, INFO, _has_another) or why_no_report(run, 1)
    left_out = _why_left_out(run) if len(found) < run.facts['seconds'] else None
    return left_out or _why_not_one_line(run, found) or _why_some_missing(run, found)


def _why_left_out(run: Run) -> Cause | None:
    return why_left_out(run, INFO) or why_left_out(run, WARN)


def _why_some_missing(run: Run, found: Sequence[Event]) -> Cause | None:
    """Explain lines that are too few, although the timer ticks once a second."""
    gaps_s = [(two['clock_ns'] - one['clock_ns']) / SECOND for one, two in pairwise(found)]
    whole_s = {round(gap_s) for gap_s in gaps_s}
    if 0 in whole_s or any(abs(gap_s - round(gap_s)) > GRAIN_S for gap_s in gaps_s):
        return None
    # The numbers show that it has counted the others.
    if whole_s == {EVERY} and all(_has_a_fifth(entry['text']) for entry in found):
        return why_not_logged(run, [], INFO, _has_another) or Cause(
            'only_fifths',
            'Every fifth watch is logged, and the others are not.',
            'Use if and else: a WARN for the fifth, self.get_logger().info(...) for the others.',
        )
    if len(whole_s) != 1:
        return Cause(
            'lines_missing',
            'Your lines keep the rhythm of one second, but some are missing.',
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
    seconds, moments = run.facts['seconds'], {entry['clock_ns'] for entry in found}
    if len(found) - len(moments) == seconds // EVERY:
        return Cause(
            'both_levels',
            'A fifth watch is logged twice.',
            'Use if and else: one line a watch, either INFO or WARN.',
        )
    if seconds - len(found) == seconds // EVERY and not _warned(found):
        return why_not_logged(run, [], WARN, _has_a_fifth) or Cause(
            'fifth_missing',
            'A fifth watch is not logged at all.',
            'Use if and else: one line a watch, also for the fifth.',
        )
    cause = why_other_rhythm(found, 1.0, seconds, 'line')
    return cause if cause and cause.cause_id == 'several_at_once' else None


def _warned(found: Sequence[Event]) -> list[int]:
    """Return which lines are warnings, counted from 1."""
    return [number for number, entry in enumerate(found, 1) if entry['level'] == WARN]


def lines_are_numbered(run: Run) -> None:
    """The lines carry the number of the watch: 1, 2, 3, and so on."""
    found = _enough(run)
    for number, entry in enumerate(found, 1):
        if number not in numbers_in(entry):
            raise Failed(
                expected=f'the number {number} in line {number}',
                observed=repr(shortened(entry['text'])),
                why=_why_not_one_line(run, found) or _why_misnumbered(number, found),
            )


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
    for number, entry in enumerate(found, 1):
        wanted = WARN if number % EVERY == 0 else INFO
        if entry['level'] != wanted:
            raise Failed(
                expected=f'level {LEVELS[wanted]} for watch {number}',
                observed=f'level {LEVELS.get(entry["level"], entry["level"])}',
                why=_why_not_one_line(run, found)
                or _why_wrong_level(number, entry['level'], found),
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
    """Return the lines, if two warnings are among those that are due."""
    found = watches(run)
    if len(found) < 2 * EVERY:
        reports_every_second(run)  # fails, and says why
    return found


def build(seconds: int, namespace: str) -> Exam:
    """
    Return the exam over some time.

    :param seconds: how long the lines are watched [s], >= 4 * EVERY
    :param namespace: chosen on the command line, such as ``/harbour``
    """
    exam = Exam(
        'night_watch',
        title='The night watch',
        assignment='01_node_life',
        part=2,
        scenario=Scenario(
            file='night_watch.py',
            arguments=('-r', f'__ns:={namespace}'),
            steps=(Mark(WATCH), Advance(seconds)),
        ),
        read='Part 4: Logging',
        facts={'seconds': seconds, 'namespace': namespace},
    )
    exam.check(points=2, read='Part 3: Names and worlds')(starts_in_the_namespace)
    exam.check(points=3, needs=['starts_in_the_namespace'], read=EXERCISE)(reports_every_second)
    exam.check(points=2, needs=['starts_in_the_namespace'], read=EXERCISE)(lines_are_numbered)
    exam.check(points=3, needs=['starts_in_the_namespace'])(every_fifth_is_a_warning)
    return exam


exam = build(seconds=21, namespace='/north')

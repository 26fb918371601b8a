"""
Lesson 01, second exercise: a node that logs, in a namespace that is chosen from outside.

The specification, as the lesson gives it: node ``night_watch``; once a second one line with the
number of the watch, from 1; level INFO, and WARN for every fifth; the node's own logger; no
namespace in the code.
"""

from __future__ import annotations

from collections.abc import Sequence

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Advance, Mark, Scenario
from autograder.exam.specification import each, Rule, Slip, Specification
from autograder.exams.visible.harbour import WATCH, watched_lines
from autograder.judging.causes.missing_logs import why_left_out, why_no_line, why_not_logged
from autograder.judging.checks import own_logs, require_node, SECOND
from autograder.judging.numbers import whole_numbers_in, why_not_numbered
from autograder.judging.rhythm import GRAIN_S, require_period
from autograder.recording import Event, INFO, LEVELS, WARN
from autograder.results import shortened

EVERY = 5
EXERCISE = 'Exercise 2: the night watch'
Levels = tuple[int, ...]
"""Levels of the lines of one watch; one line is due."""


def fifths(
    every: int = EVERY, rest: int = 0, warned: Levels = (WARN,), other: Levels = (INFO,)
) -> Rule:
    """Return the rule of a node that logs watches of one rest in one way, others in another."""
    return each(lambda number: warned if number % every == rest else other)


def once(numbers: Sequence[int]) -> list[Levels]:
    """Warn of the fifth watch, and of none after it."""
    return [(WARN,) if number == EVERY else (INFO,) for number in numbers]


def late(numbers: Sequence[int]) -> list[Levels]:
    """Warn one watch late, but not in the first one."""
    return [(WARN,) if number % EVERY == 1 < number else (INFO,) for number in numbers]


ONLY_FIFTHS = Slip(
    'only_fifths',
    'Every fifth watch is logged, and the others are not.',
    'Use if and else: a WARN for the fifth, self.get_logger().info(...) for the others.',
    # The first line is where the watch begins, so it is in the first second.
    fifths(rest=1, other=()),
)
FIFTH_MISSING = Slip(
    'fifth_missing',
    'A fifth watch is not logged at all.',
    'Use if and else: one line a watch, also for the fifth.',
    fifths(warned=()),
)
ONE_LATE = Cause(
    'warns_one_late',
    'The warning comes one watch late: number % 5 is looked at with a number that is one behind.',
    'Count first, then decide.',
)
WARNINGS_STOP = Cause(
    'warnings_stop',
    'The first warnings are right, and a later one is missing.',
    'Warn if number % 5 == 0, and do not list the numbers.',
)
SLIPS = (
    ONLY_FIFTHS,
    FIFTH_MISSING,
    Slip(
        'both_levels',
        'A fifth watch is logged twice.',
        'Use if and else: one line a watch, either INFO or WARN.',
        fifths(warned=(INFO, WARN)),
    ),
    Slip(
        'no_warning',
        'A fifth watch is logged like any other.',
        'If number % 5 == 0, use self.get_logger().warning(...).',
        fifths(warned=(INFO,)),
    ),
    Slip(
        'inverted',
        'INFO and WARN have changed places: number % 5 is 0 for every fifth, and 0 counts as '
        'false.',
        'Warn if number % 5 == 0.',
        fifths(warned=(INFO,), other=(WARN,)),
    ),
    Slip(
        'warns_one_early',
        'The warning comes one watch early: the number is looked at before it is counted, or '
        'one is added for the text alone.',
        'Count first, then decide.',
        fifths(rest=EVERY - 1),
    ),
    Slip.of(ONE_LATE, fifths(rest=1)),
    Slip.of(ONE_LATE, late),
    Slip(
        'warns_once',
        'The fifth watch is a warning, the tenth is not.',
        'Warn if number % 5 == 0: that holds for 5, 10, 15 and so on.',
        once,
    ),
    *(
        Slip(
            'warns_otherwise',
            f'Watch {every} is a warning, and so is each of its multiples.'
            if every > 1
            else 'Every watch is a warning.',
            'Warn if number % 5 == 0, and log an INFO line below else.',
            fifths(every),
        )
        for every in (1, 2, 3, 4, 6, 10)
    ),
    Slip(
        'ends_in_five',
        '5 and 15 are warnings, 10 and 20 are not: the last digit is compared.',
        'Warn if number % 5 == 0: that holds for 5, 10, 15 and so on.',
        fifths(10, rest=5),
    ),
)


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
    ones = [
        place for place, entry in enumerate(until_first) if 1 in whole_numbers_in(entry['text'])
    ]
    return said[ones[-1] :] if ones else found


def levels_by_second(found: Sequence[Event]) -> list[Levels]:
    """Return the levels of the lines of each second, none if lines keep no whole seconds."""
    rows: dict[int, list[int]] = {}
    for entry in found:
        seconds = (entry['clock_ns'] - found[0]['clock_ns']) / SECOND
        if abs(seconds - round(seconds)) > GRAIN_S * max(1, round(seconds)):
            return []
        rows.setdefault(round(seconds), []).append(entry['level'])
    return [tuple(sorted(rows.get(place, ()))) for place in range(max(rows, default=-1) + 1)]


def starts_in_the_namespace(run: Run) -> None:
    """Your node is called night_watch, and its namespace is the one chosen at its start."""
    require_node(run, node_of(run), only_named=True)


def reports_every_second(run: Run) -> None:
    """It logs one line a second, with its own logger."""
    found = reports(run)
    require_period(
        run, found, 1.0, run.facts['seconds'], 'line', lambda: _why_not_every_second(run, found)
    )


def _why_not_every_second(run: Run, found: Sequence[Event]) -> Cause | None:
    if not found:
        timer = 'self.create_timer(1.0, self.report)'
        return why_not_logged(run, found, INFO, _has_another) or why_no_line(run, timer)
    few = len(found) < run.facts['seconds']
    left_out = why_left_out(run, INFO) or why_left_out(run, WARN) if few else None
    return left_out or _why_other_lines(run)


def _why_other_lines(run: Run) -> Cause | None:
    """Explain seconds with the wrong line, with several lines, or with none."""
    asked: Specification = run.facts['levels']
    rows = levels_by_second(watches(run))[: len(asked.inputs)]
    slip = next((asked.cause(rows, place) for place in asked.wrong(rows)[:1]), None)
    if slip is ONLY_FIFTHS:
        return why_not_logged(run, [], INFO, _has_another) or slip
    if slip is FIFTH_MISSING:
        return why_not_logged(run, [], WARN, _has_a_fifth) or slip
    return slip


def _has_a_fifth(text: str) -> bool:
    return any(number and number % EVERY == 0 for number in whole_numbers_in(text))


def _has_another(text: str) -> bool:
    return any(number % EVERY for number in whole_numbers_in(text))


def lines_are_numbered(run: Run) -> None:
    """The lines carry the number of the watch: 1, 2, 3, and so on."""
    texts = [str(entry['text']) for entry in _enough(run)]
    for place, text in enumerate(texts):
        if place + 1 not in whole_numbers_in(text):
            raise Failed(
                expected=f'the number {place + 1} in line {place + 1}',
                observed=repr(shortened(text)),
                why=_why_shifted(run) or why_not_numbered(texts, place),
            )


def _why_shifted(run: Run) -> Cause | None:
    """Explain watches with two lines or with none, which shift all that follow."""
    why = _why_other_lines(run)
    one_line = all(len(row) == 1 for row in levels_by_second(watches(run)))
    return None if one_line else why


def every_fifth_is_a_warning(run: Run) -> None:
    """Every fifth line is a WARN, all others are INFO."""
    found, asked = _enough(run), run.facts['levels']
    came = [(entry['level'],) for entry in found[: len(asked.inputs)]]
    for place in asked.wrong(came)[:1]:
        level = found[place]['level']
        raise Failed(
            expected=f'level {LEVELS[asked.answers[place][0]]} for watch {place + 1}',
            observed=f'level {LEVELS.get(level, level)}',
            why=_why_shifted(run) or _why_level(asked, found, came, place),
        )


def _why_level(
    asked: Specification, found: Sequence[Event], came: Sequence[Levels], place: int
) -> Cause | None:
    numbers = [whole_numbers_in(entry['text']) for entry in found]
    if any(place + 1 not in one for place, one in enumerate(numbers)) and all(
        (entry['level'] == WARN) == any(number % EVERY == 0 for number in seen)
        for entry, seen in zip(found, numbers)
    ):
        return Cause(
            'follows_number',
            'The level fits the number in the line, but the number is not that of the watch.',
            'Mend the count first.',
        )
    if came[place][0] not in (INFO, WARN):
        return Cause(
            'wrong_level',
            'A watch is neither INFO nor WARN.',
            'Use self.get_logger().warning(...) for every fifth, info(...) for the others.',
        )
    if slip := asked.cause(came, place):
        return slip
    if came[place] == (INFO,):
        return WARNINGS_STOP if (WARN,) in came[:place] else None
    return Cause(
        'warns_too_often',
        f'{place + 1} cannot be divided by {EVERY}, and yet watch {place + 1} is a warning.',
        'Warn if number % 5 == 0, with the number in the line.',
    )


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
        asks={'levels': Specification(range(1, seconds + 1), fifths(), SLIPS)},
    )
    exam.check(points=2, read='Part 3: Names and worlds')(starts_in_the_namespace)
    exam.check(points=3, needs=['starts_in_the_namespace'], read=EXERCISE)(reports_every_second)
    exam.check(points=2, needs=['starts_in_the_namespace'], read=EXERCISE)(lines_are_numbered)
    exam.check(points=3, needs=['starts_in_the_namespace'])(every_fifth_is_a_warning)
    return exam


exam = build(seconds=21, namespace='/north')

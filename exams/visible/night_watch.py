"""
Lesson 01, second exercise: a node that logs, in a namespace from the command line.

Specification from the lesson: node ``night_watch``; one line per second with the number of the
watch, from 1; level INFO, and WARN for every fifth; the node's own logger; no namespace in the
code.
"""

from collections.abc import Sequence

from autograder.exam.exam import Cause, Exam, Failed, Run, Scenario
from autograder.exam.specification import each, Rule, Specification
from autograder.exam.steps import Advance, get_parameters, Mark
from autograder.exam.words import Causes
from autograder.judging.causes.missing_logs import CALLS, why_left_out, why_not_logged
from autograder.judging.causes.text_table import cause_of, why_by_code
from autograder.judging.checks import own_logs
from autograder.judging.claims import node
from autograder.judging.numbers import whole_numbers_in, why_not_numbered
from autograder.judging.rhythm import GRAIN_S, require_period, seconds_between
from autograder.recording import Event, INFO, LEVELS, SECOND, WARN
from autograder.results import shortened
from exams.visible.harbour import WATCH

EVERY = 5
GUEST_S = 0.2  # duration of a request [s]
EXERCISE = 'Exercise 2: the night watch'
Levels = tuple[int, ...]
"""Levels of the lines of one watch; one line is expected."""

WHY = Causes(__file__, EVERY=EVERY)


def fifths(
    every: int = EVERY, rest: int = 0, warned: Levels = (WARN,), other: Levels = (INFO,)
) -> Rule:
    """
    Return the rule of a node that logs watches with one remainder differently from the others.

    :param rest: remainder of these watches modulo ``every``
    :param warned: levels of the lines for one of these watches
    :param other: levels of the lines for any other watch
    """
    return each(lambda number: warned if number % every == rest else other)


def late(numbers: Sequence[int]) -> list[Levels]:
    """Return the levels of a node that warns one watch after every fifth."""
    return [(WARN,) if number % EVERY == 1 < number else (INFO,) for number in numbers]


OTHERWISE = {
    'every watch': fifths(1),
    **{f'every multiple of {every}': fifths(every) for every in (2, 3, 4, 6, 10)},
    'every number that ends in 5': fifths(10, rest=5),
}
"""Rules of nodes that warn at other watches, by a description of these watches."""
ONLY_FIFTHS = WHY.slip('only_fifths', fifths(rest=1, other=()))
FIFTH_MISSING = WHY.slip('fifth_missing', fifths(warned=()))
SLIPS = (
    ONLY_FIFTHS,
    FIFTH_MISSING,
    WHY.slip('both_levels', fifths(warned=(INFO, WARN))),
    WHY.slip('no_warning', fifths(warned=(INFO,))),
    WHY.slip('inverted', fifths(warned=(INFO,), other=(WARN,))),
    WHY.slip('warns_one_early', fifths(rest=EVERY - 1)),
    WHY.slip('warns_one_late', fifths(rest=1), late),
    WHY.slip('only_five', each(lambda number: (WARN,) if number == EVERY else (INFO,))),
    *(WHY.slip('warns_otherwise', rule, which=which) for which, rule in OTHERWISE.items()),
)


def reports(run: Run) -> list[Event]:
    """Return the lines of the node's own logger, at any level, in the phase that is judged."""
    return own_logs(run.during(WATCH), run.facts['node'])


def watches(run: Run) -> list[Event]:
    """Return the lines from watch 1 on; the first lines may precede the phase that is judged."""
    said, found = own_logs(run, run.facts['node']), reports(run)
    until_first = said[: len(said) - len(found) + 1]
    ones = [n for n, entry in enumerate(until_first) if 1 in whole_numbers_in(entry['text'])]
    return said[ones[-1] :] if ones else found


def levels_by_second(found: Sequence[Event]) -> list[Levels]:
    """Return the levels of the lines in each second, empty if a line is not at a full second."""
    rows: dict[int, list[int]] = {}
    for entry in found:
        seconds = (entry['clock_ns'] - found[0]['clock_ns']) / SECOND
        if abs(seconds - round(seconds)) > GRAIN_S * max(1, round(seconds)):
            return []
        rows.setdefault(round(seconds), []).append(entry['level'])
    return [tuple(sorted(rows.get(place, ()))) for place in range(max(rows, default=-1) + 1)]


def reports_every_second(run: Run) -> None:
    """It logs one line a second, with its own logger."""
    found = reports(run)
    waited_s = seconds_between(run.recording.of('seen'), own_logs(run, run.facts['node']))
    why, seconds = lambda: _why_not_every_second(run, found), run.facts['seconds']
    require_period(run, found, 1.0, seconds, 'line', why, waited_s=waited_s)


def _why_not_every_second(run: Run, found: Sequence[Event]) -> Cause | None:
    if not found:
        timer = 'self.create_timer(1.0, self.report)'
        why = why_not_logged(run, found, INFO, _has_another)
        return why or why_by_code('no_line', run, call=timer)
    few = len(found) < run.facts['seconds']
    left_out = why_left_out(run, INFO) or why_left_out(run, WARN) if few else None
    return left_out or _why_other_lines(run)


def _why_other_lines(run: Run) -> Cause | None:
    """Explain seconds with a wrong line, several lines or no line."""
    asked = run.asked('levels')
    rows = levels_by_second(watches(run))[: len(asked.inputs)]
    slip = asked.cause(rows)
    if slip is ONLY_FIFTHS:
        return why_not_logged(run, [], INFO, _has_another) or slip
    if slip is FIFTH_MISSING:
        why = why_not_logged(
            run, [], WARN, lambda text: any(n and n % EVERY == 0 for n in whole_numbers_in(text))
        )
        return why or slip
    return slip


def _has_another(text: str) -> bool:
    return any(number % EVERY for number in whole_numbers_in(text))


def lines_are_numbered(run: Run) -> None:
    """The lines contain the number of the watch: 1, 2, 3, and so on."""
    found = _enough(run)
    texts = [str(entry['text']) for entry in found]
    for place, text in enumerate(texts):
        if place + 1 not in whole_numbers_in(text):
            raise Failed(
                expected=f'the number {place + 1} in line {place + 1}',
                observed=repr(shortened(text)),
                why=_why_shifted(run) or why_not_numbered(texts, place),
                shown_by=[found[place]],
            )
    first = [entry for entry in own_logs(run, run.facts['node']) if entry['text'] == texts[0]]
    if len(first) > 1:
        raise WHY.failed('first_twice', line=first[0]['line'], count=len(first))


def _why_shifted(run: Run) -> Cause | None:
    """Explain watches with two lines or no line, which shift all later ones."""
    one_line = all(len(row) == 1 for row in levels_by_second(watches(run)))
    return None if one_line else _why_other_lines(run)


def every_fifth_is_a_warning(run: Run) -> None:
    """Every fifth line is a WARN, and all others are INFO."""
    found, asked = _enough(run), run.asked('levels')
    came = [(entry['level'],) for entry in found[: len(asked.inputs)]]
    for place in asked.wrong(came)[:1]:
        level = found[place]['level']
        raise Failed(
            expected=f'level {LEVELS[asked.answers[place][0]]} for watch {place + 1}',
            observed=f'level {LEVELS.get(level, level)} for watch {place + 1}',
            why=_why_shifted(run) or _why_level(asked, found, came, place),
        )


def _why_level(
    asked: Specification, found: Sequence[Event], came: Sequence[Levels], place: int
) -> Cause | None:
    numbers = [whole_numbers_in(entry['text']) for entry in found]
    miscounted = any(place + 1 not in one for place, one in enumerate(numbers))
    if miscounted and all(
        (entry['level'] == WARN) == any(number % EVERY == 0 for number in seen)
        for entry, seen in zip(found, numbers)
    ):
        return WHY['follows_number']
    if came[place][0] not in (INFO, WARN):
        level, line = LEVELS.get(came[place][0], ''), found[place].get('line')
        return cause_of('wrong_level', other=level, call=CALLS[asked.answers[place][0]], line=line)
    if slip := asked.cause(came, place):
        return slip
    if came[place] == (INFO,):
        return WHY['warnings_stop'] if (WARN,) in came[:place] else None
    return WHY.of('warns_too_often', watch=place + 1)


def _enough(run: Run) -> list[Event]:
    """Return the lines; fail if there are too few for two warnings."""
    found = watches(run)
    if len(found) < 2 * EVERY:
        reports_every_second(run)  # fails with an explanation
    return found


def build(seconds: int, namespace: str) -> Exam:
    """
    Return the exam for a given duration.

    :param seconds: duration of the phase that is judged [s], >= 4 * EVERY
    :param namespace: set on the command line, such as ``/harbour``
    """
    name = f'{namespace}/night_watch'
    asked = get_parameters(name, patience_s=GUEST_S)
    exam = Exam(
        'night_watch',
        title='The night watch',
        assignment='01_node_life',
        part=2,
        scenario=Scenario(
            file='night_watch.py',
            arguments=('-r', f'__ns:={namespace}'),
            # A request ends the pause of a loop around spin_once().
            steps=(Mark(WATCH), Advance(seconds / 2), asked, Advance(seconds / 2 - GUEST_S)),
        ),
        read='Part 4: Logging',
        facts={'seconds': seconds, 'node': name},
        asks={'levels': Specification(range(1, seconds + 1), fifths(), SLIPS)},
    )
    needs = ['starts_in_the_namespace']
    exam.check(points=2, read='Part 3: Names and worlds')(
        node(
            name,
            'starts_in_the_namespace',
            'Your node is called night_watch, and its namespace is the one chosen at its start.',
            only_named=True,
        )
    )
    exam.check(points=3, needs=needs, read=EXERCISE)(reports_every_second)
    exam.check(points=2, needs=needs, read=EXERCISE)(lines_are_numbered)
    exam.check(points=3, needs=needs)(every_fifth_is_a_warning)
    return exam


exam = build(seconds=21, namespace='/north')

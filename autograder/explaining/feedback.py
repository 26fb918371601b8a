"""
Convert results to text; the text of every check comes from this module.

Visible checks in a notebook, nbgrader's feedback, formgrader, the report of a class and the
terminal all use this text.  A failed check takes at most twelve lines.  Parts of the text come
from student code, so control characters are replaced: a terminal or a log viewer would interpret
them.
"""

from collections.abc import Iterable
from dataclasses import replace
import textwrap

from autograder.results import (
    CheckResult,
    ExamResult,
    Problem,
    shortened,
    SubmissionResult,
    Verdict,
)

FOR_REVIEW = (
    'For review: the grader itself failed, so there is no score yet. '
    'A person will look at it; you lose no points.'
)
UNUSABLE = (
    'For review: the grader could not read any part of this assignment in your file, so there is '
    'no score yet. A person will look at it.'
)
WIDTH = 88
"""Maximum line length; a terminal has 80 to 120 columns, a notebook's output about 100."""

MOST_LINES = 12
"""Maximum number of lines about one check, including its title."""

NO_ANSWER = ('missing_file', 'not_answered')
"""Causes for which a problem with the notebook's cells is a better explanation."""

SIGNS = {Verdict.PASSED: '[pass]', Verdict.FAILED: '[FAIL]', Verdict.NOT_RUN: '[ -- ]'}
_INDENT = ' ' * 7
_CUT = ' \N{HORIZONTAL ELLIPSIS}'
_TOGETHER = '\N{NO-BREAK SPACE}'


def printable(text: str) -> str:
    """Replace every control character except line ends and tabs."""
    if text.isprintable():
        return text
    return ''.join(
        char if char in '\n\t' or char.isprintable() else '\N{REPLACEMENT CHARACTER}'
        for char in text
    )


def number(points: float) -> str:
    """Return points as text, with at most two decimals and no trailing zeros."""
    return f'{round(points, 2):g}'


def points_of(result: CheckResult | ExamResult | SubmissionResult) -> str:
    """Return the points of a check, an exam or a submission as text, such as ``2 of 3``."""
    return f'{number(result.points)} of {number(result.max_points)}'


def causes_once(result: ExamResult) -> tuple[CheckResult, ...]:
    """
    Return the checks of an exam as learners read them, with titles in place of names of checks.

    A repeated cause is replaced with a reference to its first check.  The advice is kept, unless
    an earlier check has the same cause and the same advice.
    """
    titles = {check.check: check.title for check in result.checks}
    first: dict[str, CheckResult] = {}
    repairs: set[tuple[str, str]] = set()
    checks = []
    for check in result.checks:
        check = replace(check, waits_for=titles.get(check.waits_for, check.waits_for))
        if check.verdict is Verdict.FAILED and check.cause:
            before = first.setdefault(check.cause, check)
            repair = (check.cause, check.try_this)
            if before is not check:
                try_this = '' if repair in repairs else check.try_this
                reference = f'the same as above, for: {before.title}'
                check = replace(check, cause=reference, try_this=try_this)
            repairs.add(repair)
        checks.append(check)
    return tuple(checks)


# -- one check -------------------------------------------------------------------------------


def feedback_items(check: CheckResult) -> list[tuple[str, str]]:
    """
    Return the feedback items of a check as pairs of name and text, in order.

    Long items are shortened so that the whole check fits in :data:`MOST_LINES`.

    :param check: from :func:`causes_once`; a passed check has no items
    """
    facts = check.facts if check.verdict is Verdict.FAILED else {}
    if check.verdict is Verdict.NOT_RUN:
        facts = {'waits for': check.waits_for}
    texts = {name: one for name, text in facts.items() if (one := _one_line(text))}
    room = {name: len(_wrapped(name, text)) for name, text in texts.items()}
    while len(_title_lines(check)) + sum(room.values()) > MOST_LINES:
        room[max(room, key=lambda name: room[name])] -= 1
    return [(name, _shortened(name, text, room[name])) for name, text in texts.items()]


def _one_line(text: str) -> str:
    """Return a text as one line; spaces within its lines stay, as they may be the mistake."""
    return ' '.join(filter(None, map(str.strip, printable(text).splitlines())))


def _wrapped(name: str, text: str, most: int | None = None) -> list[str]:
    return _wrap(f'{_INDENT}{name}: {text}', f'{_INDENT}    ', most)


def _wrap(text: str, indent: str, most: int | None = None) -> list[str]:
    """Return the lines of a text; all but the first are indented."""
    return textwrap.wrap(
        text,
        WIDTH,
        subsequent_indent=indent,
        break_on_hyphens=False,
        max_lines=most,
        placeholder=_CUT,
    )


def _shortened(name: str, text: str, most: int) -> str:
    """Return a text shortened to a number of lines, or unchanged if it fits."""
    if len(_wrapped(name, text)) <= most:
        return text
    cut = ' '.join(line.strip() for line in _wrapped(name, text, most))
    return cut.partition(': ')[2]


def _title_lines(check: CheckResult) -> list[str]:
    points = f'({points_of(check)})'.replace(' ', _TOGETHER)
    lines = _wrap(f'{SIGNS[check.verdict]} {_one_line(check.title)} {points}', _INDENT, 3)
    return [line.replace(_TOGETHER, ' ') for line in lines]


def check_lines(check: CheckResult) -> list[str]:
    """Return everything about one check of :func:`causes_once`, as lines of plain text."""
    items = (_wrapped(name, text) for name, text in feedback_items(check))
    return [*_title_lines(check), *(line for lines in items for line in lines)]


# -- an exam, a submission ------------------------------------------------------------------


def remarks(result: ExamResult, problems: Iterable[Problem]) -> list[str]:
    """Return the notes about a result that do not belong to a check, one sentence each."""
    found = [f'Note: {problem.line()}' for problem in problems]
    if result.note:
        found.append(f'Note: {result.note}')
    if result.not_protected:
        found.append(f'Note: run with weak isolation ({result.mode}).')
    return [_one_line(remark) for remark in found]


def exam_text(result: ExamResult, problems: Iterable[Problem] = ()) -> str:
    """Return the result of one exam for a learner, as plain text."""
    lines = [f'{points_of(result)} points']
    for remark in remarks(result, problems):
        lines += _wrap(remark, '  ')
    for check in causes_once(result):
        lines += ['', *check_lines(check)]
    return printable('\n'.join(lines)) + '\n'


def review_text(result: SubmissionResult) -> str:
    """Return the feedback on a submission without a score."""
    if result.fault:
        return f'{FOR_REVIEW}\n'
    note = _one_line(f'Note: {result.unusable}')
    return '\n'.join([*_wrap(UNUSABLE, '  '), *_wrap(note, '  '), ''])


def headline(result: SubmissionResult) -> str:
    """
    Return the cause that costs the most points, with the observation; empty if there is none.

    A problem that costs no points, such as a wrong file name, is returned only if no check failed.
    """
    if result.review:
        return printable(result.review)
    check = _most_expensive(result)
    absent = {one.cause_id for exam in result.exams for one in exam.failed} & set(NO_ANSWER)
    if check is None or check.cause_id in NO_ANSWER or not absent:
        for problem in result.problems:
            if problem.cells:
                return printable(problem.line())
    if check is not None:
        return printable(_with_observed(check))
    return printable(result.problems[0].line()) if result.problems else ''


def _most_expensive(result: SubmissionResult) -> CheckResult | None:
    """
    Return the first check that failed for the cause that costs the most points.

    A cause also costs the points of all checks that depend on the failed check.
    """
    cost: dict[tuple[str, str], float] = {}
    first: dict[tuple[str, str], CheckResult] = {}
    for exam in result.exams:
        failed: dict[str, CheckResult] = {}  # the check that failed, by check that loses points
        for check in exam.checks:
            why = check if check.verdict is Verdict.FAILED else failed.get(check.waits_for)
            if why is not None:
                failed[check.check] = why
                key = (why.cause_id, why.cause) if why.cause else (exam.exam, why.check)
                first.setdefault(key, why)
                cost[key] = cost.get(key, 0.0) + check.max_points - check.points
    return first[max(cost, key=lambda key: cost[key])] if cost else None


def _with_observed(check: CheckResult) -> str:
    """Return the cause of a failure, and the observation unless the cause contains it."""
    seen = _one_line(check.observed)
    if not check.cause:
        return seen or check.title
    return check.cause if seen in check.cause else f'{check.cause} (observed: {shortened(seen)})'

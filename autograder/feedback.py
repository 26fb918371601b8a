"""
Results in words: the plain text that goes into a notebook's check cell and on a terminal.

Parts of it were written by the student's code, so control characters are taken out: a terminal
and a log viewer act on them.
"""

from __future__ import annotations

from collections.abc import Iterable

from autograder.results import CheckResult, ExamResult, Problem, SubmissionResult, Verdict

FOR_REVIEW = (
    'For review: the grader itself could not finish, so there is no score yet. '
    'A person will look at it; it costs no points.'
)
_SIGN = {Verdict.PASSED: '[pass]', Verdict.FAILED: '[FAIL]', Verdict.NOT_RUN: '[ -- ]'}


def printable(text: str) -> str:
    """Replace everything a terminal would act on, except line ends and tabs."""
    return ''.join(
        char if char in '\n\t' or char.isprintable() else '\N{REPLACEMENT CHARACTER}'
        for char in text
    )


def number(points: float) -> str:
    """Return points without needless digits."""
    return f'{round(points, 2):g}'


def exam_text(result: ExamResult, problems: Iterable[Problem] = ()) -> str:
    """
    Return what a learner is told about one exam.

    :param problems: what is wrong with the notebook cells of this exam
    """
    lines = [f'{number(result.points)} of {number(result.max_points)} points']
    lines += [f'Note: {problem.line()}' for problem in problems]
    if result.note:
        lines.append(f'Note: {result.note}')
    if result.not_protected:
        lines.append(f'Note: run with weak isolation ({result.mode}).')
    titles = {check.check: check.title for check in result.checks}
    for check in result.checks:
        lines.append('')
        lines += _check_lines(check, titles.get(check.waits_for, check.waits_for))
    return printable('\n'.join(lines)) + '\n'


def _check_lines(check: CheckResult, waits_for: str) -> list[str]:
    """Return the lines about one check."""
    points = f'({number(check.points)} of {number(check.max_points)})'
    lines = [f'{_SIGN[check.verdict]} {check.title} {points}']
    if check.verdict is Verdict.NOT_RUN:
        return [*lines, f'       not looked at, waits for: {waits_for}']
    if check.verdict is Verdict.PASSED:
        return lines
    facts = {
        'expected': check.expected,
        'observed': check.observed,
        'likely cause': check.cause,
        'try': check.try_this,
        'read': check.read,
    }
    for name, value in facts.items():
        if value:
            lines.append(f'       {name}: {value}'.replace('\n', '\n         '))
    return lines


def headline(result: SubmissionResult) -> str:
    """
    Return the one line that says why points are missing, empty if none are.

    Problems that cost nothing (a note about a file name) come last.
    """
    if result.fault:
        return printable(result.fault)
    for problem in result.problems:
        if problem.cells:
            return printable(problem.line())
    for exam in result.exams:
        for check in exam.failed:
            return printable(check.cause or check.observed or check.title)
    return printable(result.problems[0].line()) if result.problems else ''

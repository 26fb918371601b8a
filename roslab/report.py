"""The result of visible checks as a table, in HTML and in plain text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
import html

from autograder.results import CheckResult, ExamResult, Problem, Verdict
from roslab.output import current_cell, show

_MARKS = {Verdict.PASSED: '\N{CHECK MARK}', Verdict.FAILED: '\N{BALLOT X}', Verdict.NOT_RUN: '-'}
_COLOURS = {Verdict.PASSED: '#388e3c', Verdict.FAILED: '#c0392b', Verdict.NOT_RUN: '#777777'}
_WORDS = {Verdict.PASSED: 'passed', Verdict.FAILED: 'failed', Verdict.NOT_RUN: 'not run'}
_MISSING_FILE = 'missing_file'
_RUN_FIRST = 'A cell is saved when it runs: run the cell of the exercise before its check.'
_NO_SANDBOX = (
    'Your code ran in a plain process without a sandbox, which is fine for your own code.'
)


@dataclass
class CheckReport:
    """
    What the visible checks of one exercise found.

    :param exam: name of the exercise
    :param result: the verdicts, None if there are none
    :param problem: why there are none
    :param unfinished: files that still have their stub
    """

    exam: str
    result: ExamResult | None = None
    problem: Problem | None = None
    unfinished: tuple[str, ...] = ()
    _shown_in: int | None = field(default=None, repr=False, compare=False)

    def __bool__(self) -> bool:
        """Tell whether every check passed."""
        checks = self.result.checks if self.result else ()
        return bool(checks) and all(check.verdict is Verdict.PASSED for check in checks)

    @property
    def points(self) -> float:
        """Points of the visible checks."""
        return self.result.points if self.result else 0.0

    @property
    def max_points(self) -> float:
        """Points that the visible checks could give."""
        return self.result.max_points if self.result else 0.0

    def show(self) -> None:
        """Show the report in the running cell."""
        cell = current_cell()
        self._shown_in = cell.number if cell else None
        show(str(self), self._repr_html_())

    def _ipython_display_(self) -> None:
        """Show it as the value of a later cell; the cell that made it has shown it."""
        cell = current_cell()
        if cell is None or cell.number != self._shown_in:
            self.show()

    @property
    def _headline(self) -> str:
        if self.result is None:
            return f'{self.exam}: not checked'
        return f'{self.exam}: {self.points:g} of {self.max_points:g} points in the visible checks'

    @property
    def _titles(self) -> dict[str, str]:
        return {check.check: check.title for check in self.result.checks} if self.result else {}

    @property
    def _remarks(self) -> list[str]:
        """Return what there is to say beside the checks."""
        remarks = [
            f'{name} is not finished: it still has YOUR CODE HERE.' for name in self.unfinished
        ]
        if self.problem is not None:
            remarks.append(self.problem.line())
        if self.result is not None:
            remarks.extend(text for text in (self.result.note,) if text)
            if any(check.cause_id == _MISSING_FILE for check in self.result.checks):
                remarks.append(_RUN_FIRST)
            if self.result.mode == 'none':
                remarks.append(_NO_SANDBOX)
        return remarks

    def __str__(self) -> str:
        checks = self.result.checks if self.result else ()
        lines = [self._headline, *(f'  {remark}' for remark in self._remarks)]
        for check in checks:
            score = f'{check.points:g}/{check.max_points:g}'
            lines.append(f'  {_MARKS[check.verdict]} {score:>5}  {check.title}')
            lines.extend(f'           {name}: {text}' for name, text in facts(check, self._titles))
        return '\n'.join(lines)

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        checks = self.result.checks if self.result else ()
        remarks = ''.join(f'<p>{html.escape(remark)}</p>' for remark in self._remarks)
        rows = ''.join(_row(check, facts(check, self._titles)) for check in checks)
        head = ''.join(
            f'<th scope="col" style="text-align: left">{name}</th>'
            for name in ('result', 'check', 'points')
        )
        table = f'<table><tr>{head}</tr>{rows}</table>' if rows else ''
        return f'<div><strong>{html.escape(self._headline)}</strong>{remarks}{table}</div>'


def facts(check: CheckResult, titles: Mapping[str, str]) -> list[tuple[str, str]]:
    """
    Return what a learner is told about a check that did not pass, by name.

    :param check: any result; a passed check has nothing to tell
    :param titles: of all checks, by their names
    """
    if check.verdict is Verdict.PASSED:
        return []
    if check.verdict is Verdict.NOT_RUN and check.waits_for:
        return [('waits for', titles.get(check.waits_for, check.waits_for))]
    told = (
        ('expected', check.expected),
        ('observed', check.observed),
        ('likely cause', check.cause),
        ('try', check.try_this),
        ('read', check.read),
    )
    return [(name, text) for name, text in told if text]


def _row(check: CheckResult, facts: Sequence[tuple[str, str]]) -> str:
    told = ''.join(f'<br><em>{name}:</em> {html.escape(text)}' for name, text in facts)
    return (
        f'<tr><td style="color: {_COLOURS[check.verdict]}; font-size: 120%; text-align: left" '
        f'aria-label="{_WORDS[check.verdict]}" title="{_WORDS[check.verdict]}">'
        f'{_MARKS[check.verdict]}</td>'
        f'<td style="text-align: left">{html.escape(check.title)}{told}</td>'
        f'<td>{check.points:g} of {check.max_points:g}</td></tr>'
    )

"""Show the result of visible checks as HTML and plain text, in the grader's own words."""

from dataclasses import dataclass, field
import html
import textwrap

from autograder.explaining.feedback import causes_once, check_lines, number, WIDTH
from autograder.explaining.feedback_html import checks_html, Lessons, paragraph
from autograder.results import ExamResult, Problem, Verdict
from roslab.output import current_cell, show

_NO_SANDBOX = (
    'Your code ran in a plain process without a sandbox, which is fine for your own code.'
)


@dataclass
class CheckReport:
    """
    The result of the visible checks of one exercise.

    :param result: the verdicts, None if the exercise could not be judged
    :param unfinished: files that still contain a stub
    :param judged: one line that names the judged files and the cells that saved them
    :param edited: files whose cell was edited after the file was saved
    :param left_over: files that no cell of the notebook saves now
    :param lessons: addresses of the lessons' notebooks by their numbers, for links to sections
    :param worked: the line about the worked answer, as text and as HTML
    """

    exam: str
    result: ExamResult | None = None
    problem: Problem | None = None
    unfinished: tuple[str, ...] = ()
    judged: str = ''
    edited: tuple[str, ...] = ()
    left_over: tuple[str, ...] = ()
    lessons: Lessons = field(default_factory=dict)
    worked: tuple[str, str] = ('', '')
    _shown_in: int | None = field(default=None, repr=False, compare=False)

    def __bool__(self) -> bool:
        """Return whether every check passed."""
        checks = self.result.checks if self.result else ()
        return bool(checks) and all(check.verdict is Verdict.PASSED for check in checks)

    @property
    def points(self) -> float:
        """The points reached in the visible checks."""
        return self.result.points if self.result else 0.0

    @property
    def max_points(self) -> float:
        """The maximum number of points of the visible checks."""
        return self.result.max_points if self.result else 0.0

    def show(self) -> None:
        """Show the report in the running cell."""
        cell = current_cell()
        self._shown_in = cell.number if cell else None
        show(str(self), self._repr_html_())

    def _ipython_display_(self) -> None:
        """Show the report as the value of a later cell; the cell of the check already shows it."""
        cell = current_cell()
        if cell is None or cell.number != self._shown_in:
            self.show()

    @property
    def _headline(self) -> str:
        if self.result is None:
            return f'{self.exam}: not checked'
        points = f'{number(self.points)} of {number(self.max_points)} points'
        return f'{self.exam}: {points} in the visible checks'

    @property
    def _remarks(self) -> list[str]:
        """Return the lines to print below the checks."""
        remarks = [f'Judged: {self.judged}.'] if self.judged else []
        remarks += [
            f'{name} is older than its cell: the cell was edited, but not run. Run it, then check '
            'again.'
            for name in self.edited
        ]
        remarks += [
            f'{name} is not finished: it still has YOUR CODE HERE.' for name in self.unfinished
        ]
        remarks += [
            f'{name} is left over: no cell saves it any more, and you hand in only cells. '
            "Did you change the first line of its cell, the one with %% and the file's name?"
            for name in self.left_over
        ]
        if self.problem is not None:
            remarks.append(self.problem.line())
        if self.result is not None:
            remarks += [self.result.note] if self.result.note else []
            if self.result.mode == 'none':
                remarks.append(_NO_SANDBOX)
        return remarks

    def __repr__(self) -> str:
        lines = [self._headline]
        for remark in self._remarks:
            lines += textwrap.wrap(remark, WIDTH, initial_indent='  ', subsequent_indent='  ')
        if self.result is not None:
            for check in causes_once(self.result):
                lines += check_lines(check)
        lines += ['', self.worked[0]] if self.worked[0] else []
        return '\n'.join(lines)

    def _repr_html_(self) -> str:
        remarks = ''.join(paragraph(remark) for remark in self._remarks)
        checks = checks_html(self.result, self.lessons) if self.result else ''
        head = f'<strong>{html.escape(self._headline)}</strong>'
        return f'<div>{head}{remarks}{checks}{self.worked[1]}</div>'

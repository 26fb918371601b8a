"""
Run visible checks, the grader's own engine on the learner's saved files, and show the result.

The learner's code does not run in the kernel.  A child process runs it, in a sandbox if one is
available, and prints its verdicts as one line of JSON.
"""

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
import difflib
import html
import json
import os
from pathlib import Path
import re
import textwrap
from typing import Any
from urllib.parse import quote

from IPython import get_ipython

from autograder.errors import ExamInvalid
from autograder.exam import catalog
from autograder.exam.exam import Exam
from autograder.explaining.feedback import causes_once, check_lines, number, WIDTH
from autograder.explaining.feedback_html import checks_html, Lessons, paragraph
from autograder.layout import Layout, lesson_files
from autograder.results import ExamResult, Problem, Verdict
from autograder.submission.cells import magic_line, UNSOLVED
from autograder.submission.package import with_missing_file
from roslab import run_command
from roslab.error_hints import saved_file, texts_now
from roslab.errors import RoslabError, shown_as
from roslab.output import current_cell, show
from roslab.package_files import describe, edited_since, learner_package, LearnerPackage, look_up
from roslab.progress import offer, remember

_DEADLINE_S = 180.0
_CHECKER = 'the checker itself, not your code'
_CHECKED = re.compile(r"""\bcheck\(['"](\w+)['"]\)""")

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


def check(exam: Any = None) -> CheckReport:
    """
    Run the visible checks of an exercise and show the result.

    :param exam: name of the exercise, such as 'temperature_publisher'; for an unknown name, the
        report lists the valid names
    :returns: the report, which is true if every check passed
    :raises RoslabError: if a check failed, but only under nbgrader's Validate
    """
    report = _run(exam, learner_package())
    if report.result is not None:
        remember('checks', report.exam, report.points, tries=not report.unfinished)
        report.worked = offer(report.exam)
    report.show()
    if os.environ.get('NBGRADER_EXECUTION') == 'validate' and not report:
        raise shown_as(RoslabError(str(report)), str(report))
    return report


def _run(exam: Any, package: LearnerPackage) -> CheckReport:
    if not isinstance(exam, str):
        return _ask_for_name(exam)
    try:
        about = catalog.load(exam, hidden=False)
    except ExamInvalid as error:
        return _unknown_exam(exam, error)
    files = package.files() if package.folder.is_dir() else {}
    if not files:
        return _not_checked(
            exam,
            'saved files of the exercise',
            'none',
            'first run the cells of the exercise that begin with %%',
        )
    own = _of_exercise(about, files)
    saved = look_up(package.find(name) for name in own)
    outcome = run_command.run_grader(
        'autograder.commands.check',
        *(exam, '--files', str(package.folder), '--visible', '--json'),
        text=f'Checking {exam}',
        deadline_s=_DEADLINE_S,
    )
    report = _read(exam, outcome)
    if report.result is not None:
        missing = [name for name in about.requires if name not in files]
        report.result = _with_cells(report.result, missing, package.shown(package.folder))
    report.judged, report.edited = describe(saved), tuple(edited_since(saved))
    report.unfinished = tuple(name for name, text in own.items() if _is_stub(name, text))
    report.left_over = _left_over(own)
    with suppress(FileNotFoundError):
        report.lessons = _addresses(about.assignment)
    return report


def _with_cells(result: ExamResult, missing: Sequence[str], folder: str) -> ExamResult:
    """Return a result whose message about missing files names the cells that save them."""
    lines = [line for line in map(magic_line, missing) if line]
    if not lines:
        return result
    cells = 'cells of the exercise that begin' if lines[1:] else 'cell of the exercise that begins'
    return with_missing_file(
        result,
        observed=f'not saved in {folder}',
        try_this=f'Run the {cells} with {" and ".join(lines)}, then check again.',
    )


def _addresses(assignment: str) -> dict[str, str]:
    """Return the addresses of all lessons by number, relative to a lesson that must exist."""
    own = Layout.here().release(assignment)
    found = {path.parent.name.partition('_')[0]: path for path in lesson_files(own.parents[1])}
    addresses = {
        number: quote(os.path.relpath(path, own.parent)) for number, path in found.items()
    }
    return {**addresses, '': quote(own.name)}


def _not_checked(
    exam: str, expected: str, got: str, try_this: str, where: str | None = None
) -> CheckReport:
    """Return a report without verdicts; the problem is in the call unless ``where`` is given."""
    place = where or f'check({exam!r})'
    return CheckReport(exam, problem=Problem(place, expected, got, try_this))


def _ask_for_name(given: Any) -> CheckReport:
    """Explain that ``check`` needs the name of an exercise, and suggest one."""
    meant = _exercise_of(given)
    names = [meant] if meant else _exercises_here() or catalog.names(hidden=False)
    got = 'nothing' if given is None else f'a {type(given).__name__}'
    shown = '' if given is None else getattr(given, '__name__', f'{type(given).__name__} object')
    return _not_checked(
        'check()',
        'the name of an exercise, in quotes',
        'the class itself' if isinstance(given, type) else got,
        ' or '.join(f'check({name!r})' for name in names),
        f'check({shown})',
    )


def _exercise_of(given: Any) -> str | None:
    """Return the exercise that requires the file of a class, a function or an object's class."""
    module = getattr(given, '__module__', None) or getattr(given, '__name__', '')
    for name in catalog.names(hidden=False):
        requires = catalog.load(name, hidden=False).requires
        if f'{module}.py' in (Path(path).name for path in requires):
            return name
    return None


def _texts() -> list[str]:
    shell = get_ipython()
    return texts_now(shell) if shell is not None else []


def _exercises_here() -> list[str]:
    """Return the exercises for which the notebook contains a ``check`` call."""
    known = catalog.names(hidden=False)
    named = (name for text in _texts() for name in _CHECKED.findall(text))
    return [name for name in dict.fromkeys(named) if name in known]


def _unknown_exam(exam: str, error: ExamInvalid) -> CheckReport:
    names = catalog.names(hidden=False)
    if exam in names:
        got = error.what.rstrip('.')
        return _not_checked(exam, 'an exam', got, 'show this line to your instructor', _CHECKER)
    near = difflib.get_close_matches(exam, names, n=1)
    try_this = f'check({near[0]!r})' if near else error.fix
    return _not_checked(exam, 'the name of an exercise', f'{exam!r}', try_this)


def _of_exercise(exam: Exam, files: Mapping[str, str]) -> dict[str, str]:
    """Return the files that an exercise requires."""
    required = {Path(path).name for path in exam.requires}
    return {name: text for name, text in files.items() if Path(name).name in required}


def _is_stub(name: str, text: str) -> bool:
    return UNSOLVED in text and (not name.endswith('.py') or 'NotImplementedError' in text)


def _left_over(files: Collection[str]) -> tuple[str, ...]:
    """Return the files that no cell of the notebook saves now, for example after a rename."""
    texts = _texts()
    made = {Path(file.path).name for file in map(saved_file, texts) if file is not None}
    return tuple(name for name in files if texts and Path(name).name not in made)


def _read(exam: str, outcome: run_command.Outcome) -> CheckReport:
    """Read the last line of the child's output; report anything else as a fault of the checker."""
    answer = _last_json(outcome.output)
    try:
        if 'error' in answer:
            return CheckReport(exam, problem=Problem.from_json(answer['error']))
        return CheckReport(exam, ExamResult.from_json(answer))
    except (KeyError, TypeError, ValueError):
        pass
    if outcome.returncode is None:
        got = f'no answer within {_DEADLINE_S:.0f} s'
    else:
        lines = [line.strip() for line in outcome.output.splitlines() if line.strip()]
        last = lines[-1][:300] if lines else 'it printed nothing'
        got = f'exit code {outcome.returncode} and no verdict: {last}'
    try_this = 'run the cell again; if the problem remains, type make doctor in a terminal'
    return _not_checked(exam, 'a verdict', got, try_this, _CHECKER)


def _last_json(output: str) -> dict[str, Any]:
    lines = [line for line in output.splitlines() if line.startswith('{')]
    try:
        answer = json.loads(lines[-1]) if lines else {}
    except ValueError:
        return {}
    return answer if isinstance(answer, dict) else {}

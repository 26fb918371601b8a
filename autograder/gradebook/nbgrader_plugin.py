"""
Our parts inside nbgrader's own commands, named in ``nbgrader_config.py``.

nbgrader would run student code and tests in one kernel and believe the outputs.  Instead

* :class:`SubmissionExporter` reads what was handed in, whatever it is, and goes on with the
  release plus the student's answers;
* :class:`GradeOutside` stands where nbgrader executes the notebook: it grades in the sandbox
  and writes each check cell's feedback and score as outputs;
* :class:`SaveGrades` records them, and nothing where there is no score;
* :class:`ClearSolutionsByKind` makes the stubs of a release.

Formgrader, feedback and export then work unchanged.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import bleach
from bleach.css_sanitizer import CSSSanitizer
from nbconvert.exporters import HTMLExporter, NotebookExporter
from nbconvert.filters import markdown2html
from nbformat import from_dict, NotebookNode
from nbformat.v4 import new_output
from nbgrader import utils
from nbgrader.preprocessors import (
    ClearSolutions,
    GetGrades,
    NbGraderPreprocessor,
    SaveAutoGrades,
)
from traitlets import Unicode
from traitlets.utils.importstring import import_item

from autograder.explaining.feedback import exam_text, FOR_REVIEW, printable
from autograder.explaining.feedback_html import exam_html
from autograder.handed_in.cells import CellSyntaxError, parse_cell, UNSOLVED
from autograder.handed_in.extract import CHECK_PREFIX
from autograder.handed_in.submission import open_submission, Opened, read_release
from autograder.judging.results import ExamResult, Problem, SubmissionResult
from autograder.layout import Layout
from autograder.whole_class.inbox import read_file
from autograder.whole_class.pipeline import Engine, grade_opened, Lesson, load_lesson

NO_RESPONSE = 'No response.'  # what nbgrader itself says of an untouched answer
LOST = 'What you wrote here could not be found in what was handed in; a note below says why.'
_STUBS = {
    'node': f'# {UNSOLVED}\nraise NotImplementedError()',
    'rosmsg': f'# {UNSOLVED}',
    'CMakeLists.txt': f'# {UNSOLVED}',
    'package.xml': f'<!-- {UNSOLVED} -->',
    'answer': f"None  # {UNSOLVED}: 'a', 'b', 'c' or 'd' in place of None",
}

_SAFE_TAGS = {
    *bleach.ALLOWED_TAGS,
    *('h1', 'h2', 'h3', 'h4', 'h5', 'h6', 'p', 'div', 'span', 'pre', 'br', 'hr'),
    *('table', 'caption', 'thead', 'tbody', 'tr', 'th', 'td', 'details', 'summary'),
    *('del', 's', 'sub', 'sup', 'dl', 'dt', 'dd'),
}
_SAFE_ATTRIBUTES = {**bleach.ALLOWED_ATTRIBUTES, '*': ['class', 'id']}
# Our pictures, and the style of the words around them: nothing of it loads or runs anything.
_PICTURE_TAGS = {'svg', 'g', 'title', 'desc', 'path', 'line', 'rect', 'text'}
_PICTURE_ATTRIBUTES = [
    *('class', 'id', 'style', 'role', 'aria-labelledby', 'transform', 'd', 'x', 'y'),
    *('x1', 'x2', 'y1', 'y2', 'rx', 'width', 'height', 'viewBox', 'fill', 'fill-opacity'),
    *('stroke', 'stroke-width', 'stroke-opacity', 'stroke-dasharray', 'text-anchor'),
    *('font-family', 'font-size', 'font-style', 'font-weight'),
]
_STYLE = CSSSanitizer(
    allowed_css_properties=[
        *('display', 'grid-template-columns', 'gap', 'margin', 'padding', 'float', 'width'),
        *(
            'max-width',
            'min-width',
            'height',
            'text-align',
            'line-height',
            'font-weight',
            'overflow-x',
        ),
        *('overflow-wrap', 'border-left', 'color'),
    ]
)

Resources = dict[str, Any]
Step = tuple[NotebookNode, Resources]


def safe_html(html: object) -> str:
    """
    Return HTML without scripts, pictures from elsewhere and event handlers.

    nbconvert's own ``clean_html`` also refuses paragraphs, headings and parts of tables, and
    shows their tags as text.
    """
    text = html.decode() if isinstance(html, bytes) else str(html)
    return str(bleach.clean(text, tags=_SAFE_TAGS, attributes=_SAFE_ATTRIBUTES))


def safe_markdown(source: str) -> str:
    """Render a student's Markdown without scripts: instructors open it with their rights."""
    return safe_html(markdown2html(source))


def safe_output(html: object) -> str:
    """Return the HTML of an output: like :func:`safe_html`, and our own pictures."""
    text = html.decode() if isinstance(html, bytes) else str(html)
    return str(
        bleach.clean(
            text,
            tags=_SAFE_TAGS | _PICTURE_TAGS,
            attributes={**bleach.ALLOWED_ATTRIBUTES, '*': _PICTURE_ATTRIBUTES},
            css_sanitizer=_STYLE,
        )
    )


class ClearSolutionsByKind(ClearSolutions):
    """nbgrader's ClearSolutions with a stub that fits the file a cell is."""

    def preprocess_cell(self, cell: NotebookNode, resources: Resources, cell_index: int) -> Step:
        """Replace the solution region by the stub of the cell's kind."""
        try:
            file = parse_cell(cell.source) if cell.cell_type == 'code' else None
        except CellSyntaxError as error:
            raise RuntimeError(f'{error} Cell contents are:\n{cell.source}') from error
        if file is None:
            return super().preprocess_cell(cell, resources, cell_index)
        if utils.is_solution(cell) and self.begin_solution_delimeter not in cell.source:
            raise RuntimeError(
                f'{file.path}: expected a region from ### BEGIN SOLUTION to ### END SOLUTION, '
                'got none: the magic line would be cleared with the solution.'
            )
        kind = file.name if file.kind == 'rospkg' else file.kind
        self.set_trait('code_stub', {**_STUBS, **self.code_stub})
        cell, _ = super().preprocess_cell(cell, {**resources, 'language': kind}, cell_index)
        return cell, resources


class SubmissionExporter(NotebookExporter):
    """Reads a submitted file as release plus answers; nbgrader's own files as they are."""

    def from_filename(
        self, filename: str, resources: Resources | None = None, **kw: Any
    ) -> tuple[str, Resources]:
        """Read a notebook that was handed in, or one that nbgrader wrote itself."""
        if resources is None or not getattr(self.parent, '_sanitizing', True):
            return super().from_filename(filename, resources=resources, **kw)
        assignment = resources['nbgrader']['assignment']
        coursedir = self.parent.coursedir
        folder = coursedir.format_path(coursedir.release_directory, '.', assignment)
        path = Path(folder) / f'{resources["nbgrader"]["notebook"]}.ipynb'
        release = read_release(path)
        data, problems = read_file(Path(filename), path.name)
        opened = open_submission(data, release, path.name, problems)
        for problem in opened.problems:
            self.log.warning('%s: %s', resources['nbgrader']['student'], problem.line())
        for flag in opened.flags:  # they quote the student, so they go into no file
            self.log.warning('%s: flag: %s', resources['nbgrader']['student'], printable(flag))
        return self.from_notebook_node(to_node(opened), resources=resources, **kw)


def to_node(opened: Opened) -> NotebookNode:
    """Return the notebook as nbformat has it, with the problems in its metadata."""
    notebook = from_dict(opened.notebook)
    notebook.metadata['autograder'] = {'problems': [asdict(one) for one in opened.problems]}
    return notebook


def from_node(notebook: NotebookNode) -> Opened:
    """Undo :func:`to_node`."""
    noted = notebook.metadata.get('autograder', {}).get('problems', [])
    return Opened(notebook, tuple(Problem.from_json(problem) for problem in noted))


class FeedbackExporter(HTMLExporter):
    """Makes our page for students; formgrader has HTMLExporter and its own template."""


class GradesToShow(GetGrades):
    """nbgrader's GetGrades, which also says what a person has yet to look at."""

    _lost: frozenset[str] = frozenset()

    def preprocess(self, nb: NotebookNode, resources: Resources) -> Step:
        """Put scores and comments into a notebook."""
        self._lost = from_node(nb).missing
        found: Step = super().preprocess(nb, resources)
        return found

    def _get_score(self, cell: NotebookNode, resources: Resources) -> None:
        super()._get_score(cell, resources)
        marks = cell.metadata.nbgrader
        grade = self.gradebook.find_grade(
            marks['grade_id'], self.notebook_id, self.assignment_id, self.student_id
        )
        marks['waits'] = bool(grade.needs_manual_grade)

    def _get_comment(self, cell: NotebookNode, resources: Resources) -> None:
        super()._get_comment(cell, resources)
        marks = cell.metadata.nbgrader
        if marks['grade_id'] in self._lost and marks['comment'] == NO_RESPONSE:
            marks['comment'] = LOST


class GradeOutside(NbGraderPreprocessor):
    """Grades where no student code can reach, and writes the outcome into the check cells."""

    engine_factory = Unicode(
        'autograder.whole_class.pipeline.grading_engine',
        help='Function that returns the engine, called with the layout of the course.',
    ).tag(config=True)
    root = Unicode('', help='Folder of the course; empty for the one of this package.').tag(
        config=True
    )

    _engine: Engine | None = None

    def preprocess(self, nb: NotebookNode, resources: Resources) -> Step:
        """Grade a notebook, unless results came along: :mod:`autograder.gradebook.record`."""
        result = resources['nbgrader'].get('result')
        if result is None:
            result = self._grade(nb, resources)
        if result.fault:
            self.log.error('%s is for review: %s', result.student, result.fault)
        write_outcomes(nb, result)
        return nb, resources

    def _grade(self, nb: NotebookNode, resources: Resources) -> SubmissionResult:
        """Grade one notebook that nbgrader brought."""
        layout = Layout(Path(self.root)) if self.root else Layout.here()
        if self._engine is None:
            self._engine = import_item(self.engine_factory)(layout)
        lesson: Lesson = load_lesson(layout, resources['nbgrader']['assignment'], self._engine)
        return grade_opened(from_node(nb), resources['nbgrader']['student'], lesson, self._engine)


def write_outcomes(nb: NotebookNode, result: SubmissionResult) -> None:
    """
    Write one text and, where there is a score, one value into every check cell.

    :param nb: a rebuilt notebook, changed in place
    """
    exams = {exam.exam: exam for exam in result.exams}
    general = [problem for problem in result.problems if not problem.cells]
    for cell in nb.cells:
        if not is_check(cell):
            continue
        name = cell.metadata.nbgrader['grade_id'].removeprefix(CHECK_PREFIX)
        exam = None if result.fault else exams.get(name)
        maximum = float(cell.metadata.nbgrader['points'])
        if exam is None or not 0 <= exam.points <= maximum + 1e-6:
            cell.outputs = [_text(f'{FOR_REVIEW}\n')]
            continue
        problems = [*general, *_about(result, exam, nb)]
        general = []
        cell.outputs = [_told(exam, problems), _score(min(exam.points, maximum))]
        cell.execution_count = 1


def is_check(cell: NotebookNode) -> bool:
    """Tell whether a cell is graded by an exam."""
    return bool(utils.is_grade(cell) and not utils.is_solution(cell) and cell.cell_type == 'code')


def _about(result: SubmissionResult, exam: ExamResult, nb: NotebookNode) -> list[Problem]:
    """Return the problems with the answers right above an exam's check cell."""
    own: set[str] = set()
    for cell in nb.cells:
        if is_check(cell):
            if cell.metadata.nbgrader['grade_id'] == f'{CHECK_PREFIX}{exam.exam}':
                break
            own.clear()
        elif utils.is_solution(cell):
            own.add(cell.metadata.nbgrader['grade_id'])
    return [problem for problem in result.problems if own & set(problem.cells)]


def _text(text: str) -> NotebookNode:
    """Return a cell output of plain text."""
    return new_output('stream', name='stdout', text=text)


def _told(exam: ExamResult, problems: Sequence[Problem]) -> NotebookNode:
    """Return a cell output with the feedback, as text and as HTML with pictures."""
    data = {
        'text/plain': exam_text(exam, problems),
        'text/html': exam_html(exam, problems, lesson=''),
    }
    return new_output('display_data', data=data)


def _score(points: float) -> NotebookNode:
    """Return the cell output that nbgrader reads as a partial grade."""
    data: Mapping[str, str] = {'text/plain': repr(round(points, 3))}
    return new_output('execute_result', data=data, execution_count=1)


class SaveGrades(SaveAutoGrades):
    """
    nbgrader's SaveAutoGrades, except for whose turn it is.

    A check without a score waits for a person.  A grade given by hand does not wait again when
    nothing has changed that it was given for: a rerun would take the mark away until somebody has
    looked at each of them once more.
    """

    def _add_score(self, cell: NotebookNode, resources: Resources) -> None:
        """Record a score; nbgrader alone gives full points where there is none."""
        grade = self.gradebook.find_grade(
            cell.metadata.nbgrader['grade_id'],
            self.notebook_id,
            self.assignment_id,
            self.student_id,
        )
        by_hand = grade.manual_score is not None and not grade.needs_manual_grade
        before = grade.auto_score
        scored = any(output.output_type == 'execute_result' for output in cell.get('outputs', []))
        if scored or not is_check(cell):
            super()._add_score(cell, resources)
        else:
            grade.auto_score = None
            grade.needs_manual_grade = True
        same_work = resources['nbgrader'].get('same_work', False)
        if by_hand and same_work and grade.auto_score == before:
            grade.needs_manual_grade = False
        self.gradebook.db.commit()

"""
Plug-ins that replace steps of nbgrader's commands; ``nbgrader_config.py`` names them.

nbgrader itself runs student code and tests in one kernel and trusts the outputs.  Instead, these
plug-ins rebuild the notebook from the release and the student's answers, grade it in the sandbox,
and write each check cell's feedback and score as outputs.  nbgrader's formgrader, feedback and
export work unchanged.
"""

from pathlib import Path
from typing import Any

import bleach
from bleach.css_sanitizer import CSSSanitizer
from nbconvert.exporters import HTMLExporter, NotebookExporter
from nbconvert.filters import markdown2html
from nbformat import NotebookNode
from nbgrader import utils
from nbgrader.api import Gradebook, Student
from nbgrader.preprocessors import ClearSolutions, GetGrades, NbGraderPreprocessor, SaveAutoGrades
from traitlets import Unicode
from traitlets.config import Config
from traitlets.utils.importstring import import_item

from autograder.classroom.people import extensions, read_people
from autograder.exam.inputs import keep_secret
from autograder.explaining.feedback import printable
from autograder.explaining.feedback_html import with_unique_ids
from autograder.gradebook.grade_cells import from_node, to_node, write_outcomes
from autograder.gradebook.live_entry import lowered_marks
from autograder.gradebook.record import refuse_unfit_points
from autograder.grading.examine import Engine
from autograder.grading.pipeline import grade_opened, Graded, Lesson, load_lesson
from autograder.layout import Layout
from autograder.results import SubmissionResult
from autograder.submission.cells import CellSyntaxError, parse_cell, UNSOLVED
from autograder.submission.inbox import Submission
from autograder.submission.notebook import is_check, read_release
from autograder.submission.reading import read_file
from autograder.submission.submission import open_submission

NO_RESPONSE = 'No response.'  # nbgrader's own text for an untouched answer
LOST = 'Your answer here was not found in the submitted file; a note below explains why.'
_STUBS = {
    'node': f'# {UNSOLVED}\nraise NotImplementedError()',
    'rosmsg': f'# {UNSOLVED}',
    'rospkg': f'# {UNSOLVED}',
    'xml': f'<!-- {UNSOLVED} -->',
    'answer': f"None  # {UNSOLVED}: 'a', 'b', 'c' or 'd' in place of None",
}

_SAFE_TAGS = {
    *bleach.ALLOWED_TAGS,
    *('h1', 'h2', 'h3', 'h4', 'h5', 'h6', 'p', 'div', 'span', 'pre', 'br', 'hr'),
    *('table', 'caption', 'thead', 'tbody', 'tr', 'th', 'td', 'details', 'summary'),
    *('del', 's', 'sub', 'sup', 'dl', 'dt', 'dd'),
}
# Elements and styles of the grader's pictures; they load nothing and run no script.
_PICTURE_TAGS = {'svg', 'g', 'title', 'desc', 'path', 'line', 'rect', 'text'}
_PICTURE_ATTRIBUTES = [
    *('class', 'id', 'style', 'role', 'aria-label', 'aria-labelledby', 'tabindex'),
    *('transform', 'd', 'x', 'y'),
    *('x1', 'x2', 'y1', 'y2', 'rx', 'width', 'height', 'viewBox', 'fill', 'fill-opacity'),
    *('stroke', 'stroke-width', 'stroke-opacity', 'stroke-dasharray', 'text-anchor'),
    *('font-family', 'font-size', 'font-style', 'font-weight'),
]
_STYLE = CSSSanitizer(
    allowed_css_properties=[
        *('display', 'grid-template-columns', 'gap', 'margin', 'padding', 'float', 'width'),
        *('max-width', 'min-width', 'height', 'text-align', 'line-height', 'font-weight'),
        *('overflow-x', 'overflow-wrap', 'border-left', 'color'),
    ]
)

Resources = dict[str, Any]
Step = tuple[NotebookNode, Resources]


def safe_markdown(source: str) -> str:
    """Render a student's Markdown without scripts, which would run with an instructor's rights."""
    attributes = {**bleach.ALLOWED_ATTRIBUTES, '*': ['class', 'id']}
    return str(bleach.clean(markdown2html(source), tags=_SAFE_TAGS, attributes=attributes))


def safe_output(html: object) -> str:
    """
    Clean the HTML of a cell output like :func:`safe_markdown`, but keep the grader's pictures.

    nbconvert's own ``clean_html`` also rejects paragraphs, headings and parts of tables: it shows
    their tags as text.
    """
    text = html.decode() if isinstance(html, bytes) else str(html)
    attributes = {**bleach.ALLOWED_ATTRIBUTES, '*': _PICTURE_ATTRIBUTES}
    tags = _SAFE_TAGS | _PICTURE_TAGS
    return str(bleach.clean(text, tags=tags, attributes=attributes, css_sanitizer=_STYLE))


class ClearSolutionsByKind(ClearSolutions):
    """nbgrader's ClearSolutions, with a separate stub for each kind of file in a cell."""

    def preprocess_cell(self, cell: NotebookNode, resources: Resources, cell_index: int) -> Step:
        """Replace the solution region of a cell with the stub for its kind of file."""
        try:
            file = parse_cell(cell.source) if cell.cell_type == 'code' else None
        except CellSyntaxError as error:
            raise RuntimeError(f'{error} Cell contents are:\n{cell.source}') from error
        if file is None:
            return super().preprocess_cell(cell, resources, cell_index)
        if utils.is_solution(cell) and self.begin_solution_delimeter not in cell.source:
            raise RuntimeError(
                f'{file.path}: the solution is not between ### BEGIN SOLUTION and '
                '### END SOLUTION, so the release would lose the magic line too.'
            )
        kind = 'xml' if file.name.endswith('.xml') else file.kind
        self.set_trait('code_stub', {**_STUBS, **self.code_stub})
        cell, _ = super().preprocess_cell(cell, {**resources, 'language': kind}, cell_index)
        return cell, resources


class SubmissionExporter(NotebookExporter):
    """Rebuild submitted notebooks from release and answers; read nbgrader's files unchanged."""

    def from_filename(
        self, filename: str, resources: Resources | None = None, **kw: Any
    ) -> tuple[str, Resources]:
        """Read a submitted notebook, or a notebook that nbgrader wrote."""
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
        for flag in opened.flags:  # Flags quote the student, so they are logged but not saved.
            self.log.warning('%s: flag: %s', resources['nbgrader']['student'], printable(flag))
        return self.from_notebook_node(to_node(opened), resources=resources, **kw)


class FeedbackExporter(HTMLExporter):
    """Write the feedback page for students; formgrader uses HTMLExporter with its own template."""

    def from_notebook_node(
        self, nb: NotebookNode, resources: Resources | None = None, **kw: Any
    ) -> tuple[str, Resources]:
        """Return the page, with unique ids and with tables that can be scrolled by keyboard."""
        page, resources = super().from_notebook_node(nb, resources=resources, **kw)
        page = page.replace('<table', '<table tabindex="0" aria-label="Table"')
        return with_unique_ids(page), resources


class GradesToShow(GetGrades):
    """nbgrader's GetGrades, which also marks the cells that still need manual grading."""

    _lost: frozenset[str] = frozenset()

    def preprocess(self, nb: NotebookNode, resources: Resources) -> Step:
        """Add the scores and comments from the gradebook to a notebook."""
        self._lost = from_node(nb).missing
        return super().preprocess(nb, resources)

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


def course_of(config: Config) -> Layout:
    """Return the course of nbgrader's settings; the current course if they name no folder."""
    root = config.CourseDirectory.get('root')
    return Layout(Path(root)) if isinstance(root, (str, Path)) else Layout.here()


class GradeOutside(NbGraderPreprocessor):
    """Grade in the sandbox instead of the kernel, and write the outcomes into the check cells."""

    engine_factory = Unicode(
        'autograder.grading.pipeline.grading_engine',
        help='Function that returns the engine, called with the layout of the course.',
    ).tag(config=True)

    _engine: Engine | None = None

    def preprocess(self, nb: NotebookNode, resources: Resources) -> Step:
        """Grade a notebook, unless :mod:`autograder.gradebook.record` supplies the result."""
        result = resources['nbgrader'].get('result')
        if result is None:
            result = self._grade(nb, resources)
        if result.review:
            self.log.error('%s is for review: %s', result.student, printable(result.review))
        write_outcomes(nb, result)
        return nb, resources

    def _grade(self, nb: NotebookNode, resources: Resources) -> SubmissionResult:
        """Grade a notebook; set ``keep_scores`` if its mark in the gradebook would be lowered."""
        layout = course_of(self.config)
        if self._engine is None:
            self._engine = import_item(self.engine_factory)(layout)
        lesson: Lesson = load_lesson(layout, resources['nbgrader']['assignment'], self._engine)
        refuse_unfit_points(layout, lesson)
        keep_secret(layout)
        student, opened = resources['nbgrader']['student'], from_node(nb)
        result = grade_opened(opened, student, lesson, self._engine)
        submission = Submission(student, layout.submitted / student / lesson.assignment)
        for change in lowered_marks(layout, lesson, [Graded(submission, opened, result)]).values():
            resources['nbgrader']['keep_scores'] = True
            self.log.warning(
                'gradebook: the mark would be lowered, so it was not changed: %s. Try: '
                '.venv/bin/autograder grade --yes',
                change,
            )
        return result


class SaveGrades(SaveAutoGrades):
    """
    nbgrader's SaveAutoGrades, with a different rule for manual grading.

    A check cell without a score needs manual grading.  A manual grade remains valid if the work is
    unchanged; without this rule, each rerun would remove the mark until the instructor had graded
    every answer again.
    """

    _unusable = False

    def preprocess(self, nb: NotebookNode, resources: Resources) -> Step:
        """Record the name and the extra time of the student, and the scores of a notebook."""
        facts, layout = resources['nbgrader'], course_of(self.config)
        more = extensions(layout)
        with Gradebook(facts['db_url']) as gradebook:
            submission = gradebook.find_submission(facts['assignment'], facts['student'])
            if more is not None:
                given = more.get((facts['student'], facts['assignment']))
                # nbgrader fails if it adds extra time to a missing due date.
                submission.extension = given if submission.assignment.duedate else None
            name = facts.get('name')
            if name is None:
                name = read_people(layout).get(facts['student'], '')
            _enter_name(submission.student, name)
            gradebook.db.commit()
        self._unusable = any(problem.unusable for problem in from_node(nb).problems)
        return super().preprocess(nb, resources)

    def _add_score(self, cell: NotebookNode, resources: Resources) -> None:
        """Record a score; a cell without one needs manual grading, not nbgrader's full points."""
        if is_check(cell) and resources['nbgrader'].get('keep_scores', False):
            return
        grade = self.gradebook.find_grade(
            cell.metadata.nbgrader['grade_id'],
            self.notebook_id,
            self.assignment_id,
            self.student_id,
        )
        by_hand = grade.manual_score is not None and not grade.needs_manual_grade
        before = grade.auto_score
        scored = any(output.output_type == 'execute_result' for output in cell.get('outputs', []))
        if scored or not (is_check(cell) or self._unusable):
            super()._add_score(cell, resources)
        else:
            grade.auto_score = None
            grade.needs_manual_grade = True
        same_work = resources['nbgrader'].get('same_work', False)
        if by_hand and same_work and grade.auto_score == before:
            grade.needs_manual_grade = False
        self.gradebook.db.commit()


def _enter_name(student: Student, name: str) -> None:
    """
    Enter the name of a student for formgrader, or else the id, unless the gradebook has a name.

    Formgrader shows "last, first", and "None, None" if there is no name.
    """
    if student.first_name or student.last_name not in (None, '', student.id):
        return
    first, _, last = name.rpartition(' ')
    student.first_name = first or (student.id if last else '')
    student.last_name = last or student.id

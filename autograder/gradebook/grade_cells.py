"""Find the cells of a notebook that an exam grades, and write scores and feedback into them."""

from collections.abc import Sequence
from dataclasses import asdict

from nbformat import from_dict, NotebookNode
from nbformat.v4 import new_output

from autograder.explaining.feedback import exam_text, FOR_REVIEW, review_text
from autograder.explaining.feedback_html import exam_html
from autograder.results import ExamResult, Problem, SubmissionResult
from autograder.submission.notebook import CHECK_PREFIX, is_check, marks_of, Notebook
from autograder.submission.submission import Opened


def to_node(opened: Opened) -> NotebookNode:
    """Convert a submission to an nbformat notebook, with its problems in the metadata."""
    notebook = from_dict(opened.notebook)
    notebook.metadata['autograder'] = {'problems': [asdict(one) for one in opened.problems]}
    return notebook


def from_node(notebook: NotebookNode) -> Opened:
    """Convert a notebook from :func:`to_node` back to a submission."""
    noted = notebook.metadata.get('autograder', {}).get('problems', [])
    return Opened(notebook, tuple(Problem.from_json(problem) for problem in noted))


def write_outcomes(nb: NotebookNode, result: SubmissionResult) -> None:
    """
    Write the feedback and, if there is one, the score into every check cell of a notebook.

    Problems with the answers directly above a check cell belong to this cell; problems with the
    whole notebook, to the first check cell with a score.
    """
    exams = {exam.exam: exam for exam in result.exams}
    general = [problem for problem in result.problems if not problem.cells]
    answers: set[str] = set()
    for cell in nb.cells:
        if not is_check(cell):
            if marks_of(cell).get('solution'):
                answers.add(marks_of(cell)['grade_id'])
            continue
        about = [problem for problem in result.problems if answers & set(problem.cells)]
        answers.clear()
        score = score_of(cell, result)
        if score is None:
            text = review_text(result) if result.review else f'{FOR_REVIEW}\n'
            cell.outputs = [new_output('stream', name='stdout', text=text)]
            continue
        feedback = _feedback_output(exams[_exam_name(cell)], [*general, *about])
        cell.outputs = [feedback, _score(score)]
        cell.execution_count = 1
        general = []


def score_of(cell: Notebook, result: SubmissionResult) -> float | None:
    """Return the score of a check cell of the release, or None if the cell is for review."""
    maximum = float(marks_of(cell)['points'])
    for exam in () if result.review else result.exams:
        if exam.exam == _exam_name(cell) and 0 <= exam.points <= maximum + 1e-6:
            return round(min(exam.points, maximum), 3)
    return None


def _exam_name(cell: Notebook) -> str:
    """Return the name of the exam that grades a check cell."""
    return str(marks_of(cell)['grade_id']).removeprefix(CHECK_PREFIX)


def _feedback_output(exam: ExamResult, problems: Sequence[Problem]) -> NotebookNode:
    """Return a cell output with the feedback, as text and as HTML with pictures."""
    data = {
        'text/plain': exam_text(exam, problems),
        'text/html': exam_html(exam, problems, {'': ''}),
    }
    return new_output('display_data', data=data)


def _score(points: float) -> NotebookNode:
    """Return the cell output that nbgrader reads as a partial grade."""
    return new_output('execute_result', data={'text/plain': repr(points)}, execution_count=1)

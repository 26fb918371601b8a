"""
Test the grader on this machine: the reference solution must pass, the untouched release must fail.

The set-up runs this test as its last step; authors run it after they edit an exam.  The recordings
are stored, so a later grading can use them.
"""

from collections.abc import Iterator

from autograder.authoring.exam_mistakes import mistakes_of
from autograder.exam.exam import Exam
from autograder.gradebook.record import points_mismatches
from autograder.grading.examine import Engine
from autograder.grading.pipeline import grade_opened, Lesson, load_lesson
from autograder.layout import Layout
from autograder.results import SubmissionResult
from autograder.submission.submission import open_submission


def self_check(layout: Layout, engine: Engine) -> Iterator[tuple[bool, str]]:
    """
    Grade the reference solution and the untouched release of every assignment.

    :returns: for each of them, whether the result is as expected, and one line of text
    :raises GraderError: if the course has an error or the grader fails
    """
    for assignment in layout.assignments():
        lesson = load_lesson(layout, assignment, engine)
        # Do not run an exam with a mistake, because the run may fail or hang.
        exams = [exam for exam in lesson.exams if isinstance(exam, Exam)]
        if mistakes := mistakes_of(exams, layout.notebooks):
            yield from ((False, f'{assignment}: {line}') for line in mistakes)
            continue
        if not lesson.exams:
            cells = list(points_mismatches(lesson.release, assignment, ()))
            yield not cells, ' '.join(cells) or f'{assignment}: nothing to grade, as expected.'
            continue
        for name, path, share in (
            ('the reference solution', layout.solutions / assignment / lesson.notebook, 1.0),
            ('the untouched release', layout.release(assignment), 0.0),
        ):
            opened = open_submission(path.read_bytes(), lesson.release, lesson.notebook)
            result = grade_opened(opened, name, lesson, engine)
            yield _line(lesson, result, share * result.max_points)


def _line(lesson: Lesson, result: SubmissionResult, wanted: float) -> tuple[bool, str]:
    if result.fault:  # Without a verdict, there are no points to compare.
        return False, f'{lesson.assignment}: {result.student} has no verdict. {result.fault}'
    right = bool(result.exams) and result.points == wanted
    text = f'{lesson.assignment}: {result.student} has {result.points:g} of {result.max_points:g}'
    if right:
        return True, f'{text}, as expected.'
    why = ', '.join(
        f'{exam.exam}/{check.check}: {check.verdict.value}'
        for exam in result.exams
        for check in exam.checks
        if (check.points > 0) != (wanted > 0)
    )
    return False, f'{text}, expected {wanted:g}. {why}'

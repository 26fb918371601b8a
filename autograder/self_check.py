"""
Does the grader deserve trust on this machine?  The reference must pass, the bare release must not.

Run at the end of the set-up and after an exam was edited.  The recordings are kept, so grading
starts where this ends.
"""

from __future__ import annotations

from collections.abc import Iterator

from autograder.layout import Layout
from autograder.pipeline import Engine, grade_notebook, Lesson, load_lesson
from autograder.results import SubmissionResult


def self_check(layout: Layout, engine: Engine) -> Iterator[tuple[bool, str]]:
    """
    Grade the reference solution and the untouched release of every assignment.

    :returns: for each of them whether it is as it must be, and one line for people
    :raises GraderError: for a fault of the course or of the grader
    """
    for assignment in layout.assignments():
        lesson = load_lesson(layout, assignment, engine)
        source = layout.solutions / assignment / lesson.notebook
        result = grade_notebook(source.read_bytes(), lesson, 'the reference solution', engine)
        yield _line(lesson, result, result.max_points)
        bare = layout.release(assignment).read_bytes()
        result = grade_notebook(bare, lesson, 'the untouched release', engine)
        yield _line(lesson, result, 0.0)


def _line(lesson: Lesson, result: SubmissionResult, wanted: float) -> tuple[bool, str]:
    right = not result.fault and bool(result.exams) and result.points == wanted
    text = f'{lesson.assignment}: {result.student} has {result.points:g} of {result.max_points:g}'
    if right:
        return True, f'{text}, as it must.'
    why = result.fault or ', '.join(
        f'{exam.exam}/{check.check}: {check.verdict.value}'
        for exam in result.exams
        for check in exam.checks
        if (check.points > 0) != (wanted > 0)
    )
    return False, f'{text}, expected {wanted:g}. {why}'

"""Remove all entries of students from the journals, the gradebook and the reports."""

from __future__ import annotations

from collections.abc import Collection
import shutil

from autograder.classroom.pages import write_all_reports
from autograder.classroom.results_of_class import results_file, results_of_others
from autograder.errors import GraderError
from autograder.gradebook.journal import drop
from autograder.gradebook.record import forget_students
from autograder.gradebook.settings import has_gradebook
from autograder.layout import Layout


def forget_made(layout: Layout, students: Collection[str]) -> None:
    """Remove all entries of students from the journals, the gradebook and the reports."""
    # Start with the journals: an empty gradebook with non-empty journals is refused as damaged.
    for assignment in layout.assignments():
        drop(layout, assignment, students)
    if has_gradebook(layout):
        forget_students(layout, students)
    _forget_in_reports(layout, students)


def _forget_in_reports(layout: Layout, students: Collection[str]) -> None:
    """Remove students from the last results, which statistics and exports use."""
    for assignment in layout.assignments():
        if not results_file(layout, assignment).is_file():
            continue
        try:
            others = results_of_others(layout, assignment, students)
        except GraderError:
            continue  # The results are damaged; the next grading replaces them.
        if others:
            write_all_reports(layout, assignment, others)
        else:
            shutil.rmtree(layout.reports / assignment)

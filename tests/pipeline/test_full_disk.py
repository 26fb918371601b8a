"""A full disk during grading causes a one-line error, and no finished run is lost."""

from contextlib import contextmanager
import errno

from conftest import ASSIGNMENT
from fake_engine import FakeEngine
from gradebooks import grade, hand_in, refusal_after_grading
import pytest
from rich.console import Console
from sqlalchemy import event
from sqlalchemy.engine import Engine

from autograder.classroom import pages
from autograder.classroom.results_of_class import last_results
from autograder.commands import grade as grading
from autograder.gradebook import journal, record
from autograder.gradebook.live_entry import Guard

pytestmark = [pytest.mark.pipeline, pytest.mark.nbgrader]

STUDENTS = [f's{number}' for number in range(10, 30)]
"""Enough students to need more room than the gradebook's pages have left."""


@pytest.fixture
def class_(course):
    """Write a solution for each student."""
    for student in STUDENTS:
        hand_in(course, student)
    return course


@contextmanager
def no_room_in_gradebook():
    """Make every SQLite file unable to grow, as on a full disk."""

    def limit(connection, _):
        connection.execute('pragma max_page_count = 1')  # never below the current size

    event.listen(Engine, 'connect', limit)
    try:
        yield
    finally:
        event.remove(Engine, 'connect', limit)


def no_room(*_, **__):
    """Raise the error of a full disk, as the operating system does."""
    raise OSError(errno.ENOSPC, 'No space left on device')


def graded(course):
    """Grade the class as the command does; return the table and the refusals."""
    console = Console(width=120, record=True)
    class_ = grading.Grading(course, course.submitted, FakeEngine(), 1, console, Guard(course))
    _, trouble = class_.one(ASSIGNMENT)
    return console.export_text(), trouble


def test_a_full_disk_under_the_gradebook_is_one_line(class_, capfd):
    """The error is not repeated for each student, and the next grading enters all results."""
    with no_room_in_gradebook():
        table, said = graded(class_)

    assert said.endswith(
        'gradebook.db: the gradebook cannot be used: database or disk is full. Try: free space '
        'on its disk, then run the same command again. Finished runs are kept.'
    )
    assert len(said.splitlines()) == 1
    assert capfd.readouterr().err == ''
    assert [one.student for one in last_results(class_, ASSIGNMENT)] == STUDENTS
    assert all(student in table for student in STUDENTS)
    assert grade(class_) == len(STUDENTS)
    assert set(journal.gradebook_values(class_, ASSIGNMENT)) == set(STUDENTS)


def test_a_full_disk_under_the_submissions_is_one_line(class_, monkeypatch):
    """The disk is already full when the grader writes the notebooks for nbgrader."""
    with monkeypatch.context() as patch:
        patch.setattr(record, '_stage', no_room)
        said = refusal_after_grading(class_, count=len(STUDENTS))

    assert said.startswith(f'{class_.work}: the disk is full. Try: free space on it')
    assert grade(class_) == len(STUDENTS)


def test_a_full_disk_under_the_reports_leaves_the_table(class_, monkeypatch):
    """The table still shows every student, and the earlier reports remain."""
    monkeypatch.setattr(pages, 'write_atomically', no_room)
    table, said = graded(class_)

    assert said.startswith(f'{class_.reports}: the disk is full. Try: free space on it')
    assert all(student in table for student in STUDENTS)
    assert 'Reports: ' not in table
    assert grade(class_) == 0

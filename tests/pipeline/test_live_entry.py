"""Finished submissions are entered in the gradebook while others still run."""

import threading

from conftest import ASSIGNMENT
from fake_engine import FakeEngine
from gradebooks import CHECK, grade, hand_in, scores
import pytest

from autograder.errors import GraderError
from autograder.gradebook import journal, live_entry
from autograder.gradebook.live_entry import Guard, LiveEntry
from autograder.grading.pipeline import grade_class, load_lesson
from autograder.submission.inbox import discover

pytestmark = [pytest.mark.pipeline, pytest.mark.nbgrader]

STUDENTS = ('ann', 'bob', 'cho')
GOES_ON_S = 60


class Held(FakeEngine):
    """Runs the last student's exams only when it is released."""

    def __init__(self) -> None:
        self.begun, self.free = threading.Event(), threading.Event()

    def run(self, exam, files):
        if 'of_cho' in ''.join(files.values()):
            self.begun.set()
            assert self.free.wait(GOES_ON_S)
        return super().run(exam, files)


@pytest.fixture
def class_(course):
    """Write three different answers."""
    for student in STUDENTS:
        hand_in(course, student, **{'THRESHOLD_C = ': f'of_{student} = THRESHOLD_C = '})
    return course


def run(course, engine, on_graded):
    lesson = load_lesson(course, ASSIGNMENT, engine)
    there = discover(course.submitted, ASSIGNMENT, lesson.notebook, course.assignments())
    book = LiveEntry(course, lesson, Guard(course))
    grade_class(there, lesson, engine, 1, on_graded=lambda graded: on_graded(book, graded))
    return book.finish()


def test_whoever_is_ready_is_entered_while_others_are_run(class_, monkeypatch):
    """No submission is entered twice, and the journal is that of one complete grading."""
    monkeypatch.setattr(live_entry, 'BATCH_SIZE', 2)
    engine = Held()
    early: list[str] = []

    def on_graded(book, graded):
        book.add(graded)
        if graded.result.student == 'bob':
            assert engine.begun.wait(GOES_ON_S)
            early.extend(sorted(journal.gradebook_values(class_, ASSIGNMENT)))
            engine.free.set()

    assert run(class_, engine, on_graded) == (3, '')
    assert early == ['ann', 'bob']
    assert {scores(class_, one)[CHECK] for one in STUDENTS} == {15}
    assert grade(class_) == 0


def test_a_gradebook_that_refuses_meanwhile_is_asked_again_at_the_end(class_, monkeypatch):
    monkeypatch.setattr(live_entry, 'BATCH_SIZE', 2)
    engine, real = Held(), live_entry.record
    engine.free.set()
    asked: list[list[str]] = []

    def busy_at_first(layout, lesson, graded):
        asked.append([one.result.student for one in graded])
        if len(asked) == 1:
            raise GraderError('locked')
        real(layout, lesson, graded)

    monkeypatch.setattr(live_entry, 'record', busy_at_first)

    assert run(class_, engine, LiveEntry.add) == (3, '')
    assert asked == [['ann', 'bob'], ['ann', 'bob', 'cho']]


def test_a_gradebook_that_cannot_be_reached_costs_no_result(class_):
    class_.work.joinpath('gradebook.db').write_bytes(b'no database' * 100)
    engine = Held()
    engine.free.set()

    new, refused = run(class_, engine, LiveEntry.add)

    assert new == 3
    assert 'gradebook.db: the gradebook is damaged: ' in refused

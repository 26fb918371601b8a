"""The grader holds one notebook of a class in memory at a time, and keeps only answers."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
import json
import tracemalloc

from autograder.grading.pipeline import grade_class, Lesson
from autograder.results import ExamResult
from autograder.submission.inbox import discover
from autograder.submission.submission import open_submission

MEGABYTE = 1_000_000
STUDENTS = 12
FILE = 'talker.ipynb'


def cell(source):
    """Return an answer cell with this source."""
    marks = {'grade_id': 'talker', 'solution': True}
    return {'cell_type': 'code', 'metadata': {'nbgrader': marks}, 'source': source}


RELEASE = {'cells': [cell('%%node talker\n# YOUR CODE HERE')], 'metadata': {}}


@dataclass(frozen=True)
class FakeExam:
    """The parts of an exam that the pipeline needs."""

    name: str = 'talker'
    cells: tuple[str, ...] = ('talker',)


class FakeEngine:
    """Returns a result without running anything."""

    def run(self, exam, files):
        """Return an empty result."""
        return ExamResult(exam.name, ())


def large_notebook(picture=MEGABYTE):
    """Return a notebook whose answer has a large picture as its output."""
    output = {'output_type': 'display_data', 'data': {'image/png': 'A' * picture}}
    return json.dumps({'cells': [{**cell('%%node talker\npass'), 'outputs': [output]}]}).encode()


@dataclass
class Traced:
    """Memory that Python has allocated since the start of a measurement [bytes]."""

    kept: int = 0
    peak: int = 0


@contextmanager
def traced() -> Iterator[Traced]:
    """Measure what a block allocates."""
    found = Traced()
    tracemalloc.start()
    try:
        yield found
        found.kept, found.peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()


def test_a_class_takes_the_memory_of_one_notebook(tmp_path):
    for number in range(STUDENTS):
        folder = tmp_path / f's{number:02}' / '01'
        folder.mkdir(parents=True)
        (folder / FILE).write_bytes(large_notebook())
    lesson = Lesson('01', FILE, RELEASE, (FakeExam(),))

    with traced() as memory:
        class_ = discover(tmp_path, '01', FILE)
        graded = grade_class(class_, lesson, FakeEngine(), jobs=1)

    assert len(graded) == STUDENTS
    assert [one.opened.problems for one in graded] == [()] * STUDENTS
    assert memory.peak < 5 * MEGABYTE
    assert memory.kept < MEGABYTE


def test_of_a_text_that_is_too_long_almost_nothing_is_kept():
    data = json.dumps({'cells': [cell('x' * 10 * MEGABYTE)]}).encode()

    with traced() as memory:
        opened = open_submission(data, RELEASE, 'x')

    assert opened.missing == {'talker'}
    assert memory.kept < MEGABYTE // 10


def test_many_numbers_take_no_more_than_their_text():
    """Otherwise each number would be an object of 24 bytes or more."""
    numbers = b'1.5,' * MEGABYTE
    data = b'{"cells": [], "x": [' + numbers + b'1]}'

    with traced() as memory:
        opened = open_submission(data, RELEASE, 'x')

    assert opened.missing == {'talker'}
    assert memory.peak < 5 * len(numbers)

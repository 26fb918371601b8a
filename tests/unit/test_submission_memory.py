"""The grader holds one notebook of a class in memory at a time, and keeps only answers."""

from contextlib import contextmanager
import json
import tracemalloc
from types import SimpleNamespace

from collect_sources import laid
from fake_grading import answer, cell, FakeEngine, FakeExam

from autograder.grading.pipeline import grade_class, Lesson
from autograder.submission.inbox import discover
from autograder.submission.submission import open_submission

MEGABYTE = 1_000_000
STUDENTS = 12
FILE = 'talker.ipynb'
RELEASE = {'cells': [answer('# YOUR CODE HERE')], 'metadata': {}}


@contextmanager
def traced():
    """Yield an object that gets the memory [bytes] which the block has kept, and its peak."""
    found = SimpleNamespace()
    tracemalloc.start()
    try:
        yield found
        found.kept, found.peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()


def test_a_class_takes_the_memory_of_one_notebook(tmp_path):
    picture = {'output_type': 'display_data', 'data': {'image/png': 'A' * MEGABYTE}}
    data = json.dumps({'cells': [{**answer('pass'), 'outputs': [picture]}]}).encode()
    laid(tmp_path, {f's{number:02}/01/{FILE}': data for number in range(STUDENTS)})
    lesson = Lesson('01', FILE, RELEASE, (FakeExam(),))

    with traced() as memory:
        class_ = discover(tmp_path, '01', FILE)
        graded = grade_class(class_, lesson, FakeEngine(), jobs=1)

    assert len(graded) == STUDENTS
    assert [one.opened.problems for one in graded] == [()] * STUDENTS
    assert memory.peak < 5 * MEGABYTE
    assert memory.kept < MEGABYTE


def test_of_a_text_that_is_too_long_almost_nothing_is_kept():
    data = json.dumps({'cells': [cell('talker', 'x' * 10 * MEGABYTE)]}).encode()

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

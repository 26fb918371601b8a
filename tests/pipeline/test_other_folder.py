"""``grade --submitted DIR``: the class keeps its results when a different folder is graded."""

import io
import json

from conftest import ASSIGNMENT
from fake_engine import FakeEngine
from gradebooks import hand_in, NOTEBOOK
import pytest
from rich.console import Console

from autograder.classroom.results_of_class import graded as results_of
from autograder.classroom.results_of_class import last_results, results_file
from autograder.classroom.standing import CHANGED, UNGRADED, without_result
from autograder.commands.grade import Grading
from autograder.errors import GraderError
from autograder.gradebook.live_entry import Guard


class VisibleEngine(FakeEngine):
    """An engine that never enters results in the gradebook."""

    hidden = False


def grade(course, folder):
    console = Console(file=io.StringIO(), width=150)
    Grading(course, folder, VisibleEngine(), 1, console, Guard(course)).one(ASSIGNMENT)
    return console.file.getvalue()


def points(course):
    return {one.student: one.points for one in results_of(course, ASSIGNMENT)[0].results}


def pages(course):
    return {
        path.name: path.read_text(encoding='utf-8')
        for path in (course.reports / ASSIGNMENT / 'students').iterdir()
    }


@pytest.fixture
def graded(course):
    """Return a course with a class of three."""
    for student in ('ann', 'cho'):
        hand_in(course, student)
    hand_in(course, 'bob', temperature_topic='temprature_topic')
    assert 'Their results are unchanged' not in grade(course, course.submitted)
    return course


def test_an_appeal_changes_one_student(graded, tmp_path):
    """Results and pages of other students are unchanged, and the lists contain all students."""
    before, old = points(graded), pages(graded)
    hand_in(graded, 'bob', into=tmp_path / 'appeal')
    hand_in(graded, 'dee', into=tmp_path / 'appeal')

    said = grade(graded, tmp_path / 'appeal')

    assert before == {'ann': 50, 'bob': 40, 'cho': 50}
    assert points(graded) == {'ann': 50, 'bob': 50, 'cho': 50, 'dee': 50}
    assert list(points(graded)) == ['ann', 'bob', 'cho', 'dee']
    assert 'Students not in this folder: 2. Their results are unchanged.' in said
    assert 'cho' not in said
    new = pages(graded)
    assert sorted(new) == ['ann.html', 'bob.html', 'cho.html', 'dee.html']
    for name in ('ann.html', 'cho.html'):
        assert new[name] == old[name]
    text = (graded.reports / ASSIGNMENT / 'class.html').read_text(encoding='utf-8')
    assert [one for one in new if f'students/{one}' not in text] == []


def test_an_appeal_counts_until_new_work_is_collected(graded, tmp_path):
    """The notebook of an appeal differs from the collected one, which has not changed."""
    hand_in(graded, 'bob', into=tmp_path / 'appeal')
    hand_in(graded, 'dee', into=tmp_path / 'appeal')
    grade(graded, tmp_path / 'appeal')
    assert without_result(graded, ASSIGNMENT, last_results(graded, ASSIGNMENT)) == ()

    for student in ('bob', 'dee', 'eve'):
        hand_in(graded, student, sensor_id='sensor')

    missing = without_result(graded, ASSIGNMENT, last_results(graded, ASSIGNMENT))
    assert [(one.student, one.status) for one in missing] == [
        ('bob', CHANGED),
        ('dee', CHANGED),
        ('eve', UNGRADED),
    ]


@pytest.mark.parametrize('link', [False, True], ids=['by its name', 'by a link'])
def test_the_courses_own_folder_is_the_class(graded, tmp_path, link):
    """A student who is no longer in the folder is removed, even if the path is a link."""
    (graded.submitted / 'cho' / ASSIGNMENT / NOTEBOOK).unlink()
    (graded.submitted / 'cho' / ASSIGNMENT).rmdir()
    (graded.submitted / 'cho').rmdir()
    folder = graded.submitted
    if link:
        folder = tmp_path / 'link'
        folder.symlink_to(graded.submitted)

    assert 'their results are unchanged' not in grade(graded, folder)
    assert sorted(points(graded)) == ['ann', 'bob']
    assert sorted(pages(graded)) == ['ann.html', 'bob.html']


def test_a_first_grading_from_elsewhere_has_nobody_to_keep(course, tmp_path):
    hand_in(course, 'ann', into=tmp_path / 'mine')

    assert 'their results are unchanged' not in grade(course, tmp_path / 'mine')
    assert points(course) == {'ann': 50}


def test_results_that_cannot_be_read_are_not_replaced(graded, tmp_path):
    path = results_file(graded, ASSIGNMENT)
    path.write_text(json.dumps([{'student': 'ann'}]), encoding='utf-8')
    hand_in(graded, 'bob', into=tmp_path / 'appeal')

    with pytest.raises(GraderError, match='the results cannot be read'):
        grade(graded, tmp_path / 'appeal')
    assert json.loads(path.read_text(encoding='utf-8')) == [{'student': 'ann'}]

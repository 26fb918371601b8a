"""
Hostile notebooks and folders, graded in one class with honest students.

All are handed in, graded, recorded in nbgrader's gradebook and reported once; a separate test then
checks each property.
"""

import copy
from dataclasses import dataclass, replace
import json
import os
from pathlib import Path
import shutil
import sqlite3
import subprocess
import sys

import pytest

from autograder.classroom.pages import page_name, write_all_reports
from autograder.gradebook.record import enter_assignment, record
from autograder.grading.examine import Engine
from autograder.grading.pipeline import grade_class, Graded, Lesson, load_lesson
from autograder.layout import Layout
from autograder.results import SubmissionResult
from autograder.sandboxes.choose import strongest
from autograder.submission.inbox import discover
from autograder.submission.notebook import read_release
from tests.attacks import hostile_folders, hostile_notebooks  # noqa: F401 - they fill HANDED_IN
from tests.attacks.corpus import Attack, CANARY
from tests.attacks.notebook_builder import ASSIGNMENT, cell, HANDED_IN, lay_out, PAYLOAD

pytestmark = [pytest.mark.attacks, pytest.mark.ros, pytest.mark.slow, pytest.mark.nbgrader]

ROOT = Path(__file__).parents[2]
ATTACKS = [about for about, _ in HANDED_IN.values()]
# In alphabetical order, one is before, one among and one after the attacks; the last is unsolved.
HONEST = {'ada': 50.0, 'has_a_pen': 50.0, 'zoe': 0.0}
HTML = ('<script>alert', '<img src=x', '<svg/', 'href="javascript:', '<iframe', '<b onmouse')


@dataclass(frozen=True)
class ClassRun:
    """
    A graded class.

    :param graded: results by the student's name
    :param students: name of the student by attack
    """

    layout: Layout
    lesson: Lesson
    graded: dict[str, Graded]
    students: dict[str, str]

    def of(self, attack: Attack) -> SubmissionResult:
        return self.graded[self.students[attack.name]].result


def hand_in(attack: Attack, submitted: Path, solved, blank) -> Path:
    """Write the submission of an attack, and return the student's folder."""
    before, student = set(submitted.iterdir()), submitted / attack.name
    content = HANDED_IN[attack.name][1](student, copy.deepcopy(solved), copy.deepcopy(blank))
    if content is not None:
        lay_out(student, content)
    (made,) = set(submitted.iterdir()) - before
    return made


@pytest.fixture(scope='session')
def course(tmp_path_factory) -> Layout:
    from autograder.gradebook import converters

    layout = Layout(tmp_path_factory.mktemp('course'))
    source = ROOT / 'solutions' / ASSIGNMENT
    ignore = shutil.ignore_patterns('ros_ws', '.ipynb_checkpoints')
    shutil.copytree(source, layout.solutions / ASSIGNMENT, ignore=ignore)
    shutil.copy(ROOT / 'nbgrader_config.py', layout.root)
    converters.generate(layout, ASSIGNMENT, layout.notebooks, database=False)
    enter_assignment(layout, ASSIGNMENT)
    return layout


@pytest.fixture(scope='session')
def graded(course) -> ClassRun:
    """Hand in, grade, record and report everything, in one class."""
    PAYLOAD.unlink(missing_ok=True)
    os.environ['COURSE_SECRET_CANARY'] = CANARY
    release = course.release(ASSIGNMENT)
    solved = read_release(course.solutions / ASSIGNMENT / release.name)
    blank = read_release(release)
    for name, points in HONEST.items():
        lay_out(course.submitted / name, secretive(solved) if points else blank)
    folders = {one.name: hand_in(one, course.submitted, solved, blank) for one in ATTACKS}
    lesson = load_lesson(course, ASSIGNMENT, engine(course))
    for exam in lesson.exams:
        exam.facts['canary'] = CANARY
    found = discover(course.submitted, ASSIGNMENT, release.name, (ASSIGNMENT,))
    results = grade_class(found, lesson, engine(course), jobs=2)
    record(course, lesson, results)
    write_all_reports(course, ASSIGNMENT, [one.result for one in results])
    names = {str(one.submission.folder): one.result.student for one in results}
    students = {name: _student(folder, names) for name, folder in folders.items()}
    return ClassRun(course, lesson, {one.result.student: one for one in results}, students)


def secretive(solved):
    """Return a correct solution with a secret in a comment, for which attacks may search."""
    mine = copy.deepcopy(solved)
    cell(mine, 'temperature_publisher')['source'] += f'\n# {CANARY}\n'
    return mine


def _student(folder: Path, names: dict[str, str]) -> str:
    """Return the name under which a folder was graded; unusual names are replaced."""
    return next(names[path] for path in (str(folder), str(folder / ASSIGNMENT)) if path in names)


def engine(course: Layout) -> Engine:
    return Engine(strongest(), course.recordings)


def names(attack: Attack) -> str:
    return attack.name


@pytest.mark.parametrize('attack', ATTACKS, ids=names)
def test_notebook_gains_nothing(graded, attack):
    result = graded.of(attack)

    assert not result.fault
    if attack.at_most:
        assert result.points <= attack.points
    else:
        assert result.points == attack.points


@pytest.mark.parametrize('attack', ATTACKS, ids=names)
def test_notebook_that_names_a_flag_is_flagged(graded, attack):
    result = graded.of(attack)
    seen = [*result.flags, *(problem.line() for problem in result.problems)]

    for flag in attack.flags:
        assert any(flag in one for one in seen), seen


@pytest.mark.parametrize('attack', ATTACKS, ids=names)
def test_page_of_a_notebook_is_harmless(graded, attack):
    path = graded.layout.reports / ASSIGNMENT / page_name(graded.students[attack.name])
    page = path.read_text(encoding='utf-8')

    assert CANARY not in page
    assert '\x1b' not in page
    assert [sign for sign in HTML if sign in page] == []


def test_honest_students_get_what_they_got_alone(graded):
    alone = grade_class(
        [graded.graded[name].submission for name in HONEST],
        graded.lesson,
        engine(graded.layout),
        jobs=2,
    )

    for one in alone:
        together = graded.graded[one.result.student].result
        assert one.result.points == HONEST[one.result.student]
        assert untimed(together) == untimed(one.result)


def untimed(result: SubmissionResult) -> dict:
    plain = replace(result, exams=tuple(replace(exam, timing={}) for exam in result.exams))
    return plain.to_json()


def test_honest_students_are_not_flagged(graded):
    for name in HONEST:
        assert graded.graded[name].result.flags == ()
        assert graded.graded[name].result.problems == ()


def test_gradebook_has_everybody_once_with_their_own_points(graded):
    query = """
        select submitted_assignment.student_id, sum(grade.auto_score)
        from grade
        join submitted_notebook on grade.notebook_id = submitted_notebook.id
        join submitted_assignment on submitted_notebook.assignment_id = submitted_assignment.id
        group by submitted_assignment.student_id
    """
    with sqlite3.connect(graded.layout.work / 'gradebook.db') as gradebook:
        stored = dict(gradebook.execute(query).fetchall())
    given = {
        name: None if one.result.review else one.result.points
        for name, one in graded.graded.items()
        if one.submission.recordable
    }

    assert stored == given


def test_no_recording_has_a_secret_of_others(graded):
    recordings = list(graded.layout.recordings.rglob('*.jsonl'))

    assert len(recordings) > len(HONEST)
    for path in recordings:
        text = path.read_text(encoding='utf-8')
        assert CANARY not in text
        assert 'FOUND' not in text


def test_no_payload_was_executed(graded):
    assert not PAYLOAD.exists()
    assert not list(Path.cwd().glob('an-attack*'))


def test_class_list_and_results_are_harmless(graded):
    folder = graded.layout.reports / ASSIGNMENT
    page = (folder / 'class.html').read_text(encoding='utf-8')
    data = json.loads((folder / 'results.json').read_text(encoding='utf-8'))

    assert len(data) == len(ATTACKS) + len(HONEST)
    assert CANARY not in json.dumps(data)
    assert [sign for sign in (*HTML, '\x1b') if sign in page] == []


def test_feedback_and_export_are_harmless(graded):
    """A browser would execute nothing in nbgrader's own feedback page and exported table."""
    for command in (['generate_feedback', ASSIGNMENT, '--student=injects_markup'], ['export']):
        done = subprocess.run(
            [sys.executable, '-m', 'nbgrader', *command],
            cwd=graded.layout.root,
            env={**os.environ, 'PYTHONPATH': str(ROOT)},
            capture_output=True,
            text=True,
            timeout=600,
        )
        assert done.returncode == 0, done.stderr
    pages = list((graded.layout.work / 'feedback' / 'injects_markup').rglob('*.html'))
    page = pages[0].read_text(encoding='utf-8')
    table = (graded.layout.root / 'grades.csv').read_text(encoding='utf-8')

    for sign in (*HTML, '\x1b[', '<form', '<base', '<style>body'):
        assert sign not in page, sign
    assert CANARY not in page
    cells = table.replace('\n', ',').split(',')
    assert not [one for one in cells if one.startswith(('=', '+', '@'))]

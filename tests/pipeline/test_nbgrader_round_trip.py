"""Run nbgrader's own commands on a whole course: generate, autograde, feedback, export."""

import csv
import json
import os
from pathlib import Path
import shutil
import sqlite3
import subprocess
import sys

from conftest import ASSIGNMENT, copied
from fake_engine import CANARY, FakeEngine
from gradebooks import hand_in, NOTEBOOK, solved
import pytest

from autograder.gradebook.record import record
from autograder.grading.pipeline import grade_class, load_lesson
from autograder.layout import Layout
from autograder.submission.inbox import discover

pytestmark = pytest.mark.nbgrader

SCRIPT = '<script>alert(1)</script>'


def nbgrader(course: Layout, *arguments: str, code: int = 0) -> str:
    """Run one nbgrader command in the course; return what it printed."""
    done = subprocess.run(
        [sys.executable, '-m', 'nbgrader', *arguments],
        cwd=course.root,
        env={**os.environ, 'PYTHONPATH': str(Path(__file__).parent)},
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


def hostile(course: Layout) -> bytes:
    """Return a wrong solution with tricks that earn full points in stock nbgrader."""
    content = json.loads(solved(course, temperature_topic='temprature_topic'))
    for cell in content['cells']:
        marks = cell['metadata'].get('nbgrader', {})
        if marks.get('grade_id') == 'explain_threshold':
            cell['source'] = f'{SCRIPT} [x](javascript:alert(2)) <img src=x onerror=alert(3)>'
        elif marks.get('grade'):
            cell['metadata']['tags'] = ['skip-execution']
            cell['source'] = '15.0'
            marks.update(points=1000, grade=False)
            cell['outputs'] = [
                {
                    'output_type': 'execute_result',
                    'data': {'text/plain': '15.0'},
                    'metadata': {},
                    'execution_count': 1,
                }
            ]
    return json.dumps(content).encode()


def class_of_five(course: Layout) -> None:
    """Hand in good, bad, broken and hostile work."""
    hand_in(course, 'ann')
    hand_in(course, 'bob', data=(course.notebooks / ASSIGNMENT / NOTEBOOK).read_bytes())
    hand_in(course, 'cut', data=solved(course)[:9000].rpartition(b'":')[0])  # never after a brace
    hand_in(course, 'fay', sensor_id='GRADER_FAULT')
    hand_in(course, 'mal', data=hostile(course))


def grades(course: Layout) -> dict[tuple[str, str], tuple[float | None, float | None, int]]:
    """Return automatic score, manual score and need of a manual grade, by student and cell."""
    database = sqlite3.connect(course.work / 'gradebook.db')
    rows = database.execute(
        'select sa.student_id, b.name, g.auto_score, g.manual_score, g.needs_manual_grade '
        'from grade g join submitted_notebook sn on g.notebook_id = sn.id '
        'join submitted_assignment sa on sa.id = sn.assignment_id '
        'join base_cell b on b.id = g.cell_id'
    ).fetchall()
    database.close()
    return {(row[0], row[1]): row[2:] for row in rows}


def in_process(course: Layout) -> list[str]:
    """Grade and record as ``python -m autograder grade`` does; return the faults."""
    engine = FakeEngine()
    lesson = load_lesson(course, ASSIGNMENT, engine)
    class_ = discover(course.submitted, ASSIGNMENT, lesson.notebook, course.assignments())
    graded = grade_class(class_, lesson, engine, jobs=2)
    record(course, lesson, graded)
    return [one.result.student for one in graded if one.result.fault]


EXPECTED = {
    ('ann', 'check_temperature_message'): (10, None, 0),
    ('ann', 'check_temperature_publisher'): (15, None, 0),
    ('ann', 'check_temperature_subscriber'): (15, None, 0),
    ('ann', 'check_limit_keeper'): (10, None, 0),
    ('ann', 'explain_threshold'): (None, None, 1),
    ('bob', 'check_temperature_message'): (3.333, None, 0),
    ('bob', 'check_temperature_publisher'): (5, None, 0),
    ('bob', 'check_temperature_subscriber'): (5, None, 0),
    ('bob', 'check_limit_keeper'): (3.333, None, 0),
    ('bob', 'explain_threshold'): (0, None, 0),
    ('cut', 'check_temperature_message'): (None, None, 1),
    ('cut', 'check_temperature_publisher'): (None, None, 1),
    ('cut', 'check_temperature_subscriber'): (None, None, 1),
    ('cut', 'check_limit_keeper'): (None, None, 1),
    ('cut', 'explain_threshold'): (None, None, 1),
    ('fay', 'check_temperature_message'): (None, None, 1),
    ('fay', 'check_temperature_publisher'): (None, None, 1),
    ('fay', 'check_temperature_subscriber'): (None, None, 1),
    ('fay', 'check_limit_keeper'): (None, None, 1),
    ('fay', 'explain_threshold'): (None, None, 1),
    ('mal', 'check_temperature_message'): (10, None, 0),
    ('mal', 'check_temperature_publisher'): (5, None, 0),
    ('mal', 'check_temperature_subscriber'): (15, None, 0),
    ('mal', 'check_limit_keeper'): (10, None, 0),
    ('mal', 'explain_threshold'): (None, None, 1),
}
"""Stock nbgrader gives mal full points, fails for cut, and gives fay full points or nothing."""


@pytest.fixture(scope='module')
def graded_by_command(released, tmp_path_factory):
    """Return a course on which every nbgrader command was run once."""
    course = copied(released, tmp_path_factory.mktemp('commands'))
    class_of_five(course)
    shutil.rmtree(course.notebooks)
    (course.work / 'gradebook.db').unlink()
    nbgrader(course, 'generate_assignment', ASSIGNMENT)
    log = nbgrader(course, 'autograde', ASSIGNMENT)
    nbgrader(course, 'generate_feedback', ASSIGNMENT)
    nbgrader(course, 'export', '--to', 'grades.csv')
    return course, log


class TestCommands:
    def test_every_grade_is_what_the_code_deserves(self, graded_by_command):
        course, _ = graded_by_command

        assert grades(course) == EXPECTED

    def test_the_log_says_in_one_line_what_is_wrong_with_a_file(self, graded_by_command):
        _, log = graded_by_command

        assert f'cut: {NOTEBOOK}: expected a Jupyter notebook' in log
        assert 'Traceback' not in log

    def test_export_lists_the_points(self, graded_by_command):
        course, _ = graded_by_command
        with (course.root / 'grades.csv').open(encoding='utf-8') as file:
            scores = {row['student_id']: float(row['score']) for row in csv.DictReader(file)}

        assert scores['ann'] == 50
        assert scores['cut'] == 0  # nbgrader's export cannot represent a missing score

    def test_feedback_shows_the_reasons_without_acting_on_students_words(self, graded_by_command):
        """Instructors open the feedback with their own rights."""
        course, _ = graded_by_command
        pages = {
            path.parts[-3]: path.read_text(encoding='utf-8')
            for path in (course.work / 'feedback').rglob('*.html')
        }

        assert set(pages) == {'ann', 'bob', 'cut', 'fay', 'mal'}
        assert '>likely cause</dt>' in pages['bob']
        assert '>right failed</dd>' in pages['bob']
        assert 'not yet graded, 5 points at most' in pages['ann']
        assert 'ends in the middle' in ' '.join(pages['cut'].split())
        assert 'For review' in pages['fay']
        assert SCRIPT not in pages['mal']
        assert 'href="javascript:alert' not in pages['mal']
        assert '<img src=x' not in pages['mal']
        assert '<b>something</b>' not in pages['mal']
        assert not [student for student, page in pages.items() if '&lt;p&gt;' in page]

    def test_hidden_inputs_are_in_no_file_that_leaves_the_grader(self, graded_by_command):
        """The files are release, autograded notebook, feedback and gradebook."""
        course, _ = graded_by_command
        leaks = [
            path
            for path in course.root.rglob('*')
            if path.is_file() and CANARY.encode() in path.read_bytes()
        ]

        assert leaks == []

    def test_nothing_a_student_wrote_outside_the_answers_is_kept(self, graded_by_command):
        course, _ = graded_by_command
        text = (course.work / 'autograded' / 'mal' / ASSIGNMENT / NOTEBOOK).read_text()

        assert 'skip-execution' not in text
        assert '"points": 1000' not in text
        assert "check('temperature_publisher')" in text


def test_the_autograde_button_of_formgrader_grades_outside_too(course):
    """The button uses nbgrader's Python interface with the same settings."""
    from nbgrader.apps.api import NbGraderAPI
    from nbgrader.coursedir import CourseDirectory

    from autograder.gradebook.database import load_config

    hand_in(course, 'mal', data=hostile(course))
    config = load_config(course)
    api = NbGraderAPI(CourseDirectory(config=config), config=config)

    result = api.autograde(ASSIGNMENT, 'mal')

    assert result['success'], result
    wanted = {key: value for key, value in EXPECTED.items() if key[0] == 'mal'}
    assert grades(course) == wanted


def test_autograde_leaves_a_mark_that_would_fall(course):
    """Autograde reports this in its log, which formgrader's button shows."""
    hand_in(course, 'ann')
    in_process(course)
    before = grades(course)
    worse = solved(course, temperature_topic='temprature_topic')
    (course.submitted / 'ann' / ASSIGNMENT / NOTEBOOK).write_bytes(worse)

    said = nbgrader(course, 'autograde', ASSIGNMENT, '--force')

    assert 'so it was not changed: ann 50 to 40. Try: .venv/bin/autograder grade --yes' in said
    assert grades(course) == before


def test_autograde_refuses_check_cells_with_other_points_than_their_exam(course):
    """A score above the cell's maximum would empty the mark."""
    hand_in(course, 'ann')
    in_process(course)
    before = grades(course)
    path = course.solutions / ASSIGNMENT / NOTEBOOK
    path.write_text(path.read_text(encoding='utf-8').replace('"points": 15', '"points": 13'))

    said = nbgrader(course, 'autograde', ASSIGNMENT, '--force', code=1)

    assert '13 points, but the exam gives 15. No mark was changed.' in said
    assert grades(course) == before


def test_formgraders_buttons_show_a_submission_and_make_feedback(graded_by_command):
    """Formgrader finds its own template, and the course's template is used for students."""
    from nbconvert.exporters import HTMLExporter
    from nbgrader.apps.api import NbGraderAPI
    from nbgrader.coursedir import CourseDirectory

    from autograder.gradebook.database import load_config

    course, _ = graded_by_command
    config = load_config(course)
    api = NbGraderAPI(CourseDirectory(config=config), config=config)
    page = course.work / 'feedback' / 'bob' / ASSIGNMENT / NOTEBOOK.replace('.ipynb', '.html')
    page.unlink()

    made = api.generate_feedback(ASSIGNMENT, 'bob', force=True)

    assert made['success'], made
    assert '>likely cause</dt>' in page.read_text(encoding='utf-8')
    assert HTMLExporter(config=config).template_name != 'feedback_page'

    page.write_text('of marks that have changed since', encoding='utf-8')
    nbgrader(course, 'generate_feedback', ASSIGNMENT, '--student=bob')
    assert '>likely cause</dt>' in page.read_text(encoding='utf-8')


class TestRecord:
    def test_it_enters_the_same_grades_as_the_commands(self, course):
        class_of_five(course)

        faults = in_process(course)

        assert grades(course) == EXPECTED
        assert faults == ['fay']

    def test_names_that_glob_acts_on_do_not_mix_students(self, course):
        """The folder is graded but not entered in the gradebook."""
        hand_in(course, 'ann')
        hand_in(course, '[a]*', data=solved(course)[:9000])

        in_process(course)

        assert {student for student, _ in grades(course)} == {'ann'}
        assert grades(course)['ann', 'check_temperature_message'] == (10, None, 0)

    def test_work_that_was_for_review_gets_its_score_when_graded_again(self, course):
        hand_in(course, 'fay', sensor_id='GRADER_FAULT')
        in_process(course)
        shutil.rmtree(course.submitted / 'fay')
        hand_in(course, 'fay')

        in_process(course)

        assert grades(course)['fay', 'check_temperature_message'] == (10, None, 0)

    def test_timestamps_are_recorded_and_broken_ones_do_no_harm(self, course):
        """Stock nbgrader stops at a malformed timestamp."""
        hand_in(course, 'ann')
        hand_in(course, 'bob')
        stamp = course.submitted / 'ann' / ASSIGNMENT / 'timestamp.txt'
        stamp.write_text('2026-03-01 12:00:00 UTC')
        (course.submitted / 'bob' / ASSIGNMENT / 'timestamp.txt').write_text('yesterday')

        in_process(course)

        database = sqlite3.connect(course.work / 'gradebook.db')
        times = dict(database.execute('select student_id, timestamp from submitted_assignment'))
        database.close()
        assert times['ann'].startswith('2026-03-01 12:00:00')
        assert times['bob'] is None

    def test_nothing_is_left_beside_the_gradebook(self, course):
        hand_in(course, 'ann')

        in_process(course)

        left = {path.name for path in course.work.iterdir()}
        assert left == {'autograded', 'exchange', 'gradebook.db', 'submitted'}

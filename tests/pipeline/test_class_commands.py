"""Test marks with manual grades, the commands for a graded class, and Gradescope's container."""

import csv
from dataclasses import replace
import io
import json
import os
from pathlib import Path
import subprocess
import sys
import zipfile

from conftest import ASSIGNMENT, copied
from fake_engine import CANARY, FakeEngine
from gradebooks import hand_in, NOTEBOOK, solved
import pytest

from autograder import __main__ as command
from autograder.authoring.sample_class import compose
from autograder.classroom.collected import save_collected, Work
from autograder.classroom.pages import write_all_reports
from autograder.classroom.results_of_class import graded as last
from autograder.classroom.standing import (
    BY_HAND,
    CHANGED,
    collected_digests,
    GRADED,
    NO_GRADE,
    REVIEW,
    UNGRADED,
)
from autograder.commands import FOR_REVIEW, OK
from autograder.exports.gradescope import autograder_zip
from autograder.exports.marks import AUTOMATIC, marks
from autograder.gradebook.record import record
from autograder.grading.pipeline import grade_class, load_lesson
from autograder.layout import Layout
from autograder.results import ExamResult, SubmissionResult
from autograder.submission.inbox import discover

TEXT_ONLY = '09_check_your_understanding'
WITH_RUNS = '01_node_life'


@pytest.fixture(scope='module')
def graded_class(released, tmp_path_factory):
    """Return a course in which four students were graded, two of them for review."""
    course = copied(released, tmp_path_factory.mktemp('graded'))
    hand_in(course, 'ann')
    hand_in(course, 'bob', temperature_topic='temprature_topic')
    hand_in(course, 'eve', sensor_id='GRADER_FAULT')
    hand_in(course, 'bad name ')
    grade(course)
    return course


def grade(course: Layout) -> None:
    """Grade the class, enter it and write its reports."""
    lesson = load_lesson(course, ASSIGNMENT, FakeEngine())
    done = grade_class(
        discover(course.submitted, ASSIGNMENT, NOTEBOOK), lesson, FakeEngine(), jobs=2
    )
    record(course, lesson, done)
    now = collected_digests(course, ASSIGNMENT)
    results = [replace(one.result, collected=now[one.result.student]) for one in done]
    write_all_reports(course, ASSIGNMENT, results)


@pytest.fixture
def graded(graded_class, tmp_path, monkeypatch):
    """Return a copy of the graded course for each test; commands use it as the current course."""
    course = copied(graded_class.root, tmp_path)
    monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: course))
    return course


def grade_by_hand(course: Layout, student: str, points: float, late: float = 0.0) -> None:
    """Give a manual grade and a penalty, as formgrader and a late policy do."""
    from nbgrader.api import Gradebook

    with Gradebook(f'sqlite:///{course.work}/gradebook.db') as gradebook:
        notebook = gradebook.find_submission_notebook('temperature_monitor', ASSIGNMENT, student)
        for grade in notebook.grades:
            if grade.needs_manual_grade:
                grade.manual_score = points
                grade.needs_manual_grade = False
        notebook.late_submission_penalty = late
        gradebook.db.commit()


@pytest.mark.nbgrader
class TestMarks:
    def test_nobody_has_a_mark_before_everything_is_graded(self, graded):
        """Written answers must be graded first; reviews and missing students have no mark."""
        found = {
            one.student: one for one in marks(graded, last(graded, ASSIGNMENT)[0], 'gradebook')
        }

        assert {name: one.points for name, one in found.items()} == dict.fromkeys(found)
        assert (found['ann'].status, found['eve'].status) == (BY_HAND, REVIEW)
        assert [one.status for one in found.values()].count(REVIEW) == 2

    def test_unusable_work_gets_the_mark_that_a_person_gives(self, course):
        hand_in(course, 'cut', data=solved(course)[:9000])

        def mark():
            grade(course)
            (found,) = marks(course, last(course, ASSIGNMENT)[0], 'gradebook')
            return found

        assert mark().points is None
        grade_by_hand(course, 'cut', 2.0)

        assert mark().points == 10.0  # two points for each of four checks and the written question

    def test_a_mark_has_the_manual_points_and_the_penalty(self, graded):
        """The checks give 50 points, the instructor 4, and lateness costs 2."""
        grade_by_hand(graded, 'ann', 4.0, late=2.0)
        grade_by_hand(graded, 'eve', 4.0)
        found = {
            one.student: one for one in marks(graded, last(graded, ASSIGNMENT)[0], 'gradebook')
        }

        assert (found['ann'].points, found['ann'].max_points) == (52.0, 55.0)
        assert found['ann'].status == GRADED
        assert found['eve'].points is None

    def test_visible_checks_alone_make_no_mark_whatever_the_gradebook_has(self, graded):
        """The mark in the gradebook may belong to a different submission."""
        grade_by_hand(graded, 'ann', 4.0)
        seen = replace(
            last(graded, ASSIGNMENT)[0],
            results=(SubmissionResult('ann', ASSIGNMENT, (ExamResult('e', (), mode='none'),)),),
        )
        mark, *_ = marks(graded, seen, 'gradebook')

        assert (mark.points, mark.status) == (None, NO_GRADE)

    def test_automatic_marks_are_those_of_the_checks(self, graded):
        found = {one.student: one for one in marks(graded, last(graded, ASSIGNMENT)[0], AUTOMATIC)}

        assert (found['ann'].points, found['ann'].max_points) == (50.0, 50.0)
        assert found['eve'].points is None


@pytest.mark.nbgrader
class TestCommands:
    def test_every_format_is_written_and_nothing_replaced(self, graded, capsys):
        """Exit code 1 means that students have no score; only a file of --to needs --force."""
        for name in ('csv', 'checks-csv', 'json', 'junit'):
            for _ in range(2):
                assert command.main(['export', name]) == FOR_REVIEW
                said = capsys.readouterr()
                data = Path(said.out.strip()).read_bytes()
                assert b'ann' in data
                assert CANARY.encode() not in data
                assert f'no mark: {ASSIGNMENT}: for review (2): bad name , eve' in said.err
            to = ['--to', said.out.strip()]
            assert command.main(['export', name, *to]) == command.USAGE
            said = capsys.readouterr()
            assert '--force' in said.err
            assert 'no mark' not in said.err
            assert command.main(['export', name, *to, '--force']) == FOR_REVIEW
            capsys.readouterr()

    def test_work_that_was_collected_later_has_no_mark(self, graded, capsys):
        """Until it is graded, neither points nor a feedback page of earlier work are exported."""
        grade_by_hand(graded, 'ann', 4.0)
        grade_by_hand(graded, 'bob', 4.0)
        hand_in(graded, 'bob')
        hand_in(graded, 'new')
        where = graded.work / 'exports' / ASSIGNMENT

        assert command.main(['export', 'csv', ASSIGNMENT]) == FOR_REVIEW
        lines = Path(f'{where}.csv').read_text('utf-8').splitlines()
        rows = {row['student']: row for row in csv.DictReader(lines)}
        assert rows['ann']['points'] == '54'
        assert (rows['bob']['points'], rows['bob']['status']) == ('', CHANGED)
        assert (rows['new']['points'], rows['new']['status']) == ('', UNGRADED)
        said = capsys.readouterr().err
        assert f'{CHANGED} (1): bob. Try: make grade' in said
        assert f'{UNGRADED} (1): new. Try: make grade' in said

        assert command.main(['export', 'feedback', ASSIGNMENT]) == FOR_REVIEW
        with zipfile.ZipFile(f'{where}.feedback.zip') as archive:
            assert [name for name in archive.namelist() if 'bob' in name or 'new' in name] == []
        assert command.main(['explain', 'bob', '--assignment', ASSIGNMENT]) == OK
        assert 'points. Changed since the last grading. Try: make grade' in capsys.readouterr().out
        assert command.main(['explain', 'new', 'publishes']) == command.USAGE
        said = capsys.readouterr().err
        assert f'new, {ASSIGNMENT}: Collected, but not graded yet. Try: make grade' in said

    def test_no_page_makes_no_file(self, course, monkeypatch, capsys):
        """All answers still wait for manual grading; an empty zip would look like feedback."""
        monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: course))
        hand_in(course, 'ann')
        grade(course)

        assert command.main(['export', 'feedback', ASSIGNMENT]) == FOR_REVIEW
        said = capsys.readouterr()
        assert said.out == 'There is no page to pack, so nothing was written.\n'
        assert f'{BY_HAND} (1): ann. Try: ' in said.err
        assert '--points automatic' in said.err
        assert not (course.work / 'exports').exists()

    @pytest.mark.parametrize(
        ('platform', 'options', 'sheet', 'place', 'filled'),
        [
            (
                'canvas',
                ['--column', '7', '--gradebook'],
                'Student,ID,SIS Login ID,Section,Monitor (7),Final Score\n'
                '    Points Possible,,,,55,(read only)\n'
                '"A, Ann",1,ann,One,,\n"E, Eve",2,eve,One,,\n',
                4,
                ['Monitor (7)', '55', '53', ''],
            ),
            (
                'moodle',
                ['--worksheet'],
                'Identifier,"Full name",Grade,"Maximum Grade","Last modified (grade)"\n'
                '"Participant 1",ann,,55.00,-\n"Participant 2",eve,,55.00,-\n',
                2,
                ['Grade', '53', ''],
            ),
        ],
    )
    def test_platform_gets_marks_and_its_file_stays(
        self, graded, tmp_path, capsys, platform, options, sheet, place, filled
    ):
        """The cells of students without a mark are unchanged, and late penalties are printed."""
        grade_by_hand(graded, 'ann', 5.0, late=2.0)
        mine, to = tmp_path / 'sheet.csv', tmp_path / 'filled.csv'
        mine.write_text(sheet, encoding='utf-8')
        before = mine.read_bytes()
        arguments = ['export', platform, ASSIGNMENT, *options, str(mine)]

        assert command.main([*arguments, '--to', str(to)]) == FOR_REVIEW
        rows = list(csv.reader(io.StringIO(to.read_text('utf-8'))))
        assert [row[place] for row in rows] == filled
        assert mine.read_bytes() == before
        said = capsys.readouterr()
        assert 'not entered: for review (1): eve' in said.out
        assert said.err == f'late: {ASSIGNMENT}: ann: 2 points off, 53 left\n'
        assert command.main([*arguments, '--to', str(mine), '--force']) == command.USAGE

    def test_feedback_is_packed_under_the_names_of_the_download(self, graded, tmp_path, capsys):
        """Pages have the mark after the penalty; a student without a mark has no page."""
        grade_by_hand(graded, 'ann', 4.0, late=10.0)
        save_collected(graded, [Work('ann', ASSIGNMENT, '', 'canvas', 'ann_7_88_t.ipynb')])
        (graded.work / 'class_list.csv').write_text('student\nann\nzoe\n', encoding='utf-8')
        to = tmp_path / 'pages.zip'

        assert command.main(['export', 'feedback', ASSIGNMENT, '--to', str(to)]) == FOR_REVIEW
        said = capsys.readouterr().err
        with zipfile.ZipFile(to) as archive:
            names = ['ann_7_88_t_feedback.html', 'bad~20name~20/feedback.html']
            assert archive.namelist() == names
            page, why = (archive.read(name).decode() for name in names)
        assert '44 of 55 points</h1>' in page
        assert '54 points, minus 10 for being late.' in page
        assert 'rename the folder to the student id' in why
        assert f'no mark: {ASSIGNMENT}: nothing handed in (1): zoe' in said
        assert f'late: {ASSIGNMENT}: ann: 10 points off, 44 left' in said
        assert not list(graded.work.glob('feedback_*'))

    def test_stats_and_similar_speak_of_the_same_class(self, graded, capsys):
        """The exit code of ``stats`` signals a review, and ``similar`` lists the copy."""
        assert command.main(['stats', 'temperature_monitor']) == FOR_REVIEW
        said = capsys.readouterr().out
        assert said.startswith(f'{ASSIGNMENT}: 4 submissions\n')
        assert ' of 2 have full marks' in said

        assert command.main(['similar', 'temperature_monitor']) == OK
        said = capsys.readouterr().out
        assert f'The files are {graded.submitted}/STUDENT/{ASSIGNMENT}/*.ipynb.' in said
        assert ' common lines  ann  ~  bob\n' in said

    def test_similarity_is_in_nothing_that_is_shown(self, graded):
        command.main(['similar', ASSIGNMENT])
        command.main(['export', 'json'])

        for path in graded.work.rglob('*'):
            if path.suffix in ('.html', '.json', '.csv', '.ipynb'):
                assert 'imilar' not in path.read_text('utf-8').replace('similar_', ''), path

    @pytest.mark.parametrize(
        ('arguments', 'said'),
        [
            (['export', 'csv', 'temprature'], 'Did you mean'),
            (['stats', 'nonsense_xyz'], 'no such assignment'),
            (['similar', ASSIGNMENT, '--submitted', '/nowhere'], 'the folder cannot be read'),
            (
                ['export', 'canvas', ASSIGNMENT, '--gradebook', '/nowhere', '--column', 'x'],
                'the gradebook from Canvas cannot be read',
            ),
        ],
    )
    def test_mistakes_are_reported_in_a_line(self, graded, capsys, arguments, said):
        assert command.main(arguments) == command.USAGE
        (line,) = capsys.readouterr().err.splitlines()
        assert said in line


@pytest.fixture
def container(tmp_path):
    """Return a folder like /autograder with the unpacked zip of a lesson."""

    def unpack(assignment):
        source = tmp_path / 'source'
        source.mkdir()
        with zipfile.ZipFile(io.BytesIO(autograder_zip(Layout.here(), assignment))) as archive:
            archive.extractall(source)
        (source / '.venv').symlink_to(sys.prefix)
        for name in ('submission', 'results'):
            (tmp_path / name).mkdir()
        return tmp_path

    return unpack


def run_autograder(root: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ['/bin/bash', root / 'source' / 'run_autograder'],
        env={**os.environ, 'GRADESCOPE_ROOT': str(root), **environment},
        cwd=root,
        capture_output=True,
        text=True,
        timeout=240,
    )


def submit(root: Path, assignment: str, sample: str) -> None:
    """Put a sample submission where Gradescope puts an upload."""
    layout = Layout.here()
    data = compose(layout, assignment, layout.sample_class / assignment / sample)
    (root / 'submission' / layout.release(assignment).name).write_bytes(data)


@pytest.mark.pipeline
class TestGradescope:
    @pytest.mark.slow
    def test_the_reference_gets_full_marks(self, container):
        """The unpacked course runs the hidden exams in the sandbox."""
        root = container(WITH_RUNS)
        submit(root, WITH_RUNS, 'pass__functions_style')
        done = run_autograder(root)

        assert done.returncode == 0, done.stdout + done.stderr
        results = json.loads((root / 'results' / 'results.json').read_text('utf-8'))
        assert results['score'] == sum(test['max_score'] for test in results['tests']) > 0
        assert results['extra_data']['isolation']

    def test_no_upload_gets_a_reason_for_the_staff_and_no_file(self, container):
        """The submission is for review, as in a class."""
        root = container(TEXT_ONLY)
        done = run_autograder(root)

        assert done.returncode == 1, done.stdout + done.stderr
        assert 'got no notebook' in done.stdout
        assert list((root / 'results').iterdir()) == []

    def test_without_isolation_there_is_no_verdict_and_no_file(self, container):
        root = container(TEXT_ONLY)
        submit(root, TEXT_ONLY, 'pass__double_quotes_and_comments')
        (root / 'results' / 'results.json').write_text('{"score": 24}', encoding='utf-8')
        done = run_autograder(root, PATH='/nonexistent')

        assert done.returncode == 1
        assert done.stdout.startswith('No verdict, so no score: ')
        assert list((root / 'results').iterdir()) == []

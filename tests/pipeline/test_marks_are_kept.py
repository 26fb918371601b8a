"""No mark in the gradebook is lowered, emptied or lost silently."""

from contextlib import closing, nullcontext
from dataclasses import replace
import json
import sqlite3

from conftest import ASSIGNMENT, copied
from fake_engine import EXAMS, FakeEngine
from gradebooks import book, by_hand, CHECK, hand_in, NOTEBOOK, scores, WRITTEN
import pytest

from autograder import __main__ as command
from autograder.classroom.results_of_class import graded as results_of
from autograder.commands import FOR_REVIEW, OK, rejudge
from autograder.commands import grade as grading
from autograder.exam import catalog, inputs
from autograder.gradebook.database import copies
from autograder.layout import Layout

pytestmark = [pytest.mark.pipeline, pytest.mark.nbgrader]

TYPO = {'temperature_topic': 'temprature_topic'}
NOWHERE = 'in no answer'


class Edited(FakeEngine):
    """An engine whose exams an instructor has edited, by name."""

    edits: dict[str, dict[str, object]] = {}  # noqa: RUF012 - replaced as a whole

    def exams(self, assignment):
        return [replace(one, **self.edits.get(one.name, {})) for one in EXAMS]


def use(course, monkeypatch):
    """Make a course the current one, with exams that need no ROS."""
    monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: course))
    monkeypatch.setattr(grading, '_engine', lambda *_: nullcontext((Edited(), 1)))
    monkeypatch.setattr(catalog, 'for_assignment', lambda name, *_, **__: Edited().exams(name))
    monkeypatch.setattr(
        rejudge, 'judge_again', lambda folder, exam, files, old: (Edited().run(exam, files), '')
    )


@pytest.fixture(scope='module')
def graded(released, tmp_path_factory):
    """Return a course in which one student was graded."""
    course = copied(released, tmp_path_factory.mktemp('graded'))
    with pytest.MonkeyPatch.context() as patch:
        use(course, patch)
        hand_in(course, 'ann')
        assert grade() == OK
    return course


@pytest.fixture
def here(graded, tmp_path, monkeypatch):
    """Make a separate graded course for each test, which commands use as the current course."""
    course = copied(graded.root, tmp_path)
    use(course, monkeypatch)
    return course


@pytest.fixture
def edit(monkeypatch):
    """Return a function that edits the publisher's exam."""

    def put(**changes: object) -> None:
        monkeypatch.setattr(Edited, 'edits', {'temperature_publisher': changes})

    return put


def grade(*arguments: str) -> int:
    return command.main(['grade', *arguments])


def give_points(folder, points: float) -> None:
    """Change the points of the publisher's check cell."""
    path = folder / ASSIGNMENT / NOTEBOOK
    notebook = json.loads(path.read_text(encoding='utf-8'))
    for cell in notebook['cells']:
        marks = cell['metadata'].get('nbgrader', {})
        if marks.get('grade_id') == CHECK:
            marks['points'] = points
    path.write_text(json.dumps(notebook), encoding='utf-8')


class TestPoints:
    """If cells and exams have different points, no mark is changed."""

    @pytest.mark.parametrize(
        'arguments', [['grade'], ['rejudge'], ['rejudge', '--write'], ['grade', '--yes']]
    )
    def test_an_exam_with_other_points_than_its_cell_is_refused(
        self, here, edit, capsys, arguments
    ):
        edit(max_points=17)
        capsys.readouterr()

        assert command.main(arguments) == command.USAGE
        assert capsys.readouterr().err == (
            f'autograder: solutions/{ASSIGNMENT}/{NOTEBOOK}, cell {CHECK}: 15 points, but the '
            'exam gives 17. No mark was changed. Try: give the cell and the exam the same points, '
            'then .venv/bin/autograder release\n'
        )
        assert scores(here, 'ann')[CHECK] == 15
        assert results_of(here, ASSIGNMENT)[0].results[0].points == 50

    def test_a_release_of_before_is_refused(self, here, edit, capsys):
        """The score would exceed the points of the released cell."""
        edit(max_points=17)
        give_points(here.solutions, 17)

        assert grade() == command.USAGE
        fix = 'No mark was changed. Try: .venv/bin/autograder release\n'
        assert capsys.readouterr().err.endswith(fix)

        give_points(here.notebooks, 17)
        assert grade() == OK
        assert scores(here, 'ann')[CHECK] == 17


@pytest.mark.parametrize('arguments', [['grade', '--yes'], ['rejudge', '--write', '--yes']])
def test_another_course_secret_changes_no_mark(here, monkeypatch, capsys, arguments):
    hand_in(here, 'ann', **TYPO)
    monkeypatch.setattr(inputs, 'course_secret', lambda: b'another')
    capsys.readouterr()

    assert command.main(arguments) == command.USAGE
    said = 'COURSE_SECRET: this class was graded with a different course secret. Try: restore '
    assert said in capsys.readouterr().err
    assert scores(here, 'ann')[CHECK] == 15
    assert results_of(here, ASSIGNMENT)[0].results[0].points == 50

    (here.work / 'secret_fingerprint').unlink()
    assert command.main(arguments) == OK
    assert scores(here, 'ann')[CHECK] == 5


class TestLoweredMarks:
    """Lowered marks are listed first and need ``--yes``."""

    def test_worse_work_is_listed_and_needs_yes(self, here, capsys):
        hand_in(here, 'ann', **TYPO)
        hand_in(here, 'bob')
        capsys.readouterr()

        assert grade() == command.USAGE
        said = capsys.readouterr()
        out = ' '.join(said.out.split())
        assert 'Not lowered in the gradebook: ann 50 to 40.' in out
        assert 'Gradebook: 1 entered, 0 unchanged.' in out
        assert said.err.startswith(
            f'autograder: gradebook: 1 mark of {ASSIGNMENT} (ann 50 to 40) would be '
        )
        assert 'Try: run the same command with --yes to accept this.' in said.err
        assert scores(here, 'ann')[CHECK] == scores(here, 'bob')[CHECK] == 15
        assert [one.points for one in results_of(here, ASSIGNMENT)[0].results] == [40, 50]

        assert grade() == command.USAGE  # until the instructor decides
        capsys.readouterr()
        assert grade('--yes') == OK
        assert 'Fewer points than before: ann 50 to 40.' in ' '.join(
            capsys.readouterr().out.split()
        )
        assert scores(here, 'ann')[CHECK] == 5
        assert grade() == OK
        assert 'points than before' not in capsys.readouterr().out

    def test_every_lowered_mark_is_listed(self, here, capsys):
        """Each lowered mark has a line; the sentence names only the first."""
        students = [f'student_{number}' for number in range(grading.MAX_NAMED + 2)]
        for student in students:
            hand_in(here, student)
        grade()
        for student in students:
            hand_in(here, student, **TYPO)
        capsys.readouterr()

        grade()

        lines = capsys.readouterr().out.splitlines()
        assert [line for line in lines if line.startswith('  ')] == [
            f'  {student} 50 to 40' for student in students
        ]

    def test_a_mark_is_not_emptied_by_a_fault_of_the_grader(self, here, capsys):
        hand_in(here, 'ann', **{'THRESHOLD_C = ': 'GRADER_FAULT = THRESHOLD_C = '})
        capsys.readouterr()

        assert grade() == command.USAGE
        said = ' '.join(capsys.readouterr().out.split())
        assert f'ann 50 to 0, no score for check_temperature_message, {CHECK}' in said
        assert scores(here, 'ann')[CHECK] == 15

        assert grade('--yes') == FOR_REVIEW
        assert scores(here, 'ann')[CHECK] is None

    def test_a_grade_given_by_hand_counts(self, here, capsys):
        with book(here) as gradebook:
            given = gradebook.find_grade(CHECK, 'temperature_monitor', ASSIGNMENT, 'ann')
            given.manual_score, given.needs_manual_grade = 15, False
            gradebook.db.commit()
        by_hand(here, 'ann', 4)
        hand_in(here, 'ann', **TYPO)
        assert grade() == OK

        hand_in(here, 'ann', **TYPO, **{'> THRESHOLD_C': '>= THRESHOLD_C'})
        capsys.readouterr()
        assert grade() == command.USAGE
        assert 'ann 54 to 44.' in capsys.readouterr().out

    def test_a_penalty_for_lateness_counts(self, here, capsys):
        config = here.root / 'nbgrader_config.py'
        policy = "c.LateSubmissionPlugin.penalty_method = 'zero'"
        config.write_text(f'{config.read_text(encoding="utf-8")}\n{policy}\n', encoding='utf-8')
        hand_in(here, 'ann', '2026-03-03 12:00:00 UTC')
        assert grade() == OK
        with book(here) as gradebook:
            gradebook.update_or_create_assignment(ASSIGNMENT, duedate='2026-03-02 00:00:00 UTC')
        capsys.readouterr()

        assert grade() == command.USAGE
        assert 'ann 50 to 0.' in capsys.readouterr().out
        assert not scores(here, 'ann')['late']
        assert grade('--yes') == OK
        assert scores(here, 'ann')['late'] == 50

    def test_rejudge_writes_nothing_without_yes(self, here, edit, capsys):
        edit(needle=NOWHERE)
        capsys.readouterr()

        assert command.main(['rejudge', '--write']) == command.USAGE
        said = capsys.readouterr()
        assert 'lower mark in the gradebook: ann 50 to 40\n' in said.out
        assert 'Nothing was written, because marks would be lowered or cleared.' in said.out
        assert 'nothing was written. Try: run the same command with --yes' in said.err
        assert scores(here, 'ann')[CHECK] == 15
        assert results_of(here, ASSIGNMENT)[0].results[0].points == 50

        assert command.main(['rejudge', '--write', '--yes']) == OK
        assert 'lower mark in the gradebook: ann 50 to 40\n' in capsys.readouterr().out
        assert scores(here, 'ann')[CHECK] == 5
        assert results_of(here, ASSIGNMENT)[0].results[0].points == 40


class TestCopies:
    """A damaged gradebook is never replaced silently."""

    def test_a_gradebook_without_its_marks_is_refused(self, here, capsys):
        """A new table would lose manual grades."""
        with closing(sqlite3.connect(here.work / 'gradebook.db')) as file:
            file.execute('drop table grade')
        capsys.readouterr()

        for _ in range(2):
            assert grade() == command.USAGE
            said = capsys.readouterr().err
            assert 'the gradebook cannot be used: no such table: grade. Try: put ' in said
            assert len(said.splitlines()) == 1

    def test_an_emptied_gradebook_is_refused_and_restored(self, here, capsys):
        """No program runs, and the copy contains the manual grades."""
        by_hand(here, 'ann', 4)
        hand_in(here, 'bob')
        assert grade() == OK
        (copy,) = copies(here)
        path = here.work / 'gradebook.db'
        path.write_bytes(b'')
        hand_in(here, 'cho')
        capsys.readouterr()

        for arguments in (
            ['grade'],
            ['rejudge', '--write'],
            ['export', 'csv', '--points=gradebook'],
        ):
            assert command.main(arguments) == command.USAGE
            said = capsys.readouterr()
            assert said.out == ''
            assert said.err == (
                f'autograder: {path}: the gradebook is damaged: the file is empty. Try: '
                f'cp {copy} {path}. To begin a new gradebook instead, remove the file. Nothing '
                'was written.\n'
            )
        assert path.read_bytes() == b''

        path.write_bytes(copy.read_bytes())
        assert grade() == OK
        assert scores(here, 'ann')[WRITTEN] == 4
        assert scores(here, 'bob')[CHECK] == scores(here, 'cho')[CHECK] == 15

    def test_json_has_no_points_of_a_submission_for_review(self, here, capsys):
        """The same holds for exports; a student with a mark is printed with the mark."""
        hand_in(here, 'bob', **{'THRESHOLD_C = ': 'GRADER_FAULT = THRESHOLD_C = '})
        capsys.readouterr()

        assert grade('--json') == FOR_REVIEW
        found = {one['student']: one for one in json.loads(capsys.readouterr().out)}
        assert found['ann']['points'] > 0
        assert (found['bob']['status'], found['bob']['points']) == ('for review', None)

        assert command.main(['explain', 'bob']) == OK
        assert capsys.readouterr().out.startswith(f'bob, {ASSIGNMENT}: for review: ')


class TestSummary:
    """A second grading prints only what is new and what needs the instructor."""

    def test_only_new_results_and_reviews_have_a_row(self, here, capsys):
        hand_in(here, 'bob', **TYPO)
        hand_in(here, 'eve', **{'THRESHOLD_C = ': 'GRADER_FAULT = THRESHOLD_C = '})
        (here.work / 'class_list.csv').write_text('student\nann\nbob\neve\nzoe\n', 'utf-8')
        capsys.readouterr()

        assert grade() == FOR_REVIEW
        said = capsys.readouterr().out
        rows = [line for line in said.splitlines() if line.startswith('│')]
        assert ['ann' in ''.join(rows), 'bob' in rows[0], 'zoe' in ''.join(rows)] == [0, 1, 0]
        assert 'Gradebook: 2 entered, 1 unchanged.' in ' '.join(said.split())
        assert 'Nothing to grade yet from: zoe.\n' in said
        assert said.endswith('\nExit code 1: 1 submission is for review.\n')

        assert grade('--allow-review') == OK
        rows = [line for line in capsys.readouterr().out.splitlines() if line.startswith('│')]
        assert ('eve' in rows[0], 'bob' in ''.join(rows)) == (True, False)

        hand_in(here, 'eve', **TYPO)
        assert grade() == OK
        capsys.readouterr()
        assert grade() == OK
        said = capsys.readouterr().out
        assert said.startswith(f'{ASSIGNMENT}: 3 submissions in ')
        assert '\nNothing to grade yet from: zoe.\n' in said
        assert not [line for line in said.splitlines() if line.startswith('│')]

    def test_after_an_interruption_results_in_the_gradebook_are_shown(
        self, here, capsys, monkeypatch
    ):
        """The interrupted grading has entered them, but shown none."""

        def interrupted(*_):
            raise KeyboardInterrupt

        hand_in(here, 'bob')
        with monkeypatch.context() as patch:
            patch.setattr(grading.LiveEntry, 'counts', interrupted)
            grade()
        capsys.readouterr()

        assert grade() == OK
        said = capsys.readouterr().out
        rows = [line for line in said.splitlines() if line.startswith('│')]
        assert ['bob' in rows[0], 'ann' in ''.join(rows)] == [True, False]
        assert 'Gradebook: 0 entered, 2 unchanged.' in ' '.join(said.split())

    def test_written_answers_and_unknown_assignments_are_named(self, here, capsys):
        with book(here) as gradebook:
            gradebook.update_or_create_assignment('7_temperature_monitor', duedate='2026-12-01')
        capsys.readouterr()

        assert grade() == OK
        *_, written, unknown = capsys.readouterr().out.splitlines()
        assert written.startswith('Written answers to mark: 1. Try: make lab, Nbgrader > ')
        assert unknown == (
            'gradebook: 7_temperature_monitor is not an assignment of this course; did you mean '
            '07_temperature_monitor? Try: .venv/bin/nbgrader db assignment remove '
            '7_temperature_monitor'
        )

        by_hand(here, 'ann', 4)
        assert grade() == OK
        assert 'Written answers' not in capsys.readouterr().out


class TestStudents:
    """A folder never becomes a student by its name alone."""

    @pytest.mark.parametrize('deep', [True, False])
    def test_a_folder_of_another_layout_makes_no_student(self, here, tmp_path, capsys, deep):
        source = here.submitted / 'ann' / ASSIGNMENT / NOTEBOOK
        place = 'mine/zoe/' + ASSIGNMENT if deep else 'Zoe Example_12_assignsubmission_file'
        folder = tmp_path / 'download' / place
        folder.mkdir(parents=True)
        (folder / NOTEBOOK).write_bytes(source.read_bytes())
        capsys.readouterr()

        assert grade('--submitted', str(tmp_path / 'download')) == command.USAGE
        said = capsys.readouterr().err
        fix = f'Try: --submitted {tmp_path}/download/mine\n'
        if not deep:
            fix = f'Try: .venv/bin/autograder collect {tmp_path}/download, if this is a download '
        assert fix in said
        with book(here) as gradebook:
            assert [student.id for student in gradebook.students] == ['ann']

    def test_folders_that_are_passed_over_are_named(self, here, capsys):
        """A folder that is left out is named, because something may be wrong with it."""
        (here.submitted / 'old stuff').mkdir()
        capsys.readouterr()

        assert grade() == OK
        said = ' '.join(capsys.readouterr().out.split())
        assert 'Folders without a notebook of the course were not graded: old stuff.' in said
        assert len(results_of(here, ASSIGNMENT)[0].results) == 1

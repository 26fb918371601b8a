"""Test cases for the gradebook, which run on SQLite and on PostgreSQL."""

from pathlib import Path

from conftest import ASSIGNMENT
from fake_engine import FakeEngine
from nbgrader.api import Gradebook
import pytest

from autograder.authoring.sample_class import remove_sample_class
from autograder.classroom.collected import save_collected, Work
from autograder.classroom.pages import write_all_reports
from autograder.classroom.people import read_people
from autograder.classroom.results_of_class import last_results, results_file
from autograder.classroom.standing import GRADED
from autograder.collect.course import due_dates
from autograder.commands.forget import student_with_data, traces
from autograder.errors import GraderError
from autograder.exam.inputs import fingerprint_file, keep_secret
from autograder.exports.marks import from_gradebook
from autograder.gradebook import journal
from autograder.gradebook.database import gradebook_file, load_config
from autograder.gradebook.live_entry import begin_to_enter, enter, Guard
from autograder.gradebook.record import remove_entries
from autograder.grading.pipeline import grade_class, load_lesson
from autograder.layout import Layout
from autograder.results import SubmissionResult
from autograder.submission.inbox import discover, SECRET

NOTEBOOK = 'temperature_monitor.ipynb'
WRITTEN = 'explain_threshold'
CHECK = 'check_temperature_publisher'


def begin(course: Layout) -> None:
    """Enter the assignment, which is the first step of every grading."""
    begin_to_enter(course, ASSIGNMENT, Guard(course))


def solved(course: Layout, **changes: str) -> bytes:
    """Return the solution as a student's file, with some words replaced."""
    text = (course.solutions / ASSIGNMENT / NOTEBOOK).read_text(encoding='utf-8')
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    return text.encode()


def hand_in(
    course: Layout,
    student: str,
    stamp: str = '',
    data: bytes | None = None,
    into: Path | None = None,
    **changes: str,
) -> None:
    """
    Write a file to the folder that nbgrader's collect would use.

    :param data: the file, by default the solution with some words replaced
    :param into: folder of the class, by default that of the course
    """
    folder = (into or course.submitted) / student / ASSIGNMENT
    folder.mkdir(parents=True, exist_ok=True)
    (folder / NOTEBOOK).write_bytes(solved(course, **changes) if data is None else data)
    if stamp:
        (folder / 'timestamp.txt').write_text(stamp, encoding='utf-8')


def grade(course: Layout, guard: Guard | None = None) -> int:
    """Grade the class and enter it; return how many submissions were entered."""
    engine = FakeEngine()
    lesson = load_lesson(course, ASSIGNMENT, engine)
    class_ = discover(course.submitted, ASSIGNMENT, lesson.notebook, course.assignments())
    graded = grade_class(class_, lesson, engine, jobs=1)
    count, refused = enter(course, lesson, graded, guard or Guard(course, yes=True))
    assert refused == ''
    return count


def name_students(course: Layout, names: dict[str, str]) -> None:
    save_collected(course, [Work(student, person=name) for student, name in names.items()])


def forget(course: Layout, student: str) -> list[str]:
    """Remove a student, and return the lines about everything that was removed."""
    found = list(traces(course, student))
    for _, remove in found:
        remove()
    return [line for lines, _ in found for line in lines]


def book(course: Layout) -> Gradebook:
    return Gradebook(str(load_config(course).CourseDirectory.db_url))


def by_hand(course: Layout, student: str, points: float, extra: float = 0.0) -> None:
    """Give the written answer a manual grade, as formgrader does."""
    with book(course) as gradebook:
        grade = gradebook.find_grade(WRITTEN, 'temperature_monitor', ASSIGNMENT, student)
        grade.manual_score = points
        grade.extra_credit = extra or None
        grade.needs_manual_grade = False
        gradebook.db.commit()


def scores(course: Layout, student: str) -> dict[str, float | None]:
    """Return the score of each cell, and the late penalty."""
    with book(course) as gradebook:
        submission = gradebook.find_submission(ASSIGNMENT, student)
        found = {
            grade.name: grade.manual_score if grade.auto_score is None else grade.auto_score
            for notebook in submission.notebooks
            for grade in notebook.grades
        }
        return {**found, 'late': submission.late_submission_penalty}


def writes_reruns_and_keeps_grades_given_by_hand(course: Layout) -> None:
    """A manual grade survives a rerun that enters one changed submission."""
    hand_in(course, 'ann')
    hand_in(course, 'bob', temperature_topic='temprature_topic')
    assert grade(course) == 2
    assert scores(course, 'ann')[CHECK] == 15
    assert scores(course, 'bob')[CHECK] == 5
    assert grade(course) == 0

    by_hand(course, 'ann', 4)
    by_hand(course, 'bob', 3)
    assert grade(course) == 0
    hand_in(course, 'bob')
    assert grade(course) == 1

    assert scores(course, 'bob')[CHECK] == 15
    assert scores(course, 'ann')[WRITTEN] == 4
    assert scores(course, 'bob')[WRITTEN] == 3


def waiting(course: Layout, *students: str) -> list[bool]:
    """Return, per submission, whether it needs manual grading and so has no mark yet."""
    with book(course) as gradebook:
        found = [gradebook.find_submission(ASSIGNMENT, one) for one in students]
        return [bool(one.needs_manual_grade) for one in found]


def leaves_marks_alone_that_nothing_speaks_against(course: Layout) -> None:
    """Unchanged work that is entered again needs no new manual grade."""
    for student in ('ann', 'bob', 'eve'):
        hand_in(course, student)
    grade(course)
    by_hand(course, 'ann', 4)
    by_hand(course, 'bob', 3)
    assert waiting(course, 'ann', 'bob', 'eve') == [False, False, True]

    config = course.root / 'nbgrader_config.py'
    config.write_text(config.read_text(encoding='utf-8') + '\n# new\n', encoding='utf-8')
    hand_in(course, 'bob', temperature_topic='temprature_topic')
    assert grade(course) == 3

    assert waiting(course, 'ann', 'bob', 'eve') == [False, True, True]
    (mark,) = from_gradebook(course, ASSIGNMENT, [SubmissionResult('ann', ASSIGNMENT)])
    assert (mark.points, mark.status) == (54, GRADED)


def says_that_a_gradebook_does_not_answer(course: Layout) -> None:
    """The error is one sentence after all runs, and no gradebook is created instead."""
    hand_in(course, 'ann')
    grade(course)
    path = gradebook_file(course)
    if path is None:
        return  # a test does not damage a server
    path.write_bytes(b'no database' * 100)

    assert 'gradebook.db: the gradebook is damaged: ' in refusal_after_grading(course)
    assert path.read_bytes() == b'no database' * 100


def says_that_settings_are_wrong(course: Layout) -> None:
    """A mistake in the settings causes a one-sentence error, and no run is wasted."""
    hand_in(course, 'ann')
    config = course.root / 'nbgrader_config.py'
    text = config.read_text(encoding='utf-8')
    for line, said in {
        'c.LateSubmissionPlugin.penalty_method = zero': 'NameError: ',
        "c.CourseDirectory.db_url = 'postgres://u@localhost/g'": 'this is not the address of',
        "c.CourseDirectory.db_url = 'gradebook.db'": 'this is not the address of',
        "c.CourseDirectory.db_url = 'postgresql://u@localhost:port/g'": 'is not the address of',
    }.items():
        config.write_text(f'{text}\n{line}\n', encoding='utf-8')
        why = refusal_after_grading(course)
        assert said in why, why
        assert due_dates(course).problem.startswith(
            'due dates unknown, because the gradebook cannot be read'
        )


def refusal_after_grading(course: Layout, count: int = 1) -> str:
    """Grade the class, and return why its submissions were not entered."""
    engine = FakeEngine()
    lesson = load_lesson(course, ASSIGNMENT, engine)
    class_ = discover(course.submitted, ASSIGNMENT, lesson.notebook, course.assignments())
    graded = grade_class(class_, lesson, engine, jobs=1)
    new, said = enter(course, lesson, graded, Guard(course))
    assert new == count
    return said


def fills_what_was_changed_or_lost(course: Layout) -> None:
    """An entry of the journal is valid only if the gradebook shows the same values."""
    hand_in(course, 'ann')
    hand_in(course, 'bob')
    grade(course)

    with book(course) as gradebook:
        gradebook.find_grade(CHECK, 'temperature_monitor', ASSIGNMENT, 'ann').auto_score = 0
        gradebook.remove_submission(ASSIGNMENT, 'bob')
        gradebook.db.commit()

    assert grade(course) == 2
    assert scores(course, 'ann')[CHECK] == scores(course, 'bob')[CHECK] == 15

    notes = journal.journal_file(course, ASSIGNMENT)
    notes.write_bytes(notes.read_bytes()[:-20])
    assert grade(course) == 2


def fills_a_gradebook_that_was_deleted(course: Layout) -> None:
    """Reading a missing gradebook does not create an empty one."""
    hand_in(course, 'ann')
    grade(course)
    path = gradebook_file(course)
    if path is None:
        return  # a server keeps its database

    path.unlink()
    assert journal.gradebook_values(course, ASSIGNMENT) == {}
    assert not path.exists()
    path.with_name(f'{path.name}.unfinished').write_bytes(b'of a grading that was killed')

    assert grade(course) == 1
    assert scores(course, 'ann')[CHECK] == 15
    assert [one.name for one in path.parent.glob(f'{path.name}*')] == [path.name]


def takes_off_for_lateness_as_nbgrader_is_told(course: Layout) -> None:
    """The late policy is nbgrader's plug-in; a new submission time changes the penalty."""
    hand_in(course, 'ann', '2026-03-01 12:00:00 UTC')
    hand_in(course, 'bob', '2026-03-03 12:00:00 UTC')
    grade(course)
    with book(course) as gradebook:
        gradebook.update_or_create_assignment(ASSIGNMENT, duedate='2026-03-02 00:00:00 UTC')
    assert grade(course) == 2
    assert scores(course, 'bob')['late'] == 0
    own = course.work / 'nbgrader_config.py'
    own.write_text("c.LateSubmissionPlugin.penalty_method = 'zero'\n", encoding='utf-8')

    assert grade(course) == 2
    assert scores(course, 'ann')['late'] == 0
    late = scores(course, 'bob')['late']
    assert late == 50

    by_hand(course, 'ann', 4)
    by_hand(course, 'bob', 4)
    assert grade(course) == 1
    assert scores(course, 'bob')['late'] == 54
    by_hand(course, 'bob', 4, extra=2)
    assert grade(course) == 1
    assert scores(course, 'bob')['late'] == 56
    assert waiting(course, 'ann', 'bob') == [False, False]

    hand_in(course, 'bob', '2026-03-01 12:00:00 UTC')
    assert grade(course) == 1
    assert scores(course, 'bob')['late'] == 0


def gives_students_more_time(course: Layout) -> None:
    """An extension removes the penalty; withdrawing it lowers the mark, which is listed."""
    config = course.root / 'nbgrader_config.py'
    text = config.read_text(encoding='utf-8')
    config.write_text(
        f"{text}\nc.LateSubmissionPlugin.penalty_method = 'zero'\n", encoding='utf-8'
    )
    for student in ('ann', 'bob'):
        hand_in(course, student, '2026-03-03 12:00:00 UTC')
    course.extensions.write_text(
        'student,assignment,hours\nann,temperature_monitor,48\n', encoding='utf-8'
    )
    assert grade(course) == 2  # without a due date, extra time has no effect
    with book(course) as gradebook:
        gradebook.update_or_create_assignment(ASSIGNMENT, duedate='2026-03-02 00:00:00 UTC')
    assert grade(course) == 2
    assert (scores(course, 'ann')['late'], scores(course, 'bob')['late']) == (0, 50)
    assert str(due_dates(course).of('ann', ASSIGNMENT)) == '2026-03-04 00:00:00+00:00'
    assert grade(course) == 0

    course.extensions.write_text('student,assignment,hours\nbob,,48\n', encoding='utf-8')
    guard = Guard(course)
    assert grade(course, guard) == 1
    assert guard.lowered_in(ASSIGNMENT) == ['ann 50 to 0']
    assert (scores(course, 'ann')['late'], scores(course, 'bob')['late']) == (0, 0)


def names_students(course: Layout) -> None:
    """Names that an instructor has written are not changed; a new name replaces an id."""
    for student in ('1001', '1002', '1003'):
        hand_in(course, student)
    name_students(course, {'1001': 'Ann Mary Example', '1002': 'doejane'})
    grade(course)
    with book(course) as gradebook:
        found = {one.id: (one.last_name, one.first_name) for one in gradebook.students}
        gradebook.update_or_create_student('1001', first_name='Annie')
    assert found == {
        '1001': ('Example', 'Ann Mary'),
        '1002': ('doejane', '1002'),
        '1003': ('1003', ''),
    }

    name_students(course, {'1003': 'Cem Example'})
    for student in ('1001', '1003'):
        hand_in(course, student, temperature_topic='temprature_topic')
    grade(course)
    with book(course) as gradebook:
        assert gradebook.find_student('1001').first_name == 'Annie'
        assert gradebook.find_student('1003').first_name == 'Cem'


def lets_the_sample_students_go(course: Layout) -> None:
    """
    The first real class replaces the sample students, and no other student is removed.

    The course secret is kept as long as somebody else was graded with it.
    """
    sample = course.sample_class / ASSIGNMENT / 'pass__sample'
    sample.mkdir(parents=True, exist_ok=True)
    (sample / 'expected.json').write_text('{}', encoding='utf-8')
    hand_in(course, 'pass__sample')
    hand_in(course, 'ann')
    grade(course)
    there = [SubmissionResult(one, ASSIGNMENT) for one in ('ann', 'pass__sample')]
    write_all_reports(course, ASSIGNMENT, there)
    keep_secret(course)

    assert remove_sample_class(course) == 1
    assert fingerprint_file(course).exists()
    assert not (course.submitted / 'pass__sample').exists()
    assert [one.student for one in last_results(course, ASSIGNMENT)] == ['ann']
    assert not list(course.reports.glob('*/students/pass__*'))
    with book(course) as gradebook:
        assert [student.id for student in gradebook.students] == ['ann']
    assert scores(course, 'ann')[CHECK] == 15
    assert grade(course) == 0
    assert remove_sample_class(course) == 0

    (course.submitted / 'pass__sample').mkdir()
    write_all_reports(course, ASSIGNMENT, there[1:])
    remove_entries(course, ['ann'])
    assert remove_sample_class(course) == 1
    assert not fingerprint_file(course).exists()
    assert not results_file(course, ASSIGNMENT).exists()


def leaves_lower_marks_as_they_are(course: Layout) -> None:
    """A mark is lowered only with ``--yes``."""
    hand_in(course, 'ann')
    grade(course)
    by_hand(course, 'ann', 4)
    hand_in(course, 'ann', temperature_topic='temprature_topic')

    guard = Guard(course)
    assert grade(course, guard) == 0
    assert guard.lowered_in(ASSIGNMENT) == ['ann 54 to 44']
    assert scores(course, 'ann')[CHECK] == 15
    server = gradebook_file(course) is None
    assert ('pg_dump --format=custom' in guard.refusal('')) == server

    assert grade(course, Guard(course, yes=True)) == 1
    assert scores(course, 'ann')[CHECK] == 5


def forgets_a_student(course: Layout) -> None:
    """All results are removed, the submission is moved, and other students are unchanged."""
    for student in ('1001', '1002'):
        hand_in(course, student)
    name_students(course, {'1001': 'Ann Example', '1002': 'Bob Example'})
    grade(course)
    by_hand(course, '1001', 4)
    there = [SubmissionResult(one, ASSIGNMENT) for one in ('1001', '1002')]
    write_all_reports(course, ASSIGNMENT, there)

    assert student_with_data(course, 'ann example') == '1001'
    assert len(list(traces(course, '1001'))) == 4
    assert grade(course) == 0  # a listing changes nothing

    moved, *lines, folder, name = forget(course, '1001')
    assert moved.endswith('1001')
    assert name == 'saved by collect: Ann Example'
    assert lines == [
        f'gradebook: {ASSIGNMENT}, 54 points, 4 of them given by hand',
        f'reports: result and page of {ASSIGNMENT}',
        f'journal of the gradebook: {ASSIGNMENT}',
    ]
    assert folder.endswith('autograded/1001')
    assert not (course.work / 'autograded' / '1001').exists()
    with pytest.raises(GraderError, match=r'there is no such student. Did you mean 1002?'):
        student_with_data(course, '1001')
    with book(course) as gradebook:
        assert [student.id for student in gradebook.students] == ['1002']
    assert [one.student for one in last_results(course, ASSIGNMENT)] == ['1002']
    assert [one.name for one in course.reports.glob('*/students/*')] == ['1002.html']
    assert read_people(course) == {'1002': 'Bob Example'}
    assert list(journal.read_notes(course, ASSIGNMENT)) == ['1002']
    (moved,) = (course.work / 'forgotten').iterdir()
    assert (moved / ASSIGNMENT / NOTEBOOK).is_file()
    assert grade(course) == 0

    forget(course, '1002')
    hand_in(course, '1003')
    assert grade(course) == 1  # a gradebook that was emptied on purpose is not damaged


def forgets_a_folder_that_is_no_students(course: Layout) -> None:
    """An earlier grading read the folder as a student's; the next one ignores its files."""
    hand_in(course, 'ann')
    (course.submitted / 'notes').mkdir()
    grade(course)
    with book(course) as gradebook:
        gradebook.add_student('notes')

    place, marks = forget(course, student_with_data(course, 'notes'))
    assert place.startswith('not touched: ')
    assert marks == 'gradebook: no submission'
    assert (course.submitted / 'notes').is_dir()
    with book(course) as gradebook:
        assert [student.id for student in gradebook.students] == ['ann']


def keeps_the_secret_that_names_feedback_in_the_exchange(course: Layout) -> None:
    """Nbgrader releases feedback only if the file is next to the graded notebook."""
    hand_in(course, '1001')
    place = Path('1001', ASSIGNMENT, SECRET)
    (course.submitted / place).write_text('a secret', encoding='utf-8')

    grade(course)

    assert (course.work / 'autograded' / place).read_text(encoding='utf-8') == 'a secret'


ALL = (
    keeps_the_secret_that_names_feedback_in_the_exchange,
    leaves_lower_marks_as_they_are,
    forgets_a_student,
    forgets_a_folder_that_is_no_students,
    names_students,
    lets_the_sample_students_go,
    writes_reruns_and_keeps_grades_given_by_hand,
    leaves_marks_alone_that_nothing_speaks_against,
    says_that_a_gradebook_does_not_answer,
    says_that_settings_are_wrong,
    fills_what_was_changed_or_lost,
    fills_a_gradebook_that_was_deleted,
    takes_off_for_lateness_as_nbgrader_is_told,
    gives_students_more_time,
)

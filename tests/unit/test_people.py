"""Display names of students whose ids are numbers."""

import re

from collect_sources import GOOD, layout, LISTEN, packed, TALK  # noqa: F401 - a fixture
import pytest

from autograder.classroom.collected import save_collected, Work
from autograder.classroom.people import find_student, read_people, student_named
from autograder.collect.copy_notebooks import collect
from autograder.collect.deliveries import TAKEN, UNCHANGED
from autograder.errors import GraderError
from autograder.submission.inbox import student_id

CANVAS = {'exampleann_1001_55001_talk.ipynb': GOOD, 'berg_1002_55002_essay.pdf': b'%PDF'}


def test_names_of_what_was_taken_are_kept(tmp_path, layout):
    """The names from all sources are saved; a student's latest name counts."""
    collect(packed(tmp_path / 'c.zip', CANVAS), layout, layout.submitted)
    assert read_people(layout) == {'1001': 'exampleann'}

    text = b'submission_1:\n  :submitters:\n  - :name: "Ann \xc3\x89xample"\n    :sid: \'1001\'\n'
    metadata = text + b'submission_2:\n  :submitters:\n  - :name: Bo\n    :email: b@x.org\n'
    files = {
        'submission_metadata.yml': metadata,
        'submission_1/talk.ipynb': GOOD,
        'submission_2/talk.ipynb': GOOD,
    }
    rows = collect(packed(tmp_path / 'g.zip', files), layout, layout.submitted)

    assert [row.done for row in rows] == [UNCHANGED, TAKEN]
    assert read_people(layout) == {'1001': 'Ann Éxample', 'b@x.org': 'Bo'}
    assert 'Éxample' in layout.collected.read_text(encoding='utf-8')


def test_latest_name_of_a_student_counts(layout):
    """Work without a name, or of another assignment, does not bring an old name back."""
    save_collected(layout, [Work('1', TALK, 'exampleann'), Work('1', LISTEN, 'exampleann')])
    save_collected(layout, [Work('1', TALK, 'Ann Example')])
    save_collected(layout, [Work('1', LISTEN), Work('2', TALK, 'not collected', why='a PDF')])

    assert read_people(layout) == {'1': 'Ann Example'}


def test_moodle_names_are_kept_only_if_the_id_is_another(tmp_path, layout):
    """Most names in Moodle already are valid ids."""
    place = '{}_assignsubmission_file/talk.ipynb'
    files = {place.format(who): GOOD for who in ("Bo O'Neil_1", 'Ann_2')}

    collect(packed(tmp_path / 'm.zip', files), layout, layout.submitted)

    assert read_people(layout) == {student_id("Bo O'Neil"): "Bo O'Neil"}


def test_a_dry_run_and_a_repeated_run_write_no_names(tmp_path, layout):
    """A dry run, and a run without new names, leave the file unchanged."""
    source = packed(tmp_path / 'c.zip', CANVAS)
    collect(source, layout, layout.submitted, write=False)
    assert not layout.collected.exists()

    collect(source, layout, layout.submitted)
    before = layout.collected.stat()
    collect(source, layout, layout.submitted)
    assert layout.collected.stat().st_ino == before.st_ino


def test_names_are_text_of_one_line(layout):
    names = {
        '1': 'Ann\x1b[31m\n Ex\u202eample\x00',
        '2': 'x' * 999,
        '3': '\x07',
        '4': 'می\u200cخواهم \ud800',
    }
    save_collected(layout, [Work(one, TALK, name) for one, name in names.items()])

    assert read_people(layout) == {
        '1': 'Ann[31m Example',
        '2': 'x' * 200,
        '4': 'می\u200cخواهم',
    }


@pytest.mark.parametrize(
    ('name', 'student'),
    [('1001', '1001'), ('Ann Lee', '1001'), ('  ann   LEE ', '1001'), ('Bo', 'Bo')],
)
def test_student_is_found_by_id_or_name(name, student, layout):
    """Capitals and spaces do not matter, and an id takes precedence over a name."""
    names = {'1001': 'Ann Lee', '1002': 'Bo', '1003': 'Gone'}
    save_collected(layout, [Work(one, TALK, name) for one, name in names.items()])

    assert student_named(layout, name, {'1001', '1002', 'Bo'}) == student


def test_a_name_of_several_students_is_refused_and_an_unknown_one_is_nobody(layout):
    """The message lists the ids; only the given students are searched."""
    names = {'1001': 'Ann Lee', '1002': 'Ann  Lee', '9': 'Gone'}
    save_collected(layout, [Work(one, TALK, name) for one, name in names.items()])
    students = {'1001', '1002', '1003'}

    with pytest.raises(
        GraderError, match=r'2 students have this name\. Try: use one of the ids 1001, 1002'
    ):
        student_named(layout, 'Ann Lee', students)
    assert [student_named(layout, name, students) for name in ('Zoe', '', 'Gone')] == [''] * 3


@pytest.mark.parametrize(
    ('name', 'said'),
    [
        ('Clara Ivanof', 'Did you mean "Clara Ivanov"?'),
        ('Ivanov', 'Did you mean "Clara Ivanov"?'),
        ('Katrin Garcia', 'Did you mean "Katrin García"?'),
        ('1011', 'Did you mean 1001?'),
        ('Zoe', 'Try: the id, or the full name in quotes'),
    ],
)
def test_an_unknown_student_is_refused_with_similar_names(layout, name, said):
    names = {'1001': 'Clara Ivanov', '2': 'Katrin García', '3': 'Clara Gone'}
    save_collected(layout, [Work(one, TALK, name) for one, name in names.items()])

    assert find_student(layout, 'clara ivanov', {'1001', '2'}) == '1001'
    with pytest.raises(GraderError, match=f'{name}: there is no such student. {re.escape(said)}'):
        find_student(layout, name, {'1001', '2'})

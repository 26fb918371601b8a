"""Display names of students whose ids are numbers."""

import json

from collect_sources import GOOD, layout, packed, taken, TALK  # noqa: F401 - a fixture
import pytest

from autograder.classroom.people import read_people, save_people, student_named
from autograder.collect.copy_notebooks import collect
from autograder.collect.table import TAKEN, UNCHANGED
from autograder.errors import GraderError
from autograder.submission.ids import student_id

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
    assert 'Éxample' in layout.people.read_text(encoding='utf-8')
    assert list(json.loads(layout.people.read_bytes())) == ['1001', 'b@x.org']


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
    assert not layout.people.exists()

    collect(source, layout, layout.submitted)
    before = layout.people.stat()
    collect(source, layout, layout.submitted)
    assert layout.people.stat().st_ino == before.st_ino


def test_names_are_text_of_one_line(layout):
    save_people(
        layout,
        {
            '1': 'Ann\x1b[31m\n Ex\u202eample\x00',
            '2': 'x' * 999,
            '3': '\x07',
            '4': 'می\u200cخواهم \ud800',
        },
    )

    assert read_people(layout) == {
        '1': 'Ann[31m Example',
        '2': 'x' * 200,
        '4': 'می\u200cخواهم',
    }


@pytest.mark.parametrize(
    ('data', 'known'),
    [
        (b'', {}),
        (b'{"1": "Ann"', {}),
        (b'["Ann"]', {}),
        (b'\xff\xfe', {}),
        (b'[' * 100_000, {}),
        (b'{"1": "Ann", "2": 5, "3": ["x"], "4": "B\\u001b"}', {'1': 'Ann', '4': 'B'}),
    ],
)
def test_a_damaged_file_is_no_trouble(data, known, layout):
    """Valid names in a damaged file are kept, and the next names are added."""
    layout.work.mkdir(parents=True)
    layout.people.write_bytes(data)
    assert read_people(layout) == known

    save_people(layout, {'9': 'Zoë'})
    assert read_people(layout) == {**known, '9': 'Zoë'}


def test_names_that_cannot_be_kept_do_not_hide_the_table(tmp_path, layout):
    layout.people.mkdir(parents=True)

    rows = collect(packed(tmp_path / 'c.zip', CANVAS), layout, layout.submitted)

    assert rows[0].place == str(layout.people)
    assert rows[0].notes == ('names cannot be written: is a directory',)
    assert layout.not_collected.is_file()
    assert f'1001/{TALK}/talk.ipynb' in taken(layout)


@pytest.mark.parametrize(
    ('name', 'student'),
    [('1001', '1001'), ('Ann Lee', '1001'), ('  ann   LEE ', '1001'), ('Bo', 'Bo')],
)
def test_student_is_found_by_id_or_name(name, student, layout):
    """Capitals and spaces do not matter, and an id takes precedence over a name."""
    save_people(layout, {'1001': 'Ann Lee', '1002': 'Bo', '1003': 'Gone'})

    assert student_named(layout, name, {'1001', '1002', 'Bo'}) == student


def test_a_name_of_several_students_is_refused_and_an_unknown_one_is_nobody(layout):
    """The message lists the ids; only the given students are searched."""
    save_people(layout, {'1001': 'Ann Lee', '1002': 'Ann  Lee', '9': 'Gone'})
    students = {'1001', '1002', '1003'}

    with pytest.raises(
        GraderError, match=r'2 students have this name\. Try: use one of the ids 1001, 1002'
    ):
        student_named(layout, 'Ann Lee', students)
    assert [student_named(layout, name, students) for name in ('Zoe', '', 'Gone')] == [''] * 3

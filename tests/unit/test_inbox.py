"""The folder of submitted work: only real folders and regular files are read."""

import os

import pytest

from autograder.submission import inbox, reading

LESSON = '01_talker'
FILE = 'talker.ipynb'


@pytest.fixture
def hand_in(tmp_path):
    def write(student, name=FILE, data=b'{}', assignment=LESSON):
        folder = tmp_path / student / assignment
        folder.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)
        return folder

    return write


def look(tmp_path, known=(LESSON, '02_other')):
    return {one.student: one for one in inbox.discover(tmp_path, LESSON, FILE, known)}


def test_students_come_in_the_order_of_their_names(tmp_path, hand_in):
    for name in ('zoe', 'ann', 'bob-2', 'x.y@z'):
        hand_in(name)

    assert list(look(tmp_path)) == ['ann', 'bob-2', 'x.y@z', 'zoe']


def test_a_regular_notebook_is_read(tmp_path, hand_in):
    hand_in('ann', data=b'\xff')

    found = look(tmp_path)['ann']

    assert found.read(FILE) == (b'\xff', ())
    assert found.recordable


def test_files_beside_the_student_folders_are_no_students(tmp_path, hand_in):
    hand_in('ann')
    (tmp_path / 'notes.txt').write_text('x')
    (tmp_path / '.DS_Store').write_text('x')

    assert list(look(tmp_path)) == ['ann']


@pytest.mark.parametrize(
    ('path', 'why'),
    [
        ('ann_123_assignsubmission_file/talker.ipynb', 'a raw download'),
        ('submitted/ann/01_talker/talker.ipynb', 'one level too high'),
        ('ann/01_talker/report.pdf', 'no notebook'),
        ('ann/1_talker/talker.ipynb', 'no folder of the course'),
    ],
)
def test_a_folder_without_a_notebook_of_the_course_is_no_student(tmp_path, hand_in, path, why):
    """Such a folder would otherwise get a zero in every lesson."""
    hand_in('zoe')
    place = tmp_path / path
    place.parent.mkdir(parents=True)
    place.write_bytes(b'{}')

    assert list(look(tmp_path)) == ['zoe'], why
    assert inbox.without_notebooks(tmp_path, [LESSON]) == [path.partition('/')[0]]


def test_work_for_another_assignment_only_is_no_submission(tmp_path, hand_in):
    hand_in('ann', assignment='02_other')

    assert look(tmp_path) == {}


@pytest.mark.parametrize('name', ['talker (1).ipynb', 'Talker.ipynb'])
def test_a_single_notebook_under_another_name_counts(tmp_path, hand_in, name):
    """A single notebook counts under any name, because browsers rename downloads."""
    hand_in('ann', name=name, data=b'here')

    found = look(tmp_path)['ann']

    data, problems = found.read(FILE)
    assert data == b'here'
    assert 'graded instead' in problems[0].got


@pytest.mark.parametrize(
    ('places', 'said'),
    [
        # The unknown folder may contain this assignment under a wrong name.
        (['1_talker/talker.ipynb', '02_other/talker.ipynb'], "only '1_talker'"),
        ([f'{LESSON}/a.ipynb', f'{LESSON}/b.ipynb'], '2 other notebooks'),
        ([f'{LESSON}/readme.txt', '02_other/talker.ipynb'], 'got no notebook'),
    ],
    ids=['unknown assignment', 'two names', 'no notebook'],
)
def test_a_missing_notebook_is_a_problem(tmp_path, hand_in, places, said):
    for place in places:
        assignment, _, name = place.partition('/')
        hand_in('ann', name, assignment=assignment)

    found = look(tmp_path)['ann']

    assert found.read(FILE)[0] is None
    assert said in found.problems[0].line()


def test_an_unreadable_folder_is_a_problem_of_one_student(tmp_path, hand_in, monkeypatch):
    hand_in('ann')
    hand_in('bob')
    listdir = os.listdir

    def refuse(path):
        if str(path).endswith('ann'):
            raise PermissionError(13, 'Permission denied')
        return listdir(path)

    monkeypatch.setattr(inbox.os, 'listdir', refuse)
    found = look(tmp_path)

    assert 'permission denied' in found['ann'].problems[0].line()
    assert found['bob'].read(FILE) == (b'{}', ())


@pytest.mark.parametrize('name', ['a*', 'a,b', '=1+1', '-rf', 'a\nb', 'x' * 101, ' a', 'a '])
def test_a_name_that_nbgrader_would_misread_is_not_recorded(tmp_path, hand_in, name):
    """Nbgrader uses ids as patterns, splits them at commas and exports them unquoted."""
    hand_in(name)

    (found,) = look(tmp_path).values()

    assert not found.recordable
    assert '\n' not in found.problems[0].line()


def test_a_file_above_the_limit_is_not_read(tmp_path, hand_in, monkeypatch):
    monkeypatch.setattr(reading, 'MAX_BYTES', 2**20)
    hand_in('ann', data=b' ' * (3 * 2**20))

    data, problems = look(tmp_path)['ann'].read(FILE)

    assert data is None
    assert problems[0].got == '3.0 MiB'
    assert problems[0].line().startswith(f'{FILE}: expected a file of at most ')


def test_looking_at_a_class_reads_no_notebook(tmp_path, hand_in, monkeypatch):
    """All notebooks together could exceed the memory, so each is read only when needed."""
    for name in ('ann', 'bob'):
        hand_in(name)
    monkeypatch.setattr(inbox, 'read_file', lambda *_: pytest.fail('a notebook was read'))

    assert [one.path.name for one in look(tmp_path).values()] == [FILE, FILE]


def test_a_file_that_is_gone_when_it_is_read_is_a_problem_of_one_student(tmp_path, hand_in):
    folder = hand_in('ann')
    found = look(tmp_path)['ann']
    (folder / FILE).unlink()

    data, problems = found.read(FILE)

    assert data is None
    assert 'no such file' in problems[0].line()

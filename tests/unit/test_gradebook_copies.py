"""Dated copies of the gradebook, and a gradebook that has lost its content."""

from contextlib import closing, nullcontext
import os
import sqlite3
import subprocess
import time

from collect_sources import configure
import pytest

from autograder.errors import GraderError
from autograder.gradebook import database
from autograder.gradebook.database import connected, refuse_damaged, save_copy

GMTIME = time.gmtime


@pytest.fixture
def course(tmp_path):
    """Return a course whose gradebook has two submissions."""
    url = f'sqlite:///{tmp_path}/autograder/_work/gradebook.db'
    layout = configure(tmp_path, url)
    (layout.work / 'entered').mkdir(parents=True)
    (layout.work / 'entered' / '01.json').write_bytes(b'{"ann": "12345678"}')
    submit(layout, 'ann', 'bob', fill='x' * 20_000)
    return layout


def gradebook(layout):
    return layout.work / 'gradebook.db'


def submit(layout, *students, fill=''):
    with closing(sqlite3.connect(gradebook(layout))) as book, book:
        book.execute('create table if not exists submitted_assignment (student text, fill text)')
        for student in students:
            book.execute('insert into submitted_assignment values (?, ?)', (student, fill))


def students(path):
    with closing(sqlite3.connect(path)) as book:
        return [one for (one,) in book.execute('select student from submitted_assignment')]


@pytest.fixture
def at(monkeypatch):
    """Return a function that sets the clock to a day and a second."""

    def put(day, second=0):
        moment = 1_800_000_000 + 86_400 * day + second
        monkeypatch.setattr(database.time, 'gmtime', lambda: GMTIME(moment))

    put(0)
    return put


def test_a_copy_has_what_the_gradebook_had(course, at):
    copy = save_copy(course)
    submit(course, 'cho')

    assert copy.name == '2027-01-15_080000Z.db'
    assert students(copy) == ['ann', 'bob']
    assert [one.name for one in copy.parent.iterdir()] == [copy.name]


def test_an_unchanged_gradebook_is_not_copied_again(course, at):
    """Grading runs that change nothing must not replace older copies."""
    first = save_copy(course)
    at(1)

    assert save_copy(course) == first
    submit(course, 'cho')
    assert save_copy(course) != first
    assert len(database.copies(course)) == 2


def test_number_of_copies_is_bounded(course, at, monkeypatch):
    monkeypatch.setattr(database, 'MAX_RECENT', 2)
    monkeypatch.setattr(database, 'MAX_DAYS', 3)
    for day in range(5):
        for second in range(3):
            at(day, second)
            submit(course, f'{day}{second}')
            os.utime(gradebook(course), ns=(day, second))
            save_copy(course)

    assert [one.name for one in database.copies(course)] == [
        '2027-01-17_080000Z.db',
        '2027-01-18_080000Z.db',
        '2027-01-19_080000Z.db',
        '2027-01-19_080001Z.db',
        '2027-01-19_080002Z.db',
    ]


def test_size_of_copies_is_bounded(course, at, monkeypatch):
    size = save_copy(course).stat().st_size
    monkeypatch.setattr(database, 'MAX_BYTES', 2 * size + 100)
    for day in range(1, 4):
        at(day)
        os.utime(gradebook(course), ns=(day, day))
        save_copy(course)
    assert len(database.copies(course)) == 2

    monkeypatch.setattr(database, 'MAX_BYTES', 10)
    at(4)
    os.utime(gradebook(course), ns=(4, 4))
    assert database.copies(course) != [save_copy(course)]
    assert [one.name for one in database.copies(course)] == ['2027-01-19_080000Z.db']


def take_rows(path):
    """Keep only the tables, as formgrader does with an empty file."""
    with closing(sqlite3.connect(path)) as book, book:
        book.execute('delete from submitted_assignment')


@pytest.mark.parametrize(
    'damage',
    [
        lambda path: path.write_bytes(b''),
        lambda path: os.truncate(path, path.stat().st_size // 2),
        lambda path: os.truncate(path, 60),
        lambda path: path.write_bytes(b'no database' * 100),
        take_rows,
    ],
    ids=['empty', 'half', 'part of the header', 'text', 'without rows'],
)
def test_a_gradebook_that_lost_its_content_is_refused_with_the_copy(course, at, damage):
    save_copy(course)
    damage(gradebook(course))
    broken = gradebook(course).read_bytes()

    for look in (refuse_damaged, save_copy, lambda layout: connected(layout).__enter__()):
        with pytest.raises(GraderError, match='the gradebook is damaged: ') as failure:
            look(course)
    assert gradebook(course).read_bytes() == broken
    assert len(database.copies(course)) == 1

    command = failure.value.fix.removeprefix('Try: ').partition('. To begin')[0]
    subprocess.run(command, shell=True, check=True)
    refuse_damaged(course)
    assert students(gradebook(course)) == ['ann', 'bob']


def test_damage_that_only_a_full_read_finds_makes_no_copy(course, at):
    copy = save_copy(course)
    data = bytearray(gradebook(course).read_bytes())
    page = 4096 * 3
    data[page : page + 4096] = b'\xff' * 4096
    gradebook(course).write_bytes(data)
    at(1)

    with pytest.raises(GraderError, match=rf'damaged: .+ Try: cp \S+{copy.name} '):
        save_copy(course)
    assert list(copy.parent.iterdir()) == [copy]


def test_without_a_copy_a_backup_is_asked_for(course):
    gradebook(course).write_bytes(b'')

    with pytest.raises(
        GraderError, match='restore it from a backup, because the grader has no copy'
    ):
        refuse_damaged(course)


@pytest.mark.parametrize(
    ('name', 'data', 'filled'),
    [
        ('01.jsonl', b'\n{"student": "ann"}\n', True),
        ('01.json', b'{"ann": ', True),
        ('01.jsonl', b'\n', False),
        ('01.json', b'{}\n', False),
    ],
)
def test_any_journal_with_an_entry_shows_that_a_gradebook_was_filled(course, name, data, filled):
    """A journal of an earlier version or a damaged one counts too."""
    (course.work / 'entered' / '01.json').unlink()
    (course.work / 'entered' / name).write_bytes(data)
    take_rows(gradebook(course))

    with pytest.raises(GraderError, match='no longer has any') if filled else nullcontext():
        refuse_damaged(course)


def test_an_empty_file_that_was_never_filled_is_fine(course):
    journal = course.work / 'entered' / '01.json'
    journal.unlink()
    gradebook(course).write_bytes(b'')
    refuse_damaged(course)
    assert save_copy(course) is None

    gradebook(course).unlink()
    refuse_damaged(course)
    assert save_copy(course) is None


def test_a_locked_gradebook_is_not_called_damaged(course, monkeypatch):
    connect = sqlite3.connect
    monkeypatch.setattr(database.sqlite3, 'connect', lambda path: connect(path, timeout=0))
    with closing(connect(gradebook(course))) as holder:
        holder.execute('begin exclusive')

        refuse_damaged(course)
        with pytest.raises(GraderError, match=r'cannot be copied: database is locked\. Nothing'):
            save_copy(course)
    assert database.copies(course) == []

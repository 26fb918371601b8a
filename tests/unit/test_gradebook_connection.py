"""Messages about a gradebook that cannot be used."""

from contextlib import closing
from pathlib import Path
import sqlite3
import sys

from collect_sources import configure, laid
import pytest

from autograder.collect.course import due_dates
from autograder.errors import GraderError
from autograder.gradebook.database import connected
from autograder.gradebook.journal import (
    drop,
    gradebook_values,
    journal_file,
    make_gradebook,
    refuse_incomplete,
)
from autograder.layout import Layout


@pytest.fixture
def course(tmp_path):
    """Return a course without a gradebook; its settings name a file."""
    return configure(tmp_path, f'sqlite:///{tmp_path}/gradebook.db')


@pytest.fixture
def sql(tmp_path):
    """Return a function that executes a statement in the gradebook file of the course."""

    def execute_sql(statement):
        with closing(sqlite3.connect(tmp_path / 'gradebook.db')) as file:
            file.execute(statement)

    return execute_sql


def test_a_gradebook_that_is_not_there_yet_is_not_made(course):
    with connected(course) as gradebook:
        assert gradebook is None

    assert not (course.root / 'gradebook.db').exists()


def test_a_server_that_does_not_answer_is_named_without_its_password(tmp_path):
    url = 'postgresql+psycopg://grader:secret@127.0.0.1:1/marks'

    with pytest.raises(GraderError) as caught, connected(configure(tmp_path, url)):
        pass

    assert 'grader:***@127.0.0.1:1/marks: ' in caught.value.what
    assert 'secret' not in f'{caught.value.what} {caught.value.fix}'
    assert 'Try: ' in caught.value.fix


@pytest.fixture
def filled(course, sql):
    """Return a course whose gradebook file has one table."""
    sql('create table grade (id text)')
    return course


def execute(layout, *statements):
    with connected(layout) as gradebook:
        for statement in statements:
            gradebook.exec_driver_sql(statement)


@pytest.mark.parametrize(
    ('statements', 'said', 'advice'),
    [
        (
            ('pragma max_page_count = 2', 'insert into grade values (hex(zeroblob(9999)))'),
            'database or disk is full',
            'free space on its disk',
        ),
        (('select * from base_cell',), 'no such table: base_cell', 'put a complete copy'),
    ],
)
def test_what_a_gradebook_file_lacks_is_one_line(filled, statements, said, advice):
    with pytest.raises(GraderError) as caught:
        execute(filled, *statements)

    assert caught.value.what.endswith(f'gradebook.db: the gradebook cannot be used: {said}.')
    assert f'Try: {advice}' in caught.value.fix
    assert 'server' not in caught.value.fix


def test_a_database_without_the_tables_has_no_rows(course, sql):
    sql('create table other (id text)')

    assert gradebook_values(course, '01_topics') == {}
    assert due_dates(course).problem == ''


def journals(layout):
    """Write a journal of this version and one of an earlier version; return both paths."""
    path = journal_file(layout, '01_topics')
    path.parent.mkdir(parents=True)
    path.write_bytes(b'{"ann": "1", "bob": "2"}')
    old = path.with_name('01_topics.jsonl')
    old.write_bytes(b'{"student": "ann", "shown": {"check": [3.0]}}')
    return path, old


def test_nothing_about_a_student_stays_in_the_journals(tmp_path):
    layout = Layout(tmp_path)
    path, old = journals(layout)

    drop(layout, '01_topics', {'ann'})

    assert b'ann' not in path.read_bytes()
    assert not old.exists()


@pytest.mark.nbgrader
def test_a_new_gradebook_begins_without_journals(course):
    laid(course.notebooks, {'01_topics/topics.ipynb': b''})
    found = journals(course)

    make_gradebook(course)

    assert not any(path.exists() for path in found)


@pytest.mark.slow
def test_a_locked_gradebook_file_is_one_line(filled):
    with closing(sqlite3.connect(filled.root / 'gradebook.db')) as other:
        other.execute('begin exclusive')
        with pytest.raises(GraderError) as caught:
            execute(filled, 'pragma busy_timeout = 0', 'select * from grade')

    assert 'the gradebook cannot be used: database is locked.' in caught.value.what
    assert 'Try: close the program that uses it (formgrader' in caught.value.fix


@pytest.mark.nbgrader
def test_a_gradebook_that_has_lost_a_table_is_refused(course, sql):
    """Otherwise nbgrader would create an empty table, which would hide the loss of its rows."""
    refuse_incomplete(course)
    make_gradebook(course)
    refuse_incomplete(course)
    sql('drop table comment')

    with pytest.raises(GraderError, match='the gradebook cannot be used: no such table: comment'):
        refuse_incomplete(course)


@pytest.mark.nbgrader
def test_a_new_gradebook_has_the_version_that_nbgrader_gives_it(course, monkeypatch):
    """With this version, a later nbgrader can upgrade the gradebook by itself."""
    from nbgrader.api import get_alembic_version

    monkeypatch.setenv('PATH', str(Path(sys.prefix) / 'bin'))
    version = get_alembic_version()
    monkeypatch.setenv('PATH', '')
    make_gradebook(course)

    with connected(course) as gradebook:
        rows = gradebook.exec_driver_sql('select * from alembic_version').fetchall()
    assert rows == [(version,)]


@pytest.mark.nbgrader
def test_a_gradebook_that_nbgrader_cannot_open_is_one_sentence(course):
    from autograder.gradebook.converters import opened_gradebook

    (course.root / 'gradebook.db').write_bytes(b'no database' * 100)

    with pytest.raises(GraderError, match='the gradebook is damaged: file is not a database'):
        with opened_gradebook(course):
            pass


@pytest.mark.nbgrader
def test_an_entry_that_nbgrader_refuses_is_one_sentence(course):
    """Another program may have changed the gradebook meanwhile; the database itself works."""
    from nbgrader.api import InvalidEntry

    from autograder.gradebook.converters import opened_gradebook

    make_gradebook(course)

    with pytest.raises(GraderError) as caught, opened_gradebook(course):
        raise InvalidEntry

    assert caught.value.what == 'nbgrader cannot use its gradebook: InvalidEntry.'
    assert 'close other programs that use it' in caught.value.fix


@pytest.mark.nbgrader
def test_the_course_of_settings_is_their_folder_or_the_current_course(tmp_path):
    """A course that was made earlier may set the folder in the plug-ins, which has no effect."""
    from traitlets.config import Config

    from autograder.gradebook.nbgrader_plugin import course_of, GradeOutside

    old = Config({'GradeOutside': {'root': '/elsewhere'}})

    assert course_of(GradeOutside(config=old).config) == Layout.here()
    assert course_of(Config({'CourseDirectory': {'root': str(tmp_path)}})) == Layout(tmp_path)

"""Messages about a gradebook that cannot be used."""

from contextlib import closing
from pathlib import Path
import sqlite3
import sys

import pytest

from autograder.collect.source.times import due_dates
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


def course(folder, url):
    text = f'c = get_config()\nc.CourseDirectory.db_url = {url!r}\n'
    (folder / 'nbgrader_config.py').write_text(text, encoding='utf-8')
    return Layout(folder)


def test_a_gradebook_that_is_not_there_yet_is_not_made(tmp_path):
    with connected(course(tmp_path, f'sqlite:///{tmp_path}/gradebook.db')) as gradebook:
        assert gradebook is None

    assert not (tmp_path / 'gradebook.db').exists()


def test_a_server_that_does_not_answer_is_named_without_its_password(tmp_path):
    url = 'postgresql+psycopg://grader:secret@127.0.0.1:1/marks'

    with pytest.raises(GraderError) as caught, connected(course(tmp_path, url)):
        pass

    assert 'grader:***@127.0.0.1:1/marks: ' in caught.value.what
    assert 'secret' not in f'{caught.value.what} {caught.value.fix}'
    assert 'Try: ' in caught.value.fix


@pytest.fixture
def filled(tmp_path):
    """Return a course whose gradebook file has one table."""
    with closing(sqlite3.connect(tmp_path / 'gradebook.db')) as file:
        file.execute('create table grade (id text)')
    return course(tmp_path, f'sqlite:///{tmp_path}/gradebook.db')


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


def test_a_database_without_the_tables_has_no_rows(tmp_path):
    with closing(sqlite3.connect(tmp_path / 'gradebook.db')) as file:
        file.execute('create table other (id text)')
    layout = course(tmp_path, f'sqlite:///{tmp_path}/gradebook.db')

    assert gradebook_values(layout, '01_topics') == {}
    assert due_dates(layout).problem == ''


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
def test_a_new_gradebook_begins_without_journals(tmp_path):
    layout = course(tmp_path, f'sqlite:///{tmp_path}/gradebook.db')
    (layout.notebooks / '01_topics').mkdir(parents=True)
    (layout.notebooks / '01_topics' / 'topics.ipynb').touch()
    found = journals(layout)

    make_gradebook(layout)

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
def test_a_gradebook_that_has_lost_a_table_is_refused(tmp_path):
    """Otherwise nbgrader would create an empty table, which would hide the loss of its rows."""
    layout = course(tmp_path, f'sqlite:///{tmp_path}/gradebook.db')
    refuse_incomplete(layout)
    make_gradebook(layout)
    refuse_incomplete(layout)
    with closing(sqlite3.connect(tmp_path / 'gradebook.db')) as file:
        file.execute('drop table comment')

    with pytest.raises(GraderError, match='the gradebook cannot be used: no such table: comment'):
        refuse_incomplete(layout)


@pytest.mark.nbgrader
def test_a_new_gradebook_has_the_version_that_nbgrader_gives_it(tmp_path, monkeypatch):
    """With this version, a later nbgrader can upgrade the gradebook by itself."""
    from nbgrader.api import get_alembic_version

    monkeypatch.setenv('PATH', str(Path(sys.prefix) / 'bin'))
    version = get_alembic_version()
    layout = course(tmp_path, f'sqlite:///{tmp_path}/gradebook.db')
    monkeypatch.setenv('PATH', '')
    make_gradebook(layout)

    with connected(layout) as gradebook:
        assert gradebook.exec_driver_sql('select * from alembic_version').fetchall() == [
            (version,)
        ]


@pytest.mark.nbgrader
def test_a_gradebook_that_nbgrader_cannot_open_is_one_sentence(tmp_path):
    from autograder.gradebook.converters import opened_gradebook

    (tmp_path / 'gradebook.db').write_bytes(b'no database' * 100)
    layout = course(tmp_path, f'sqlite:///{tmp_path}/gradebook.db')

    with pytest.raises(GraderError) as caught, opened_gradebook(layout):
        pass

    assert 'the gradebook is damaged: file is not a database' in caught.value.what


@pytest.mark.nbgrader
def test_an_entry_that_nbgrader_refuses_is_one_sentence(tmp_path):
    """Another program may have changed the gradebook meanwhile; the database itself works."""
    from nbgrader.api import InvalidEntry

    from autograder.gradebook.converters import opened_gradebook

    layout = course(tmp_path, f'sqlite:///{tmp_path}/gradebook.db')
    make_gradebook(layout)

    with pytest.raises(GraderError) as caught, opened_gradebook(layout):
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

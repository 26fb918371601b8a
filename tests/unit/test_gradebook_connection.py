"""What is said of a gradebook that cannot be asked."""

from __future__ import annotations

from pathlib import Path
import sys

import pytest

from autograder.errors import GraderError
from autograder.gradebook.connection import connected
from autograder.gradebook.entered import make_gradebook
from autograder.layout import Layout


def course(folder, url):
    """Return a course with this gradebook."""
    text = f'c = get_config()\nc.CourseDirectory.db_url = {url!r}\n'
    (folder / 'nbgrader_config.py').write_text(text, encoding='utf-8')
    return Layout(folder)


def test_a_gradebook_that_is_not_there_yet_is_not_made(tmp_path):
    """A look is no reason to make one."""
    with connected(course(tmp_path, f'sqlite:///{tmp_path}/gradebook.db')) as gradebook:
        assert gradebook is None

    assert not (tmp_path / 'gradebook.db').exists()


def test_a_server_that_does_not_answer_is_named_without_its_password(tmp_path):
    """With or without the driver, which is an extra."""
    url = 'postgresql+psycopg://grader:secret@127.0.0.1:1/marks'

    with pytest.raises(GraderError) as caught, connected(course(tmp_path, url)):
        pass

    assert 'grader:***@127.0.0.1:1/marks: expected' in caught.value.what
    assert 'secret' not in f'{caught.value.what} {caught.value.fix}'
    assert 'Try: ' in caught.value.fix


@pytest.mark.nbgrader
def test_a_new_gradebook_has_the_version_that_nbgrader_gives_it(tmp_path, monkeypatch):
    """A later nbgrader upgrades it from there; its command is not needed for that."""
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
    """And no traceback of SQLAlchemy's."""
    from autograder.gradebook.converters import opened_gradebook

    (tmp_path / 'gradebook.db').write_bytes(b'no database' * 100)
    layout = course(tmp_path, f'sqlite:///{tmp_path}/gradebook.db')

    with pytest.raises(GraderError) as caught, opened_gradebook(layout):
        pass

    assert 'nbgrader cannot use its gradebook: ' in caught.value.what
    assert 'not a database' in caught.value.what

"""What is said of a gradebook that cannot be asked."""

from __future__ import annotations

import pytest

from autograder.errors import GraderError
from autograder.gradebook.connection import connected
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

"""Drawn inputs: equal for all students, different for each purpose, and secret."""

import pytest

from autograder.errors import GraderError
from autograder.exam import inputs
from autograder.layout import Layout


@pytest.fixture(autouse=True)
def secret(tmp_path, monkeypatch):
    """Let each test choose its own secret; return the file for it."""
    monkeypatch.setattr(Layout, 'secret', tmp_path / 'work' / 'secret')
    inputs.course_secret.cache_clear()
    yield Layout.secret
    inputs.course_secret.cache_clear()


def test_same_secret_and_purpose_give_the_same_inputs(monkeypatch):
    """After an appeal, the submission can be graded again with the same inputs."""
    monkeypatch.setenv('COURSE_SECRET', 'one')

    assert inputs.generator('e', 'p').random() == inputs.generator('e', 'p').random()


def test_purpose_exam_and_secret_each_change_the_inputs(monkeypatch):
    """One drawn input reveals nothing about another."""
    monkeypatch.setenv('COURSE_SECRET', 'one')
    drawn = {inputs.generator(*names).random() for names in (('e', 'p'), ('e', 'q'), ('f', 'p'))}
    inputs.course_secret.cache_clear()
    monkeypatch.setenv('COURSE_SECRET', 'two')
    drawn.add(inputs.generator('e', 'p').random())

    assert len(drawn) == 4


def test_secret_is_made_once_and_for_its_owner_alone(monkeypatch, secret):
    monkeypatch.delenv('COURSE_SECRET', raising=False)
    first = inputs.course_secret()
    inputs.course_secret.cache_clear()

    assert inputs.course_secret() == first
    assert len(first) == 64
    assert secret.stat().st_mode & 0o777 == 0o600
    assert list(secret.parent.iterdir()) == [secret]


def test_an_empty_secret_is_refused_wherever_it_stands(monkeypatch, secret):
    """Anyone can compute the inputs of an empty secret, which CI sets if none is configured."""
    monkeypatch.setenv('COURSE_SECRET', '')
    with pytest.raises(GraderError, match='COURSE_SECRET: expected the course secret'):
        inputs.generator('e', 'p')

    monkeypatch.delenv('COURSE_SECRET')
    secret.parent.mkdir()
    secret.write_bytes(b'\n')
    with pytest.raises(GraderError, match='secret: expected the course secret'):
        inputs.course_secret()

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


def test_a_class_that_was_graded_keeps_its_secret(monkeypatch, secret):
    """A missing secret is not replaced; without the fingerprint, another secret is accepted."""
    monkeypatch.delenv('COURSE_SECRET', raising=False)
    layout, noted = Layout.here(), secret.with_name('secret_fingerprint')
    inputs.refuse_other_secret(layout)
    assert not noted.exists()
    inputs.keep_secret(layout)
    inputs.keep_secret(layout)
    assert inputs.course_secret() not in noted.read_bytes()
    former = secret.read_bytes()

    for content, said in {
        None: f'{secret}: the course secret of this class is missing. ',
        b'': f'{secret}: expected the course secret, got an empty string. ',
        b'short': f'{secret}: this class was graded with a different course secret. ',
    }.items():
        secret.unlink() if content is None else secret.write_bytes(content)
        inputs.course_secret.cache_clear()
        with pytest.raises(GraderError) as refused:
            inputs.refuse_other_secret(layout)
        assert str(refused.value) == (
            f'{said}Try: restore {secret} from a backup, or set COURSE_SECRET to the former '
            f'value. To grade everybody again with new inputs, remove {noted}. No mark was '
            'changed.'
        )
        assert secret.exists() == (content is not None)

    monkeypatch.setenv('COURSE_SECRET', former.decode())
    inputs.course_secret.cache_clear()
    inputs.refuse_other_secret(layout)

    secret.write_bytes(former)
    monkeypatch.setenv('COURSE_SECRET', 'another')
    inputs.course_secret.cache_clear()
    with pytest.raises(GraderError, match=r'Try: unset COURSE_SECRET\. To grade everybody again'):
        inputs.refuse_other_secret(layout)

    secret.write_bytes(b'short')
    monkeypatch.delenv('COURSE_SECRET')
    noted.unlink()
    inputs.course_secret.cache_clear()
    inputs.keep_secret(layout)
    assert inputs.course_secret() == b'short'

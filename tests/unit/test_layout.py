"""The choice of the course, and the contents of course.toml."""

from pathlib import Path

import pytest

from autograder import layout
from autograder.errors import GraderError
from autograder.layout import CHOSEN, Layout, read_facts
from environment.places import FILE, stated

ROOT = Path(__file__).resolve().parents[2]
NO_COURSE = f'this is not a course folder; it has no {FILE}'


@pytest.mark.parametrize(
    ('text', 'said'),
    [
        ('name = ', 'cannot be read as TOML: '),
        ("nmae = 'x'", "unknown name 'nmae'"),
        ("exams = 'exams'", "unknown name 'exams'. The exams are always in the folder exams. "),
        ('work = 3', 'expected a string for work, got 3'),
        ("messages = 'x'", "expected a table for messages, got 'x'"),
    ],
)
def test_a_mistake_in_the_file_is_refused_with_its_place(tmp_path, text, said):
    (tmp_path / FILE).write_text(text)

    with pytest.raises(GraderError) as caught:
        read_facts(tmp_path / FILE)
    assert str(caught.value).startswith(f'{tmp_path / FILE}: {said}')


@pytest.mark.parametrize(
    ('text', 'facts'),
    [
        ('', ('course', '', 'autograder/_work')),
        ("name = 'doors'", ('doors', '', 'autograder/_work')),
        ("package = 'num_msgs'\nwork = '_work'", ('course', 'num_msgs', '_work')),
        ('package = "a_b" # ours\nwork="w"\n[messages]', ('course', 'a_b', 'w')),
    ],
)
def test_the_set_up_reads_the_same_facts(tmp_path, text, facts):
    """The set-up has the same defaults, and reads the file without a library for TOML."""
    (tmp_path / FILE).write_text(text)

    course = Layout(tmp_path)
    assert (course.facts.name, course.facts.package, course.facts.work) == facts
    assert course.exams == tmp_path / 'exams'
    assert tuple(stated(tmp_path, name) for name in ('package', 'work')) == facts[1:]


def test_a_line_that_the_set_up_cannot_read_is_refused(tmp_path):
    """If an unreadable line were replaced by a default, a different course would be prepared."""
    (tmp_path / FILE).write_text("package = '''doors_msgs'''")

    with pytest.raises(ValueError, match="expected a line package = 'NAME', got package"):
        stated(tmp_path, 'package')


class TestHere:
    """The course that is used if none is named."""

    def test_it_is_the_one_that_was_chosen(self, tmp_path, monkeypatch):
        """Without the error, a different course could be graded."""
        monkeypatch.setenv(CHOSEN, str(tmp_path))
        with pytest.raises(GraderError, match=NO_COURSE):
            Layout.here()
        (tmp_path / FILE).touch()
        assert Layout.here().root == tmp_path

    def test_it_is_the_one_around_the_folder(self, tmp_path, monkeypatch):
        inside = tmp_path / 'notebooks' / '01_doors'
        inside.mkdir(parents=True)
        monkeypatch.delenv(CHOSEN, raising=False)
        monkeypatch.chdir(inside)
        assert Layout.here().root == ROOT
        monkeypatch.setattr(layout, 'PROJECT', tmp_path)
        with pytest.raises(GraderError, match=f'{inside}: {NO_COURSE}'):
            Layout.here()
        (tmp_path / FILE).touch()
        assert Layout.here().root == tmp_path

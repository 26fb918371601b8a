"""
The check of a release: notebooks, exams and the students' files match.

``make check`` runs this check on the course.
"""

from collect_sources import laid
from fake_grading import answer, cell, FakeExam
import pytest

from autograder.__main__ import main
from autograder.authoring import release as course
from autograder.commands import authoring as command
from autograder.layout import Layout

ANSWER = answer('x')
CHECK = cell('check_talker', "check('talker')", grade=True, points=3)


def unfit(*cells):
    """Return the mistakes in a notebook with some cells."""
    return list(course.unfit_checks({'cells': list(cells)}, 'x.ipynb', (FakeExam(),)))


class TestCheckCells:
    def test_a_fitting_pair_is_fine(self):
        assert unfit(ANSWER, CHECK) == []

    @pytest.mark.parametrize(
        ('cells', 'said'),
        [
            ([ANSWER, {**CHECK, 'source': "check('taker')"}], "expected the one line check('"),
            ([ANSWER, {**CHECK, 'source': "check('talker')\n1/0"}], 'expected the one line'),
            ([CHECK, ANSWER], 'needs the answer talker'),
            ([ANSWER], 'has no check cell'),
            ([ANSWER, cell('check_talker', "check('talker')", grade=True, points=4)], '4 points'),
            ([ANSWER, CHECK, cell('check_x', "check('x')", grade=True, points=1)], 'no exam x'),
        ],
    )
    def test_a_misfit_is_one_line(self, cells, said):
        (line,) = [line for line in unfit(*cells) if said in line]

        assert line.startswith('x.ipynb')

    def test_a_grade_id_used_twice_is_named_with_both_places(self):
        """Ids must differ across notebooks too, because one gradebook serves the whole course."""
        seen = {}
        assert list(course.repeated_ids({'cells': [ANSWER]}, 'a.ipynb', seen)) == []

        (line,) = course.repeated_ids({'cells': [ANSWER]}, 'b.ipynb', seen)

        assert 'b.ipynb' in line
        assert 'a.ipynb' in line

    @pytest.mark.parametrize('kept', [{'outputs': [{'x': 1}]}, {'execution_count': 3}])
    def test_stored_outputs_are_found(self, kept):
        """If outputs were stored, every run would change the file."""
        (line,) = course.stored_outputs({'cells': [ANSWER, {**CHECK, **kept}]}, 'x.ipynb')

        assert line.startswith('x.ipynb, cell 2')


def test_what_is_above_the_course_hides_nothing_of_it(tmp_path):
    """CI machines may check a project out into a folder called build."""
    folder = laid(tmp_path / 'build' / 'notebooks', {'01/a.ipynb': b'', '01/ros_ws/x.py': b''})

    assert sorted(course._contents(folder)) == ['01/a.ipynb']


def test_symbolic_link_in_a_release_is_compared_like_a_file(tmp_path):
    """Git keeps a link, so students would receive it."""
    (tmp_path / 'a.ipynb').write_text('a')
    (tmp_path / 'b.ipynb').symlink_to('a.ipynb')

    assert course._contents(tmp_path) == {'a.ipynb': b'a', 'b.ipynb': b'a'}
    assert course._contents(tmp_path / 'missing') == {}


class TestRelease:
    @pytest.fixture(autouse=True)
    def layout(self, tmp_path, monkeypatch):
        """Return a course whose notebooks need not be generated."""
        monkeypatch.setattr(Layout, 'here', classmethod(lambda cls: Layout(tmp_path)))
        monkeypatch.setattr(command, 'generate', lambda layout, folder: ['01'])

    def test_a_course_that_does_not_fit_together_is_not_packed(self, monkeypatch, capsys):
        """The old bundle is kept, and the mistakes are listed."""
        monkeypatch.setattr(command, 'check', lambda layout: ['x.ipynb: 4 points'])
        monkeypatch.setattr(command, 'pack', lambda *_: pytest.fail('It was packed.'))

        assert main(['release']) == 1

        assert capsys.readouterr().out.splitlines() == [
            'x.ipynb: 4 points',
            'Nothing was packed. Try: correct these mistakes, then release again.',
        ]

    def test_a_course_that_fits_together_is_packed(self, monkeypatch, capsys):
        monkeypatch.setattr(command, 'check', lambda layout: [])
        monkeypatch.setattr(command, 'pack', lambda layout, bundle, answers: 7)

        assert main(['release']) == 0
        assert 'student_bundle.zip contains 7 files' in capsys.readouterr().out

    def test_a_check_writes_nothing(self, monkeypatch, capsys):
        monkeypatch.setattr(command, 'check', lambda layout: [])
        for writer in ('generate', 'pack'):
            monkeypatch.setattr(command, writer, lambda *_: pytest.fail('It was written.'))

        assert main(['release', '--check']) == 0
        assert capsys.readouterr().out == 'The notebooks and the exams agree.\n'

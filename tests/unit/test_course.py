"""What is committed fits together: notebooks, exams, and what students receive."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass
from pathlib import Path
import posixpath
import re
import zipfile

import pytest

from autograder import course
from autograder.handed_in.submission import read_release
from autograder.layout import Layout

LINK = re.compile(r'\]\((?!\w+:)([^)#\s]+)')


@dataclass(frozen=True)
class FakeExam:
    """Name, cells and points."""

    name: str = 'talker'
    cells: tuple[str, ...] = ('talker',)
    max_points: float = 3


def cell(grade_id, source, **marks):
    """Return a code cell with nbgrader's marks."""
    return {
        'cell_type': 'code',
        'metadata': {'nbgrader': {'grade_id': grade_id, **marks}},
        'source': source,
        'outputs': [],
        'execution_count': None,
    }


ANSWER = cell('talker', '%%node talker\nx', solution=True)
CHECK = cell('check_talker', "check('talker')", grade=True, points=3)


def dead_links(name: str, path: Path, files: Container[str]) -> list[str]:
    """Return the relative links of a page or a lesson that lead to none of some files."""
    if path.suffix == '.ipynb':
        cells = read_release(path)['cells']
        text = '\n'.join(cell['source'] for cell in cells if cell['cell_type'] == 'markdown')
    else:
        text = path.read_text(encoding='utf-8') if path.suffix == '.md' else ''
    folder = posixpath.dirname(name)
    return [
        f'{name}: {link}'
        for link in LINK.findall(re.sub(r'```.*?```|`[^`\n]+`', '', text, flags=re.DOTALL))
        if posixpath.normpath(posixpath.join(folder, link)) not in files
    ]


def unfit(*cells, exams=(FakeExam(),)):
    """Return what is wrong with a notebook of some cells."""
    return list(course.unfit_checks({'cells': list(cells)}, 'x.ipynb', '01', exams))


class TestCheckCells:
    """Each exam has one cell, below its answers, with its points."""

    def test_a_fitting_pair_is_fine(self):
        """Nothing is said."""
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
        """It names the cell."""
        (line,) = [line for line in unfit(*cells) if said in line]

        assert line.startswith('x.ipynb')

    def test_a_grade_id_used_twice_is_named_with_both_places(self):
        """Also across notebooks: the gradebook's pages are per course."""
        seen = {}
        assert list(course.repeated_ids({'cells': [ANSWER]}, 'a.ipynb', seen)) == []

        (line,) = course.repeated_ids({'cells': [ANSWER]}, 'b.ipynb', seen)

        assert 'b.ipynb' in line
        assert 'a.ipynb' in line

    @pytest.mark.parametrize('kept', [{'outputs': [{'x': 1}]}, {'execution_count': 3}])
    def test_stored_outputs_are_found(self, kept):
        """They make every run a change."""
        (line,) = course.stored_outputs({'cells': [ANSWER, {**CHECK, **kept}]}, 'x.ipynb')

        assert line.startswith('x.ipynb, cell 2')


def test_what_is_above_the_course_hides_nothing_of_it(tmp_path):
    """Machines that build check projects out in folders called build."""
    folder = tmp_path / 'build' / 'notebooks'
    for name in ('01/a.ipynb', '01/ros_ws/x.py'):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(name)

    assert sorted(course._contents(folder)) == ['01/a.ipynb']


class TestBundle:
    """What students receive."""

    @pytest.fixture
    def layout(self, tmp_path):
        """Return a course with a file of every kind."""
        for name in (
            'README.md',
            'docs/students.md',
            'nbgrader_config.py',
            'notebooks/01/a.ipynb',
            'notebooks/01/ros_ws/src/x.py',
            'solutions/01/a.ipynb',
            'autograder/judging/judge.py',
            'autograder/exams/visible/talker.py',
            'autograder/exams/hidden/talker.py',
            'autograder/_work/gradebook.db',
            'autograder/__pycache__/judge.pyc',
            'tests/submissions/01/pass__reference/expected.json',
            'roslab/api.py',
        ):
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(name)
        (tmp_path / 'roslab' / 'link.py').symlink_to(tmp_path / 'solutions/01/a.ipynb')
        return Layout(tmp_path)

    def test_solutions_hidden_exams_and_grades_stay(self, layout):
        """The list names what goes, not what stays."""
        assert sorted(course.bundled_files(layout)) == [
            'README.md',
            'autograder/exams/visible/talker.py',
            'autograder/judging/judge.py',
            'notebooks/01/a.ipynb',
            'roslab/api.py',
        ]

    def test_the_same_course_gives_the_same_bytes(self, layout, tmp_path):
        """A new bundle means a new course."""
        first, second = tmp_path / 'a.zip', tmp_path / 'b.zip'

        assert course.pack(layout, first) == course.pack(layout, second) == 5
        assert first.read_bytes() == second.read_bytes()
        assert zipfile.ZipFile(first).testzip() is None

    def test_a_bundle_that_cannot_be_made_leaves_the_one_before(
        self, layout, tmp_path, monkeypatch
    ):
        """Half of one would be handed to students."""
        course.pack(layout, tmp_path / 'a.zip')
        before = (tmp_path / 'a.zip').read_bytes()
        broken = {'a': layout.root / 'README.md', 'b': layout.root / 'not there'}
        monkeypatch.setattr(course, 'bundled_files', lambda layout: broken)
        with pytest.raises(FileNotFoundError):
            course.pack(layout, tmp_path / 'a.zip')

        assert (tmp_path / 'a.zip').read_bytes() == before

    def test_its_readme_is_the_page_for_students(self, layout, tmp_path):
        """The project's own speaks of grading and of pages that are not there."""
        course.pack(layout, tmp_path / 'a.zip')

        bundle = zipfile.ZipFile(tmp_path / 'a.zip')
        assert bundle.read('ros2-course/README.md') == b'docs/students.md'
        assert 'ros2-course/docs/students.md' not in bundle.namelist()


class TestThisCourse:
    """The real notebooks and exams."""

    def test_everything_committed_fits_together(self):
        """The same as ``make check`` says."""
        assert course.check(Layout.here()) == []

    def test_the_bundle_of_this_course_has_no_hidden_file(self):
        """Neither exams nor solutions nor submissions."""
        names = course.bundled_files(Layout.here())

        assert any(name.startswith('autograder/exams/visible/') for name in names)
        for part in ('hidden', 'solutions', 'submissions', '_work', 'gradebook.db'):
            assert not [name for name in names if part in name], part

    def test_no_page_of_the_bundle_leads_to_a_file_that_is_not_in_it(self):
        """Neither a page nor a text cell of a lesson; the project's README would."""
        files = course.bundled_files(Layout.here())
        whole = Layout.here().root / 'README.md'
        dead = [link for name, path in files.items() for link in dead_links(name, path, files)]

        assert 'README.md' in files
        assert dead == []
        assert 'README.md: ARCHITECTURE.md' in dead_links('README.md', whole, files)

    def test_what_students_are_told_to_type_is_a_goal(self):
        """The page names goals of the Makefile."""
        root = Layout.here().root
        page = (root / 'docs' / 'students.md').read_text(encoding='utf-8')
        goals = set(re.findall(r'\bmake ([a-z]+)', page))

        assert {'lab', 'doctor', 'publisher', 'subscriber'} <= goals
        makefile = (root / 'Makefile').read_text(encoding='utf-8')
        assert [goal for goal in goals if f'\n{goal}:' not in makefile] == []

    def test_nbgrader_is_told_the_same_folders(self):
        """Layout and nbgrader_config.py agree."""
        from autograder.gradebook.settings import load_config

        layout = Layout.here()
        said = load_config(layout).CourseDirectory

        assert layout.root / said.source_directory == layout.solutions
        assert layout.root / said.release_directory == layout.notebooks
        assert layout.root / said.submitted_directory == layout.submitted
        assert said.db_url == f'sqlite:///{layout.work}/gradebook.db'

"""A course of one's own: made, prepared with its own message package, released and graded."""

from __future__ import annotations

import json
import os
from pathlib import Path
import subprocess

from nbclient import NotebookClient
import nbformat
import pytest

from autograder.authoring.new_course import new_course, new_exam
from autograder.errors import GraderError
from autograder.layout import Layout
from environment.places import Places
from environment.plan import make_plan
from tests.ros.stand_in import go, install_colcon_only, sourced_shell

RIGHT = 'math.hypot(point.x, point.y, point.z)'
WRONG = 'point.x**2 + point.y**2 + point.z**2'


@pytest.fixture(scope='module')
def course(tmp_path_factory) -> Path:
    """Return the folder of a prepared course with one exercise."""
    root = tmp_path_factory.mktemp('courses') / 'points'
    new_course(root)
    new_exam(Layout(root), 'far_points', '01_points')
    plan = make_plan(Places.of('.venv', root), sourced_shell())
    go(plan, 'venv')
    install_colcon_only(plan)
    go(plan, 'workspace', 'clock', 'files', 'trial')
    assert run(root, 'autograder.authoring.release', 'release').returncode == 0
    return root


def run(course: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a module in the folder of a course, as its page says."""
    kept = {name: os.environ[name] for name in ('HOME', 'PATH') if name in os.environ}
    return subprocess.run(
        ['.venv/bin/python', '-m', 'environment', 'run', 'python', '-m', *words],
        cwd=course,
        env=kept,
        capture_output=True,
        text=True,
        timeout=300,
    )


@pytest.mark.ros
@pytest.mark.slow
class TestGrading:
    """The commands of an instructor, in a folder without anything of this course."""

    def test_it_fits_together_and_the_grader_proves_itself(self, course):
        """The exam sends a message of geometry_msgs and hears one of the course's own."""
        said = run(course, 'autograder.authoring.release', 'check').stdout.splitlines()
        assert said[-1] == 'The notebooks and the exams fit together.'
        assert run(course, 'autograder', 'self-check').stdout.splitlines() == [
            '01_points: the reference solution has 6 of 6, as it must.',
            '01_points: the untouched release has 0 of 6, as it must.',
        ]

    def test_a_class_is_graded_in_its_own_gradebook(self, course):
        """One is right, one has made the mistake that the exam names."""
        text = (course / 'solutions/01_points/points.ipynb').read_text(encoding='utf-8')
        for student, code in (('ann', RIGHT), ('bob', WRONG)):
            file = course / '_work' / 'submitted' / student / '01_points' / 'points.ipynb'
            file.parent.mkdir(parents=True)
            file.write_text(text.replace(RIGHT, code), encoding='utf-8')

        done = run(course, 'autograder', 'grade')

        assert done.returncode == 0, done.stdout + done.stderr
        results = json.loads((course / '_work/reports/01_points/results.json').read_text())
        found = {
            one['student']: [exam['checks'][-1]['cause_id'] for exam in one['exams']]
            for one in results
        }
        assert found == {'ann': [''], 'bob': ['no_root']}
        assert (course / '_work' / 'gradebook.db').is_file()

    def test_a_learner_checks_in_a_notebook(self, course, monkeypatch):
        """The kernel knows the course's messages, and ``check`` the course by its folder."""
        monkeypatch.setenv('JUPYTER_PATH', str(course / '.venv' / 'share' / 'jupyter'))
        folder = course / 'solutions' / '01_points'
        notebook = nbformat.read(folder / 'points.ipynb', 4)
        where = {'metadata': {'path': str(folder)}}
        NotebookClient(notebook, kernel_name='ros2_jazzy', resources=where).execute()

        assert 'far_points: 6 of 6 points in the visible checks' in str(notebook.cells[-1].outputs)


class TestBeginning:
    """What is there already stays as it is."""

    def test_a_folder_that_holds_something_is_refused(self, tmp_path):
        """Also one that is a file."""
        (tmp_path / 'full').mkdir()
        (tmp_path / 'full' / 'mine').touch()
        (tmp_path / 'file').touch()
        for name in ('full', 'file'):
            with pytest.raises(GraderError, match='expected no such folder, or an empty one'):
                new_course(tmp_path / name)
        assert sorted(path.name for path in tmp_path.iterdir()) == ['file', 'full']

    @pytest.mark.parametrize('name', ['Doors', '2doors', 'd', 'doors!'])
    def test_a_name_that_no_ros_package_has_is_refused(self, tmp_path, name):
        """It names the message package."""
        with pytest.raises(GraderError, match='expected small letters'):
            new_course(tmp_path / name)

    def test_an_exercise_replaces_none(self, tmp_path):
        """Nothing of the second is written."""
        root = tmp_path / 'doors'
        new_course(root)
        new_exam(Layout(root), 'far_points', '01_points')
        before = sorted(root.rglob('*'))
        with pytest.raises(GraderError, match='it is there already'):
            new_exam(Layout(root), 'near_points', '01_points')
        assert sorted(root.rglob('*')) == before

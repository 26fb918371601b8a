"""
Create another course from the wheel, prepare it with its own message package, and grade it.

ROS 2 and the packages of the lock come from the running environment: pip downloads nothing here.
"""

from collections.abc import Mapping
import json
import os
from pathlib import Path
import shutil
import subprocess
import sys
import zipfile

from nbclient import NotebookClient
import nbformat
import pytest

from autograder.authoring.new_course import new_course, new_exam
from autograder.errors import GraderError
from autograder.layout import Layout
from tests.ros import stand_in

ROOT = Path(__file__).resolve().parents[2]
OURS = ('autograder', 'drawing', 'environment', 'roslab')
STAY = {'_work', '__pycache__'}
"""Subfolders that belong to this course or to one machine, not to the wheel."""
RIGHT = 'math.hypot(point.x, point.y, point.z)'
WRONG = 'point.x**2 + point.y**2 + point.z**2'


VENV = """
import os, pathlib, runpy, sys
from environment.places import Places
from environment.plan import make_plan
stand_in = runpy.run_path(sys.argv[1])
plan = make_plan(Places.of('.venv', pathlib.Path.cwd()), os.environ)
stand_in['go'](plan, 'venv')
stand_in['install_colcon_only'](plan)
"""
"""What ``environment prepare`` does with the network: make the venv and run pip in it."""
WHERE = """
import sys, autograder, drawing, environment, roslab
print(*sys.path, sep='\\n')
print(autograder.__file__, drawing.__file__, environment.__file__, roslab.__file__, sep='\\n')
"""


@pytest.fixture(scope='module')
def source(tmp_path_factory) -> Path:
    """Return a copy of the project in which a class was graded."""
    folder = tmp_path_factory.mktemp('project') / 'source'
    left = shutil.ignore_patterns('.*', '__pycache__', '_work', 'ros_ws', 'build', '*.egg-info')
    shutil.copytree(ROOT, folder, symlinks=True, ignore=left)
    (folder / 'autograder' / '_work').mkdir()
    (folder / 'autograder' / '_work' / 'gradebook.db').touch()
    return folder


@pytest.fixture(scope='module')
def wheel(source) -> Path:
    """Return the built wheel."""
    options = ['--no-deps', '--no-index', '--no-build-isolation', '--wheel-dir', '..']
    finished([sys.executable, '-m', 'pip', 'wheel', *options, '.'], source, os.environ)
    return next(source.parent.glob('*.whl'))


@pytest.fixture(scope='module')
def engine(wheel) -> Path:
    """Return the interpreter of a virtual environment with nothing but the wheel."""
    shell = stand_in.sourced_shell()
    folder = wheel.parent / 'engine'
    finished([shell['PYTHON'], '-m', 'venv', '--without-pip', str(folder)], folder.parent, shell)
    python = folder / 'bin' / 'python'
    pip = [sys.executable, '-m', 'pip', '--python', str(python), 'install', '--no-index']
    finished([*pip, '--no-deps', str(wheel)], folder, os.environ)
    return python


@pytest.fixture(scope='module')
def course(tmp_path_factory, engine) -> Path:
    """Return the folder of a prepared course with two exercises in one lesson."""
    root, shell = tmp_path_factory.mktemp('courses') / 'points', stand_in.sourced_shell()
    grader = [str(engine.with_name('autograder'))]
    finished([*grader, 'new-course', 'points'], root.parent, shell)
    for name in ('far_points', 'near_points'):
        finished([*grader, 'new-exam', name, '--lesson', '01_points'], root, shell)
    finished([str(engine), '-c', VENV, stand_in.__file__], root, shell)
    finished([str(engine), '-m', 'environment', 'prepare'], root, shell)
    assert run(root, 'autograder', 'release').returncode == 0
    return root


def finished(command: list[str], folder: Path, env: Mapping[str, str]) -> str:
    """Run a command that must succeed, and return its output."""
    done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def run(course: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run a module in the folder of a course, as documented."""
    kept = {name: os.environ[name] for name in ('HOME', 'PATH') if name in os.environ}
    return subprocess.run(
        ['.venv/bin/python', '-m', 'environment', 'run', 'python', '-m', *words],
        cwd=course,
        env=kept,
        capture_output=True,
        text=True,
        timeout=300,
    )


@pytest.mark.slow
class TestWheel:
    def test_it_holds_engine_and_toolkit_and_nothing_of_the_course(self, source, wheel):
        """The wheel has every file of the four packages except exams and results of grading."""
        kept = (path for name in OURS for path in (source / name).rglob('*') if path.is_file())
        names = {path.relative_to(source).as_posix() for path in kept}
        mine = {name for name in names if not STAY & set(Path(name).parts)}
        with zipfile.ZipFile(wheel) as archive:
            held = {name for name in archive.namelist() if '.dist-info/' not in name}

        assert held == mine
        assert not [name for name in held if '/hidden/' in name or 'solutions' in name]


@pytest.mark.ros
@pytest.mark.slow
class TestGrading:
    def test_all_of_it_comes_from_the_wheel(self, course, engine):
        """The clone is not on the module path."""
        python = str(course / '.venv' / 'bin' / 'python')
        said = finished([python, '-m', 'environment', 'run', 'python', '-c', WHERE], course, {})
        *path, grader, pictures, set_up, toolkit = said.splitlines()

        assert str(ROOT) not in path
        for file in (grader, pictures, set_up, toolkit):
            assert Path(file).is_relative_to(engine.parents[1])

    def test_it_fits_together_and_the_grader_proves_itself(self, course):
        """The exam sends a geometry_msgs message and receives one of the course's own types."""
        said = run(course, 'autograder', 'release', '--check').stdout.splitlines()
        assert said[-1] == 'The notebooks and the exams agree.'
        assert run(course, 'autograder', 'self-check').stdout.splitlines() == [
            '01_points: the reference solution has 12 of 12, as expected.',
            '01_points: the untouched release has 0 of 12, as expected.',
        ]

    def test_a_class_is_graded_in_its_own_gradebook(self, course):
        """One submission is right; the other makes the mistake that the exam reports."""
        text = (course / 'solutions/01_points/points.ipynb').read_text(encoding='utf-8')
        for student, code in (('ann', RIGHT), ('bob', WRONG)):
            file = course / '_work' / 'submitted' / student / '01_points' / 'points.ipynb'
            file.parent.mkdir(parents=True)
            file.write_text(text.replace(RIGHT, code), encoding='utf-8')

        done = run(course, 'environment', 'run', 'autograder', 'grade')

        assert done.returncode == 0, done.stdout + done.stderr
        results = json.loads((course / '_work/reports/01_points/results.json').read_text())
        found = {
            one['student']: [exam['checks'][-1]['cause_id'] for exam in one['exams']]
            for one in results
        }
        assert found == {'ann': ['', ''], 'bob': ['no_root', 'no_root']}
        assert (course / '_work' / 'gradebook.db').is_file()

    def test_a_learner_checks_in_a_notebook(self, course, monkeypatch):
        """The kernel imports the course's messages; ``check`` finds the course by its folder."""
        monkeypatch.setenv('JUPYTER_PATH', str(course / '.venv' / 'share' / 'jupyter'))
        folder = course / 'solutions' / '01_points'
        notebook = nbformat.read(folder / 'points.ipynb', 4)
        where = {'metadata': {'path': str(folder)}}
        NotebookClient(notebook, kernel_name='ros2_jazzy', resources=where).execute()

        for name in ('far_points', 'near_points'):
            assert f'{name}: 6 of 6 points in the visible checks' in str(notebook.cells)


class TestBeginning:
    def test_a_folder_that_holds_something_is_refused(self, tmp_path):
        """The same applies to an existing file."""
        (tmp_path / 'full').mkdir()
        (tmp_path / 'full' / 'mine').touch()
        (tmp_path / 'file').touch()
        for name in ('full', 'file'):
            with pytest.raises(GraderError, match='this folder exists and is not empty'):
                new_course(tmp_path / name)
        assert sorted(path.name for path in tmp_path.iterdir()) == ['file', 'full']

    @pytest.mark.parametrize('name', ['Doors', '2doors', 'd', 'doors!'])
    def test_a_name_that_no_ros_package_has_is_refused(self, tmp_path, name):
        """The name is also used for the message package."""
        with pytest.raises(GraderError, match='expected a lower-case letter'):
            new_course(tmp_path / name)

    def test_an_exercise_replaces_none(self, tmp_path):
        """A second exercise of the same name writes no file."""
        root = tmp_path / 'doors'
        new_course(root)
        new_exam(Layout(root), 'far_points', '01_points')
        before = sorted(root.rglob('*'))
        with pytest.raises(GraderError, match='this file already exists'):
            new_exam(Layout(root), 'far_points', '02_more')
        assert sorted(root.rglob('*')) == before

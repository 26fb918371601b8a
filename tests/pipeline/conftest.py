"""A course in a temporary folder, with the real lesson and an engine that needs no ROS."""

from pathlib import Path
import shutil
import sys

import pytest

from autograder.layout import Layout

ASSIGNMENT = '07_temperature_monitor'
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(Path(__file__).resolve().parent))  # for fake_engine, here and in nbgrader


@pytest.fixture(scope='session')
def released(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a course folder with a generated release, to be copied."""
    from autograder.gradebook import converters
    from autograder.gradebook.record import enter_assignment

    root = tmp_path_factory.mktemp('course')
    shutil.copytree(
        ROOT / 'solutions' / ASSIGNMENT,
        root / 'solutions' / ASSIGNMENT,
        ignore=shutil.ignore_patterns('ros_ws', '.ipynb_checkpoints'),
    )
    config = (ROOT / 'nbgrader_config.py').read_text(encoding='utf-8')
    config += "\nc.GradeOutside.engine_factory = 'fake_engine.make'\n"
    (root / 'nbgrader_config.py').write_text(config, encoding='utf-8')
    shutil.copy(ROOT / 'course.toml', root)
    (root / 'exams').symlink_to(ROOT / 'exams')
    layout = Layout(root)
    converters.generate(layout, ASSIGNMENT, layout.notebooks, database=False)
    enter_assignment(layout, ASSIGNMENT)  # nbgrader needs two seconds to create a gradebook
    return root


def copied(root: Path, folder: Path) -> Layout:
    """Return a copy of a course, in a new folder below this one."""
    return Layout(shutil.copytree(root, folder / 'course', symlinks=True))


@pytest.fixture
def course(released: Path, tmp_path: Path) -> Layout:
    """Return a separate course for each test."""
    return copied(released, tmp_path)


@pytest.fixture(scope='session')
def run():
    """Return a function that runs a small program, see :mod:`small_programs`."""
    from small_programs import runner

    return runner()

"""Test the exam of lesson 10: a Python package as a folder, and as cells of a notebook."""

import pytest

from autograder.commands import run as run_command
from autograder.grading.examine import Engine
from autograder.layout import Layout
from autograder.sandboxes.choose import strongest
from tests.judgement.references import exercises

LAYOUT = Layout.here()
PACKAGE = 'my_robot_pkg'

pytestmark = [pytest.mark.pipeline, pytest.mark.ros, pytest.mark.slow]


@pytest.fixture
def folder(tmp_path):
    """Return the folder of the reference, as ``ros2 pkg create`` and the cells write it."""
    reference = next(one for one in exercises() if one.name == 'limiter')
    files = {**reference.files, f'resource/{PACKAGE}': '', f'{PACKAGE}/__init__.py': ''}
    files[f'{PACKAGE}/limiter.py'] = files.pop('limiter.py')
    for name, text in files.items():
        path = tmp_path / PACKAGE / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding='utf-8')
    return tmp_path / PACKAGE


def result_of(folder):
    """Return the result of the visible exam on a folder."""
    tasks = run_command.find_tasks(
        folder, run_command.exams_named('limiter', LAYOUT, False), LAYOUT
    )
    ((_, result),) = run_command.run_tasks(tasks, Engine(strongest(), folder.parent / 'kept'))
    return result


def test_whole_folder_has_full_marks(folder):
    """The folder's own marker and __init__.py are used."""
    result = result_of(folder)

    assert (result.points, result.failed) == (20, ())


@pytest.mark.parametrize('place', ['limiter.py', 'src/limiter.py', f'{PACKAGE}/nodes/limiter.py'])
def test_node_in_a_wrong_folder_is_not_repaired(folder, place):
    """The grader chooses the folder only for files from cells."""
    (folder / place).parent.mkdir(exist_ok=True)
    (folder / PACKAGE / 'limiter.py').rename(folder / place)

    result = result_of(folder)

    assert result.points == 2
    assert result.failed[0].cause_id == 'entry_point_module'
    assert 'my_robot_pkg.limiter' in result.failed[0].cause

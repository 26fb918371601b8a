"""Test preparation from a sourced ROS 2 installation, with a stand-in prefix."""

import os
import subprocess
import sys

import pytest

from autograder.exam import catalog
from autograder.grading.examine import Engine
from autograder.sandboxes import isolation
from autograder.sandboxes.sandbox import Sandbox
from environment.places import Places, PROJECT
from environment.plan import make_plan
from environment.ros import ros_environment
from tests.ros.stand_in import go, install_colcon_only, sourced_shell

COURSE_PACKAGE = 'temp_monitor_pkg'
pytestmark = [pytest.mark.ros, pytest.mark.slow]


@pytest.fixture
def shell():
    """Return the environment of a shell in which the stand-in is sourced."""
    return sourced_shell()


@pytest.fixture
def places(tmp_path):
    """Return the places of a project that has only the ROS package."""
    for name in (COURSE_PACKAGE, 'course.toml'):
        (tmp_path / name).symlink_to(PROJECT / name)
    return Places.of('.venv', tmp_path)


def test_prepare_sourced_prefix_builds_and_serves_later_shells(shell, places):
    """A sourced ROS 2 is used instead of the wheels, even by shells that source nothing."""
    plan = make_plan(places, shell)
    assert plan.kind == 'sourced'

    go(plan, 'venv')
    install_colcon_only(plan)
    go(plan, 'workspace', 'files', 'trial')

    ros = ros_environment(places.venv)
    assert 'include-system-site-packages = true' in (places.venv / 'pyvenv.cfg').read_text()
    assert ros.kind == 'sourced'
    assert sys.prefix in ros.read_only
    code = 'import rclpy, temp_monitor_pkg.msg as m; print(m.__file__)'
    done = subprocess.run(
        [ros.python, '-c', code], env=ros.variables, capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith(str(places.prefix))

    later = make_plan(places, {'HOME': shell['HOME'], 'PATH': shell['PATH']})
    assert later.kind == 'sourced'
    assert later.description().base_variables['PYTHONPATH'] == shell['PYTHONPATH']

    # The clock's library is compiled here, and depends on nothing from the wheels.
    exam = catalog.load('talker')
    solution = (
        PROJECT / 'tests' / 'submissions' / '03_topics' / 'pass__functions_style' / 'talker.py'
    )
    sandbox = Sandbox(isolation.full(os.geteuid() == 0), ros)
    result = Engine(sandbox).run(exam, {'talker.py': solution.read_text()})
    assert result.points == exam.max_points, result


def test_make_plan_sourced_without_rclpy_takes_the_wheels(shell, places):
    """Variables of an installation whose rclpy cannot be imported are not trusted."""
    plan = make_plan(places, {**shell, 'PYTHONPATH': ''})

    assert plan.kind == 'wheels'


def test_make_plan_wheels_asked_for_ignores_the_sourced_prefix(shell, places):
    """ROS_SOURCE=wheels overrides a sourced installation."""
    assert make_plan(places, {**shell, 'ROS_SOURCE': 'wheels'}).kind == 'wheels'

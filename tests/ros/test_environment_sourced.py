"""
Preparing from a sourced ROS 2 installation, tried with a stand-in prefix.

The stand-in is the prepared environment itself, seen as an apt installation is seen: a Python
without packages of its own, and ROS 2 reached only through what a setup file exports.
"""

import io
import os
import subprocess
import sys
import sysconfig

import pytest

from environment import prepare, stamps
from environment.describe import join_paths
from environment.places import COURSE_PACKAGE, Places, PROJECT
from environment.plan import make_plan
from environment.ros import ros_environment
from environment.steps import run_steps, Screen

pytestmark = [pytest.mark.ros, pytest.mark.slow]


@pytest.fixture
def shell():
    """Return the environment of a shell in which the stand-in is sourced."""
    base = ros_environment().base_variables
    exported = ('AMENT_PREFIX_PATH', 'LD_LIBRARY_PATH', 'CMAKE_TOOLCHAIN_FILE')
    return {
        **{name: base[name] for name in exported if name in base},
        'HOME': os.environ.get('HOME', '/tmp'),
        'PATH': '/usr/local/bin:/usr/bin:/bin',
        'PYTHON': getattr(sys, '_base_executable', sys.executable),
        'PYTHONPATH': join_paths(sysconfig.get_path('purelib'), base.get('PYTHONPATH', '')),
        'ROS_DISTRO': 'jazzy',
    }


@pytest.fixture
def places(tmp_path):
    """Return the places of a project that has only the ROS package."""
    (tmp_path / COURSE_PACKAGE).symlink_to(PROJECT / COURSE_PACKAGE)
    return Places.of('.venv', tmp_path)


def install_colcon_only(plan):
    """Replace pip, which would need the network: make only colcon callable."""
    colcon = plan.places.venv / 'bin' / 'colcon'
    colcon.write_text(
        f'#!{plan.places.python}\n'
        'import sys\nfrom colcon_core.command import main\nsys.exit(main())\n'
    )
    colcon.chmod(0o755)
    stamps.write_stamp(plan.places, 'packages', plan.digest('packages'))


def go(plan, *names):
    """Run some of the steps of a plan; return what was shown."""
    steps = [step for step in prepare.steps_of(plan) if step.name in names]
    out = io.StringIO()
    assert run_steps(steps, plan.places.logs, Screen(out)), out.getvalue()
    return out.getvalue()


def test_prepare_sourced_prefix_builds_and_serves_later_shells(shell, places):
    """A sourced ROS 2 is used instead of the wheels, also by shells that source nothing."""
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


def test_make_plan_sourced_without_rclpy_takes_the_wheels(shell, places):
    """Variables of an installation whose rclpy cannot be imported are not trusted."""
    plan = make_plan(places, {**shell, 'PYTHONPATH': ''})

    assert plan.kind == 'wheels'


def test_make_plan_wheels_asked_for_ignores_the_sourced_prefix(shell, places):
    """ROS_SOURCE=wheels wins over what is sourced."""
    assert make_plan(places, {**shell, 'ROS_SOURCE': 'wheels'}).kind == 'wheels'

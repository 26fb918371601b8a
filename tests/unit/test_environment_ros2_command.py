"""The ros2 command that the set-up installs, and that gives way to a real one."""

from dataclasses import replace
import os
from pathlib import Path
import subprocess
import sys

import pytest

from environment import doctor, install_files, ros2_command
from environment.places import Places, PROJECT
from environment.ros import describe_wheels


@pytest.fixture
def places(tmp_path):
    places = Places(venv=tmp_path / 'a venv', project=tmp_path)
    (places.venv / 'bin').mkdir(parents=True)
    return places


@pytest.fixture
def wheels(places):
    """Return the description of an environment that was installed from wheels."""
    return describe_wheels(places, '/usr')


@pytest.fixture
def sourced(tmp_path, wheels):
    """Return the description of an installation that already has a ros2 command."""
    folder = tmp_path / 'opt' / 'bin'
    folder.mkdir(parents=True)
    program = folder / 'ros2'
    program.write_text('#!/bin/sh\necho "the real one: $*"\n')
    program.chmod(0o755)
    path = f'{Path(wheels.python).parent}{os.pathsep}{folder}'
    return replace(wheels, kind='sourced', variables={**wheels.variables, 'PATH': path})


def test_overlaid_keeps_what_the_shell_says_in_front(wheels):
    ours = wheels.variables['AMENT_PREFIX_PATH']
    shell = {
        'PATH': '/usr/bin',
        'AMENT_PREFIX_PATH': f'/my/ws:{ours}',
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET',
    }

    env = ros2_command.overlaid(shell, wheels)
    assert env['AMENT_PREFIX_PATH'] == f'/my/ws:{ours}'
    assert env['ROS_AUTOMATIC_DISCOVERY_RANGE'] == 'SUBNET'
    assert env['PATH'] == f'{Path(wheels.python).parent}:/usr/bin'
    assert env['LD_LIBRARY_PATH'] == wheels.variables['LD_LIBRARY_PATH']
    assert Path(env['FASTRTPS_DEFAULT_PROFILES_FILE']).is_file()


def test_discovery_variables_leave_another_middleware_alone(wheels):
    other = replace(wheels, variables={'RMW_IMPLEMENTATION': 'rmw_cyclonedds_cpp'})

    assert ros2_command.discovery_variables(other) == {}


def test_script_is_installed_with_the_wheels(places, wheels):
    """The wheels have no ros2, so the environment gets the course's; the doctor reports this."""
    install_files.write_ros2_command(places, wheels)
    script = places.venv / 'bin' / 'ros2'

    assert os.access(script, os.X_OK)
    found = doctor.check_ros2_command(places, wheels)
    assert (found.state, "the course's own" in found.detail) == (doctor.OK, True)


def test_script_steps_aside_for_a_real_one(places, wheels, sourced):
    """An installation's own ros2 is never hidden, even by the script of an older set-up."""
    install_files.write_ros2_command(places, wheels)
    install_files.write_ros2_command(places, sourced)

    assert not (places.venv / 'bin' / 'ros2').exists()
    found = doctor.check_ros2_command(places, sourced)
    assert found.detail == ros2_command.installed_ros2(sourced)


def test_foreign_ros2_in_the_venv_is_left_alone(places, sourced):
    """Only a script that this set-up wrote is removed."""
    script = places.venv / 'bin' / 'ros2'
    script.write_text('#!/bin/sh\n')
    install_files.write_ros2_command(places, sourced)

    assert script.read_text() == '#!/bin/sh\n'


def test_missing_script_is_found_by_the_doctor(places, wheels):
    """Lessons that show commands need the script."""
    found = doctor.check_ros2_command(places, wheels)

    assert (found.state, found.fix) == (doctor.MISSING, doctor.PREPARE)


def run_main(places):
    """Run the file as the script does."""
    return subprocess.run(
        [sys.executable, '-S', '-E', ros2_command.__file__, str(places.venv), 'topic', 'list'],
        env={'PATH': '/usr/bin:/bin'},
        capture_output=True,
        text=True,
    )


def test_command_called_beside_a_real_one_starts_that(places, sourced):
    install_files.write_description(places, sourced)

    done = run_main(places)

    assert done.stdout == 'the real one: topic list\n'
    assert 'belongs to the ROS 2 installation' in done.stderr


def test_command_without_description_says_what_to_do(places):
    done = run_main(places)

    assert done.returncode == 1
    assert 'Try: make doctor' in done.stderr


def test_autograder_starts_the_grader_from_any_folder(places, tmp_path):
    """Modules in the current folder, which may be a student's, are not imported."""
    install_files.write_autograder_command(places)
    (tmp_path / 'rich.py').write_text('raise SystemExit("this file is from a student")')
    places.python.write_text(f'#!/bin/sh\nexec {sys.executable} "$@"\n')
    places.python.chmod(0o755)

    done = subprocess.run(
        [places.venv / 'bin' / 'autograder', 'grade', '--jobs', 'a b'],
        cwd=tmp_path,
        env={'PYTHONPATH': str(PROJECT)},
        capture_output=True,
        text=True,
    )

    assert done.returncode == 2
    assert done.stderr.startswith('usage: autograder grade [-h] ')
    assert "got 'a b'" in done.stderr

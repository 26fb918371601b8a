"""The description of the ROS environment: written, read, and complete."""

from dataclasses import replace
import json
import os
import subprocess

from collect_sources import laid
import pytest

from environment import install_files
from environment.places import Places, PROJECT
from environment.ros import (
    _outermost,
    describe_sourced,
    describe_wheels,
    FILE_NAME,
    join_paths,
    ros_environment,
    RosEnvironment,
    RosEnvironmentError,
    trial_of_messages,
)


@pytest.fixture
def places(tmp_path):
    """Return the places of a venv with one bundled library folder and a built package."""
    places = Places.of('.venv', tmp_path)
    site = places.venv / 'lib' / 'python3.12' / 'site-packages'
    (site / 'ros_rcl.libs').mkdir(parents=True)
    (places.prefix / 'lib' / 'python3.12' / 'site-packages').mkdir(parents=True)
    return places


@pytest.fixture
def ros(places):
    return describe_wheels(places, '/usr')


def test_ros_environment_round_trip_is_equal(places, ros):
    install_files.write_description(places, ros)

    assert ros_environment(places.venv) == ros


def test_course_without_a_package_is_described_without_one(ros):
    """The trial of such a course imports only rclpy."""
    assert ros.package == ''
    assert trial_of_messages(ros.package) == 'import rclpy'


@pytest.mark.parametrize('text', [None, '', '{', '[]', '{"kind": "wheels"}'])
def test_ros_environment_missing_or_damaged_names_doctor(tmp_path, text):
    if text is not None:
        (tmp_path / FILE_NAME).write_text(text)

    with pytest.raises(RosEnvironmentError, match='make doctor') as caught:
        ros_environment(tmp_path)
    assert FILE_NAME in str(caught.value)


def test_from_json_wrong_type_is_refused(ros):
    text = replace(ros, variables=[]).to_json()

    with pytest.raises(ValueError, match='variables'):
        RosEnvironment.from_json(text)


def test_describe_wheels_has_all_that_a_process_needs(places, ros):
    """Logs go to stdout, message fields are checked, and no Python process re-executes itself."""
    variables = ros.variables

    assert variables['RCUTILS_LOGGING_USE_STDOUT'] == '1'
    assert variables['ROS_PYTHON_CHECK_FIELDS'] == '1'
    assert variables['ROS_AUTOMATIC_DISCOVERY_RANGE'] == 'LOCALHOST'
    assert variables['_ROS_WHEELS_BOOTSTRAP_COMPLETE'] == '1'
    assert variables['PATH'].split(os.pathsep)[0] == str(places.venv / 'bin')
    assert 'ros_rcl.libs' in variables['LD_LIBRARY_PATH']


def test_describe_wheels_only_variables_have_the_workspace(places, ros):
    """A student's package is built without access to the course's own package."""
    assert str(places.prefix) in ros.variables['AMENT_PREFIX_PATH']
    assert str(places.prefix) in ros.variables['PYTHONPATH']
    assert str(places.prefix) not in str(ros.base_variables)


def test_describe_sourced_keeps_the_shell_without_the_wheels(places):
    shell = {
        'AMENT_PREFIX_PATH': '/opt/ros/jazzy',
        'LD_LIBRARY_PATH': '/opt/ros/jazzy/lib',
        'PYTHONPATH': '/opt/ros/jazzy/lib/python3.12/site-packages',
        'ROS_DISTRO': 'jazzy',
        'SECRET': 'x',
    }

    ros = describe_sourced(places, '/usr', shell)

    assert ros.kind == 'sourced'
    assert ros.base_variables['PYTHONPATH'] == shell['PYTHONPATH']
    assert ros.variables['PYTHONPATH'].endswith(shell['PYTHONPATH'])
    assert '/opt/ros/jazzy/bin' in ros.variables['PATH'].split(os.pathsep)
    assert not {'SECRET', 'CMAKE_TOOLCHAIN_FILE', '_ROS_WHEELS_BOOTSTRAP_COMPLETE'} & set(
        ros.variables
    )


def test_read_only_has_outermost_folders_without_usr(tmp_path):
    """A sandbox gets each folder once, and nothing below /usr, which every sandbox has."""
    inner = tmp_path / 'a' / 'b'
    inner.mkdir(parents=True)

    folders = _outermost([str(inner), str(tmp_path / 'a'), '/usr/bin', '/no/such'])

    assert folders == [str(tmp_path / 'a')]


def test_join_paths_keeps_order_and_drops_repeats():
    """Empty entries, which would mean the current folder, are dropped."""
    assert join_paths('b:a', ['', 'a'], 'c::b') == 'b:a:c'


def test_kernel_spec_carries_the_environment(places, ros):
    """The kernel needs no variable from the shell, and appends the learner's own PATH."""
    spec = install_files.kernel_spec(ros)

    assert spec['display_name'] == 'ROS 2 Jazzy'
    assert spec['argv'][0] == ros.python
    assert spec['argv'][-1] == '--ext=roslab.error_hints'
    assert spec['metadata']['supported_encryption'] == ['curve']
    assert spec['env']['FASTRTPS_DEFAULT_PROFILES_FILE'].endswith('environment/fastdds.xml')
    assert spec['env']['PATH'] == f'{places.venv}/bin:${{PATH}}'
    assert spec['env']['PYTHONPATH'] == ros.variables['PYTHONPATH']


def test_install_files_adapts_jupyterlab(places, ros):
    """
    The project is importable in the venv, and JupyterLab does not offer to show news.

    JupyterLab saves an edited cell before its exercise is checked, and loads the course's style
    sheet, which its own rules do not override.
    """
    install_files.install_files(places, ros)

    path_file = places.site_packages() / 'ros2_course.pth'
    assert path_file.read_text().splitlines() == [str(places.project), str(PROJECT)]
    style = places.site_packages() / 'jupyter_server' / 'static' / 'custom' / 'custom.css'
    assert 'word-break: normal' in style.read_text()
    assert '.jp-mod-selected { overflow-anchor: auto; }' in style.read_text()
    page, lab, overrides = (
        json.loads((places.venv / path).read_text())
        for path in (
            'etc/jupyter/labconfig/page_config.json',
            'etc/jupyter/jupyter_lab_config.json',
            'share/jupyter/lab/settings/overrides.json',
        )
    )
    assert page['disabledExtensions']['@jupyterlab/apputils-extension:announcements'] is True
    assert lab['LabApp']['custom_css'] is True
    saving = {'autosaveInterval': 10, 'lastModifiedCheckMargin': 10_000}
    assert overrides['@jupyterlab/docmanager-extension:plugin'] == saving


PANELS = [f'@jupyter/nbgrader:{name}' for name in install_files.INSTRUCTORS_PANELS]


@pytest.mark.parametrize('students', [True, False])
def test_students_see_nothing_of_nbgrader_that_is_for_instructors(places, students):
    """A copy without hidden exams is for students."""
    if not students:
        (places.project / 'exams' / 'hidden').mkdir(parents=True)
    install_files.write_jupyter_settings(places)

    folder = places.venv / 'etc' / 'jupyter'
    page = json.loads((folder / 'labconfig' / 'page_config.json').read_text())
    server = json.loads((folder / 'jupyter_server_config.json').read_text())['ServerApp']
    assert [name in page['disabledExtensions'] for name in PANELS] == [students] * len(PANELS)
    assert server['jpserver_extensions'] == {
        'nbgrader.server_extensions.course_list': not students,
        'nbgrader.server_extensions.formgrader': not students,
    }


@pytest.fixture
def terminal(places):
    """Return a function that types lines in a JupyterLab terminal."""
    (places.project / 'Makefile').write_text('publisher:\n\t@echo published $(ARGS)\n')
    (places.venv / 'bin').mkdir()
    (places.venv / 'bin' / 'ros2').write_text('#!/bin/sh\necho the ros2 of the course\n')
    (places.venv / 'bin' / 'ros2').chmod(0o755)
    # A user's .bashrc may reset PATH, as a login shell does.
    (places.project / '.bashrc').write_text('PATH=/usr/bin:/bin\n')
    install_files.write_terminal(places)
    variables = {'HOME': str(places.project), 'PATH': '/usr/bin:/bin', 'SHELL': '/bin/bash'}
    variables |= {'MAKELEVEL': '1', 'MAKEFLAGS': ' -- ARGS=--no-browser'}  # as make lab sets it
    bash = ['bash', '--rcfile', str(places.terminal / 'bashrc'), '-i']

    def typed(lines, folder, command=bash):
        done = subprocess.run(
            command, cwd=folder, env=variables, input=lines, capture_output=True, text=True
        )
        return done.stdout.splitlines()

    return typed


def test_a_terminal_finds_ros2_whatever_the_shell_sets(terminal, places, tmp_path):
    said = ['the ros2 of the course']

    assert terminal('ros2\n', tmp_path, [str(places.terminal / 'shell')]) == said
    assert terminal('ros2\n', tmp_path) == said


def test_the_goals_of_the_course_work_in_every_folder_of_a_terminal(terminal, places, tmp_path):
    """A Makefile in the current folder, or one chosen with -f or -C, takes precedence."""
    notebooks = tmp_path / 'notebooks'
    notebooks.mkdir()
    own = laid(tmp_path / 'own', {'Makefile': b'publisher:\n\t@echo my own\n'})

    shell = [str(places.terminal / 'shell')]
    assert terminal('make publisher\n', notebooks, shell) == ['published']
    assert terminal('make publisher\n', own, shell) == ['my own']
    assert terminal(f'make -f {own}/Makefile publisher\n', notebooks, shell) == ['my own']
    assert terminal(f'make -sC {own} publisher\n', notebooks, shell) == ['my own']

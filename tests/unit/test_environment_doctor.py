"""The doctor's lines: the state, what was found, and the command to type."""

from dataclasses import replace
import os
from pathlib import Path
import sys

from collect_sources import laid
import pytest

from environment import doctor, interpreters, stamps, system
from environment import pins as pins_module
from environment.places import LOCK_FILE, Places
from environment.plan import Plan
from environment.ros import ros_environment, RosEnvironment


def test_line_names_the_fix_of_what_is_missing():
    line = doctor.Finding('make', doctor.OK, 'GNU Make', 'install it').line()
    missing = doctor.Finding(
        'make', doctor.MISSING, 'not installed', 'apt-get install make'
    ).line()

    assert line.split() == ['ok', 'make', 'GNU', 'Make']
    assert missing.startswith('missing ')
    assert missing.endswith('-> apt-get install make')


@pytest.fixture
def course(tmp_path):
    """Return a function that makes a course with a package, without its environment."""

    def made(package):
        laid(tmp_path, {'course.toml': f'package = {package!r}\n'.encode()})
        return Places.of('.venv', tmp_path)

    return made


def test_findings_nothing_prepared_names_every_requirement(course):
    found = list(doctor.findings(course('temp_monitor_pkg'), os.environ))

    names = {finding.name for finding in found}
    assert {'python', 'venv', 'C++ compiler', 'cmake', 'isolation', 'rclpy'} <= names
    assert {'message generators', 'temp_monitor_pkg', 'Jupyter kernel', '/dev/shm'} <= names
    assert all(finding.fix for finding in found if finding.state != doctor.OK)
    assert [f.state for f in found if f.name in ('venv', 'rclpy')] == [doctor.MISSING] * 2
    assert all('\n' not in finding.line() for finding in found)


@pytest.mark.parametrize(
    ('package', 'detail'),
    [('doors_msgs', 'programs: none'), ('', 'the course has none')],
)
def test_package_of_messages_only_is_complete(course, package, detail):
    places = course(package)
    places.prefix.mkdir(parents=True)
    places.notes.mkdir()
    stamps.stamp_of(places.notes, 'workspace').write_text('done')

    found = doctor.check_workspace(places, 'done')
    assert (found.state, found.detail) == (doctor.OK, detail)


def test_stale_build_of_the_package_is_weak_with_its_fix(course, monkeypatch):
    places = course('doors')
    laid(places.project, {'doors/door.py': b'OPEN = 1'})
    places.prefix.mkdir(parents=True)
    python = interpreters.probe(sys.executable, os.environ)
    ros = RosEnvironment('wheels', sys.executable, {}, {}, (), '')
    monkeypatch.setattr(doctor, '_description', lambda _: ros)
    monkeypatch.setattr(doctor, 'check_by_running', lambda _: ())
    monkeypatch.setattr(interpreters, 'probe', lambda *_: python)
    places.notes.mkdir()
    built = Plan(places, {}, 'wheels', python).digest('workspace')
    stamps.stamp_of(places.notes, 'workspace').write_text(built)

    def line():
        return next(one.line() for one in doctor.findings(places, {}) if one.name == 'doors')

    assert line().startswith('ok ')
    laid(places.project, {'doors/door.py': b'OPEN = 2'})
    assert line().startswith('weak ')
    assert line().endswith('packages have changed since the build  -> make prepare')


def test_check_python_says_what_to_install():
    """Debian's Python without headers lacks only one package."""
    this = interpreters.probe(sys.executable, os.environ)
    bare = replace(this, path='/usr/bin/python3.12', release='3.12.3', has_headers=False)
    none, incomplete = doctor.check_python(None, None), doctor.check_python(bare, None)

    assert (none.state, incomplete.state) == (doctor.MISSING, doctor.MISSING)
    assert 'python3-venv' in none.fix
    assert incomplete.fix == 'sudo apt-get install -y python3.12-dev'


def test_check_packages_wrong_version_is_missing(tmp_path):
    site = tmp_path / '.venv' / 'lib' / 'python3.12' / 'site-packages'
    pins = pins_module.pins_for(LOCK_FILE.read_text(), '3.12')
    for name, version in pins.items():
        shown = '0.1' if name == 'ruff' else version
        text = f'Metadata-Version: 2.1\nName: {name}\nVersion: {shown}\n'
        laid(site, {f'{name}-{version}.dist-info/METADATA': text.encode()})

    found = list(doctor.check_packages(Places.of('.venv', tmp_path), '3.12', ros=True))

    bad = [finding for finding in found if finding.state != doctor.OK]
    assert [finding.name for finding in bad] == ['tests and checks']
    assert f'ruff 0.1 instead of {pins["ruff"]}' in bad[0].detail


def test_check_room_little_is_weak():
    finding = doctor.check_room('disk space', Path('/'), 2**40, 'make room')

    assert finding.state == doctor.WEAK
    assert 'needed' in finding.detail


def test_closed_shared_memory_is_missing_with_the_command_that_opens_it(monkeypatch):
    """Free space is useless if the user may not create a file."""
    monkeypatch.setattr(system.os, 'access', lambda *_: False)

    finding = doctor.check_shared_memory()

    assert finding.state == doctor.MISSING
    assert 'chmod 1777 /dev/shm' in finding.fix


@pytest.mark.parametrize(
    ('have', 'expected'),
    [
        ('apt-get', 'sudo apt-get install -y g++ bubblewrap python3.12-dev'),
        ('dnf', 'sudo dnf install -y gcc-c++ bubblewrap python3-devel'),
        ('', 'sudo apt-get install -y g++ bubblewrap python3.12-dev'),
    ],
)
def test_command_to_type_is_one_line_of_the_system(have, expected, monkeypatch):
    tools = [tool for tool in system.TOOLS if tool.command in ('g++', 'bwrap')]

    monkeypatch.setattr(system.shutil, 'which', lambda name: name if name == have else None)

    assert system.command_to_type(tools, ['python3.12-dev']) == expected


def test_missing_tools_names_what_is_not_on_the_path(monkeypatch):
    monkeypatch.setattr(system.shutil, 'which', lambda name: None if name == 'bwrap' else name)
    missing = system.missing_tools()

    assert [tool.title for tool in missing] == ['bubblewrap']
    assert not missing[0].required


@pytest.mark.ros
def test_isolation_that_does_not_work_is_weak_with_the_graders_fix(tmp_path):
    """The grader's own test decides. Lessons work without a sandbox, so nothing is missing."""
    ros = ros_environment(Path(sys.prefix))
    without = replace(ros, variables={**ros.variables, 'PATH': str(tmp_path)})
    *_, last = doctor.check_by_running(without)

    assert (last.name, last.state) == ('isolation', doctor.WEAK)
    assert 'bubblewrap is not installed. Lessons work' in last.detail
    assert 'apt-get install -y bubblewrap' in last.detail

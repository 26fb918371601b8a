"""Test claims about packages that define messages, with colcon and CMake."""

import os
from pathlib import Path
import subprocess
import sys

import pytest

claim = pytest.mark.claim
pytestmark = [pytest.mark.ros, pytest.mark.slow]

MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>lab</name><version>0.1.0</version><description>A try.</description>
  <maintainer email="me@example.org">Me</maintainer><license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>ament_cmake_python</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <exec_depend>rosidl_default_runtime</exec_depend>
  {group}
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
GROUP = '<member_of_group>rosidl_interface_packages</member_of_group>'
RULES = """cmake_minimum_required(VERSION 3.16)
project(lab)
find_package(ament_cmake REQUIRED)
find_package(ament_cmake_python REQUIRED)
find_package(rosidl_default_generators REQUIRED)
{rules}
ament_package()
"""


def build(folder: Path, files: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """Write a package and build it as in a terminal, but without the C++ code of messages."""
    for name, text in files.items():
        path = folder / 'src' / 'lab' / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding='utf-8')
    return subprocess.run(
        ['colcon', 'build', '--event-handlers', 'console_direct+'],
        cwd=folder,
        env={**os.environ, 'ROS2_COURSE_GRADED_BUILD': '1'},
        capture_output=True,
        text=True,
        check=False,
    )


def configure(folder: Path, rules: str, group: str = GROUP) -> str:
    """Return CMake's error for a package with these rules, which CMake must refuse."""
    built = build(
        folder,
        {
            'msg/Num.msg': 'int64 num\n',
            'lab/__init__.py': '',
            'package.xml': MANIFEST.format(group=group),
            'CMakeLists.txt': RULES.format(rules=rules),
        },
    )
    assert built.returncode != 0
    return built.stdout + built.stderr


GENERATE = 'rosidl_generate_interfaces(${PROJECT_NAME} "msg/Num.msg")'


@claim('M1', 'C1', 'C25')
def test_python_package_builds_and_has_no_messages(tmp_path):
    """ament_python ignores the message file without a warning; the import fails."""
    manifest = MANIFEST.format(group=GROUP).replace(
        '<build_type>ament_cmake<', '<build_type>ament_python<'
    )
    built = build(
        tmp_path,
        {
            'msg/Num.msg': 'int64 num\n',
            'lab/__init__.py': '',
            'resource/lab': '',
            'setup.py': "from setuptools import setup\nsetup(name='lab', packages=['lab'])\n",
            'package.xml': manifest,
        },
    )
    assert built.returncode == 0, built.stdout + built.stderr

    (place,) = tmp_path.glob('install/lab/lib/python3*/site-packages')
    tried = subprocess.run(
        [sys.executable, '-c', f'import sys; sys.path.insert(0, {str(place)!r}); import lab.msg'],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "No module named 'lab.msg'" in tried.stderr


@claim('M4', 'C4')
def test_without_the_group_cmake_stops(tmp_path):
    assert 'member_of_group' in configure(tmp_path, GENERATE, group='')


@claim('M6', 'C2')
def test_first_argument_is_the_name_of_the_project(tmp_path):
    """A different name builds, but Python then fails to find its libraries."""
    built = build(
        tmp_path,
        {
            'msg/Num.msg': 'int64 num\n',
            'package.xml': MANIFEST.format(group=GROUP),
            'CMakeLists.txt': RULES.format(rules='rosidl_generate_interfaces(x "msg/Num.msg")'),
        },
    )
    assert built.returncode == 0, built.stdout + built.stderr

    libraries = tmp_path / 'install' / 'lab' / 'lib'
    (place,) = libraries.glob('python3*/site-packages')
    text = (
        f'import sys; sys.path.insert(0, {str(place)!r})\n'
        'from lab.msg import Num\n'
        'from rclpy.serialization import serialize_message\n'
        'serialize_message(Num(num=3))\n'
    )
    path = f'{libraries}:{os.environ.get("LD_LIBRARY_PATH", "")}'
    tried = subprocess.run(
        [sys.executable, '-c', text],
        env={**os.environ, 'LD_LIBRARY_PATH': path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert tried.returncode != 0
    assert 'liblab__rosidl_typesupport' in tried.stderr


@claim('C25')
def test_module_of_the_same_name_cannot_be_installed_twice(tmp_path):
    """Messages add a Python module with the package's name; a second such module collides."""
    said = configure(tmp_path, f'{GENERATE}\nament_python_install_package(${{PROJECT_NAME}})')

    assert 'another target with the same name already exists' in ' '.join(said.split())


@claim('M5', 'C2')
def test_package_of_a_used_type_is_a_dependency(tmp_path):
    """The generators refuse a Time field without DEPENDENCIES builtin_interfaces."""
    built = build(
        tmp_path,
        {
            'msg/Num.msg': 'builtin_interfaces/Time stamp\n',
            'package.xml': MANIFEST.format(group=GROUP),
            'CMakeLists.txt': RULES.format(rules=GENERATE),
        },
    )

    assert built.returncode != 0
    assert 'builtin_interfaces' in built.stdout + built.stderr

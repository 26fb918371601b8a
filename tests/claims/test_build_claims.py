"""Test the claims about builds that no cell shows, with colcon and CMake."""

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
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
RULES = """cmake_minimum_required(VERSION 3.16)
project(lab)
find_package(ament_cmake REQUIRED)
find_package(ament_cmake_python REQUIRED)
find_package(rosidl_default_generators REQUIRED)
{rules}
ament_package()
"""


def build(folder: Path, rules: str) -> subprocess.CompletedProcess[str]:
    """Build a package as in a terminal, but without the C++ code of its message."""
    files = {
        'msg/Num.msg': 'int64 num\n',
        'lab/__init__.py': '',
        'package.xml': MANIFEST,
        'CMakeLists.txt': RULES.format(rules=rules),
    }
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


@claim('M6')
def test_first_argument_is_the_name_of_the_project(tmp_path):
    """A different name builds, but Python then fails to find its libraries."""
    built = build(tmp_path, 'rosidl_generate_interfaces(x "msg/Num.msg")')
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
    built = build(
        tmp_path,
        'rosidl_generate_interfaces(${PROJECT_NAME} "msg/Num.msg")\n'
        'ament_python_install_package(${PROJECT_NAME})',
    )
    said = ' '.join((built.stdout + built.stderr).split())

    assert built.returncode != 0
    assert 'another target with the same name already exists' in said

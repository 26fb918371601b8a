"""The grader builds only the parts of a message package that Python needs."""

from contextlib import ExitStack
import os
from pathlib import Path
import shutil
import subprocess
import sys

import pytest

from autograder.exam import catalog
from autograder.grading.examine import Engine
from autograder.layout import Layout
from autograder.sandboxes import landlock
from autograder.sandboxes.sandbox import HERE, Sandbox
from benchmarks.visible_checks import files_of
from tests.own_domain import own_domain

pytestmark = [pytest.mark.ros, pytest.mark.slow, pytest.mark.timeout(300)]

PACKAGE = {
    'package.xml': """<package format="3">
  <name>knots</name><version>0.1.0</version><description>Speeds of boats.</description>
  <maintainer email="a@b.example">a</maintainer><license>MIT</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
""",
    'CMakeLists.txt': """cmake_minimum_required(VERSION 3.8)
project(knots)
find_package(ament_cmake REQUIRED)
find_package(std_msgs REQUIRED)
find_package(rosidl_default_generators REQUIRED)
rosidl_generate_interfaces(${PROJECT_NAME} "msg/Speed.msg" DEPENDENCIES std_msgs)
ament_package()
""",
    'msg/Speed.msg': 'std_msgs/Header header\nfloat32 knots\n',
}
TOOLCHAIN = Path(os.environ.get('CMAKE_TOOLCHAIN_FILE', ''))
HEADERS = {'fixed_size_string.hpp', 'longobject.h'}
BUILD = f"""
import sys
sys.path.insert(0, {str(HERE / 'inside')!r})
import build_package
build_package.build(sys.argv[1], 'knots')
"""


@pytest.fixture(scope='module')
def source(tmp_path_factory):
    """Return the folder of a package."""
    folder = tmp_path_factory.mktemp('knots') / 'source'
    for name, text in PACKAGE.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding='utf-8')
    return folder


def built(source: Path, place: Path, toolchain: Path) -> str:
    """Build the package as the grader does, and return the output of the build."""
    place.mkdir(exist_ok=True)
    settings = {'TMPDIR': str(place), 'CMAKE_TOOLCHAIN_FILE': str(toolchain)}
    return subprocess.run(
        [sys.executable, '-c', BUILD, str(source)],
        env={**os.environ, **settings},
        check=True,
        capture_output=True,
        text=True,
    ).stdout


@pytest.fixture(scope='module')
def package(source):
    """Return where the grader built the package, and the output of the build."""
    place = source.parent / 'with'
    return place, built(source, place, TOOLCHAIN)


def test_messages_are_built_for_python_and_not_for_cpp(package):
    """C++ code takes two fifths of a build's CPU time, and no graded program uses it."""
    place, said = package
    libraries = {path.name for path in (place / 'install' / 'lib').glob('lib*.so')}
    [modules] = (place / 'install').glob('lib/python3*/site-packages')

    assert 'libknots__rosidl_typesupport_fastrtps_c.so' in libraries
    assert not [name for name in libraries if name.endswith('_cpp.so')]
    assert printed(modules, libraries_in=place / 'install' / 'lib') == 'knots/msg/Speed 3.5'
    # CMake does not repeat the search that the set-up has done.
    assert 'Found Python3' not in said
    # The headers of Fast DDS and Python are precompiled, so their own includes are not read.
    assert not HEADERS & read_by_the_compiler(place / 'build' / 'knots')


@pytest.mark.parametrize('mode', ['landlock', 'none'])
def test_weaker_modes_build_too(mode, tmp_path):
    """Builds work even if no file in the workspace may be executed."""
    if mode == 'landlock' and (refused := landlock.refusal(root=False)[0]):
        pytest.skip(refused)
    exam = catalog.load('temperature_message', hidden=False)
    files = files_of(Layout.here(), exam, solved=True)
    result = Engine(Sandbox(mode), tmp_path, fresh=True).run(exam, files)

    assert result.points == result.max_points


def read_by_the_compiler(build: Path) -> set[str]:
    """Return the names of all files that the compilers read."""
    ran = subprocess.run(
        ['ninja', '-C', str(build), '-t', 'deps'], check=True, capture_output=True, text=True
    )
    return {Path(line.strip()).name for line in ran.stdout.splitlines()}


def test_without_notes_cmake_looks_for_itself_and_the_result_is_the_same(
    source, package, tmp_path
):
    bare = tmp_path / 'bare'
    shutil.copytree(TOOLCHAIN.parent, bare, ignore=shutil.ignore_patterns('known'))
    for file in bare.glob('*.cmake'):
        text = file.read_text('utf-8').replace(str(TOOLCHAIN.parent), str(bare))
        file.write_text(text, encoding='utf-8')

    said = built(source, tmp_path / 'without', bare / TOOLCHAIN.name)

    assert 'Found Python3' in said
    assert read_by_the_compiler(tmp_path / 'without' / 'build' / 'knots') >= HEADERS
    assert symbols(package[0]) == symbols(tmp_path / 'without')


def symbols(place: Path) -> dict[str, str]:
    """Return the symbols that each installed library defines and needs, and the other files."""
    found = {}
    for path in sorted((place / 'install').rglob('*')):
        name = str(path.relative_to(place))
        if path.suffix == '.so':
            asked = ['readelf', '--dyn-syms', '--dynamic', '--wide', str(path)]
            ran = subprocess.run(asked, check=True, capture_output=True, text=True)
            lines = [line for line in ran.stdout.splitlines() if ': ' in line]
            symbols_and_libraries = [
                line for line in lines if 'NEEDED' in line or 'GLOBAL' in line
            ]
            found[name] = '\n'.join(sorted(line.split()[-1] for line in symbols_and_libraries))
        elif path.is_file():
            found[name] = ''
    return found


def printed(modules: Path, libraries_in: Path) -> str:
    """Return what a new Python prints about a message that it sent through a topic."""
    program = (
        'import rclpy, sys\n'
        'from knots.msg import Speed\n'
        'rclpy.init(args=[], domain_id=int(sys.argv[1]))\n'
        "node = rclpy.create_node('sailor')\n"
        'heard = []\n'
        "node.create_subscription(Speed, 'speed', heard.append, 1)\n"
        "speed = node.create_publisher(Speed, 'speed', 1)\n"
        'while not heard:\n'
        '    speed.publish(Speed(knots=3.5))\n'
        '    rclpy.spin_once(node, timeout_sec=0.1)\n'
        "print('knots/msg/' + type(heard[0]).__name__, heard[0].knots)\n"
    )
    paths = {
        'PYTHONPATH': f'{modules}:{os.environ.get("PYTHONPATH", "")}',
        'LD_LIBRARY_PATH': f'{libraries_in}:{os.environ.get("LD_LIBRARY_PATH", "")}',
    }
    with ExitStack() as until:
        ran = subprocess.run(
            [sys.executable, '-c', program, str(own_domain(until))],
            env={**os.environ, **paths},
            check=True,
            capture_output=True,
            text=True,
        )
    return ran.stdout.strip()


def test_what_learners_build_has_cpp_too():
    """The set-up built the course's own package completely, as in a terminal."""
    prefixes = [Path(one) for one in os.environ['AMENT_PREFIX_PATH'].split(':')]

    header = 'include/temp_monitor_pkg/**/temperature.hpp'
    assert [file for prefix in prefixes for file in prefix.glob(header)]

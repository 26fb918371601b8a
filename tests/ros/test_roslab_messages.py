"""Messages that are typed in a notebook, built by colcon and used in the same kernel."""

from pathlib import Path
import shutil

import live_kernels
import pytest

kernel = live_kernels.new_kernel

pytestmark = [pytest.mark.ros, pytest.mark.slow]

TEMPERATURE = """%%rosmsg Temperature
float64 temperature_value
string unit
builtin_interfaces/Time timestamp
string sensor_id
int32 made_by_the_learner
"""
PACKAGE = """%%rospkg package.xml
<?xml version="1.0"?>
<package format="3">
  <name>temp_monitor_pkg</name>
  <version>0.1.0</version>
  <description>A learner's package.</description>
  <maintainer email="me@example.org">Me</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <depend>builtin_interfaces</depend>
  <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
CMAKE = """%%rospkg CMakeLists.txt
cmake_minimum_required(VERSION 3.16)
project(temp_monitor_pkg)
find_package(ament_cmake REQUIRED)
find_package(builtin_interfaces REQUIRED)
find_package(rosidl_default_generators REQUIRED)
rosidl_generate_interfaces(${PROJECT_NAME} "msg/Temperature.msg" DEPENDENCIES builtin_interfaces)
ament_export_dependencies(rosidl_default_runtime)
ament_package()
"""
USE = """
from temp_monitor_pkg.msg import Temperature
from rclpy.node import Node
node = start(lambda: Node('sender'))
publisher = node.create_publisher(Temperature, 'readings', 10)
heard = listen('readings', Temperature)
wait_until(lambda: publisher.get_subscription_count())
publisher.publish(Temperature(made_by_the_learner=7, unit='Celsius'))
heard.wait(1)[0].made_by_the_learner
"""


def write(kernel, *cells):
    """Run the cells that save the package."""
    kernel.run('from roslab import *')
    for cell in cells:
        outputs = kernel.run(cell)
        assert outputs.error is None, outputs.error


@pytest.fixture(scope='module')
def built(tmp_path_factory):
    """Return a kernel in which a learner's package was written and built, and the output."""
    with live_kernels.started(tmp_path_factory.mktemp('built')) as kernel:
        write(kernel, TEMPERATURE, PACKAGE, CMAKE)
        yield kernel, kernel.run('report = build_messages()')


def test_learners_messages_take_the_place_of_the_courses(built):
    """A learner's message is built once, and the notebook and its commands use it."""
    kernel, outputs = built
    again = kernel.run('bool(build_messages())')

    assert 'Ready: from temp_monitor_pkg.msg import Temperature' in outputs.text
    assert outputs.streams['stderr'] == ''
    assert 'unchanged' in again.text
    assert again.value == 'True'
    used = kernel.run(USE)
    assert used.value == '7'
    assert used.streams['stderr'] == ''
    shown = kernel.run('!ros2 interface show temp_monitor_pkg/msg/Temperature')
    assert 'int32 made_by_the_learner' in shown.text
    maps = Path(f'/proc/{kernel.pid}/maps').read_text().splitlines()
    loaded = {line.split()[-1] for line in maps if 'temp_monitor_pkg' in line}
    assert loaded
    assert all('/ros_ws/install/' in path for path in loaded)


def test_learners_own_message_is_recorded_and_replayed(built):
    """A bag holds the learner's type, the command describes it, and a replay sends it again."""
    kernel, _ = built
    kernel.run('stop_all()')
    kernel.run(
        'from temp_monitor_pkg.msg import Temperature\nfrom rclpy.node import Node\n'
        'class Sender(Node):\n'
        '  def __init__(self):\n'
        '    super().__init__("sender")\n'
        '    self.out = self.create_publisher(Temperature, "readings", 10)\n'
        '    self.create_timer(0.02, self.send)\n'
        '  def send(self):\n'
        '    self.out.publish(Temperature(made_by_the_learner=7))\n'
    )
    recorded = kernel.run('start(Sender); record("run.mcap", "readings", seconds=1.0)')
    printed = kernel.run('!ros2 bag info run.mcap')
    kernel.run('stop_all(); heard = listen("readings", Temperature)')
    replayed = kernel.run('replay("run.mcap", rate=10); heard.wait(1)[0].made_by_the_learner')

    assert recorded.error is None, recorded.error
    assert 'Type: temp_monitor_pkg/msg/Temperature' in recorded.value
    assert recorded.value in printed.text.replace('\r', '')
    assert replayed.error is None, replayed.error
    assert replayed.value == '7'
    assert replayed.streams['stderr'] == ''


def test_changed_message_asks_for_a_restart(built):
    """The kernel keeps using the message that it has loaded, although its files were replaced."""
    kernel, _ = built
    kernel.run('stop_all()')
    assert kernel.run(USE).value == '7'

    write(kernel, TEMPERATURE.replace('made_by_the_learner', 'changed'))
    rebuilt = kernel.run('report = build_messages()')
    assert 'restart the kernel' in rebuilt.text
    assert kernel.run('bool(report), report.restart').value == '(True, True)'
    assert kernel.run(USE).value == '7'


@pytest.mark.claim('J7')
def test_course_messages_that_are_in_use_stay(kernel, tmp_path):
    """A build that is interrupted leaves no process, and the next one succeeds."""
    kernel.run('from temp_monitor_pkg.msg import Temperature')
    write(kernel, TEMPERATURE, PACKAGE, CMAKE)
    interrupted = kernel.interrupt_at('build_messages()', 'Building')
    children = kernel.run('import psutil; len(psutil.Process().children(recursive=True))')
    shutil.rmtree(tmp_path / 'ros_ws' / 'build', ignore_errors=True)
    built = kernel.run('report = build_messages()')

    assert interrupted.error['ename'] == 'KeyboardInterrupt'
    assert children.value == '0'

    assert 'restart the kernel' in built.text
    assert kernel.run('report.ok, hasattr(Temperature, "sensor_id")').value == '(True, True)'


@pytest.mark.parametrize(
    ('cells', 'cause', 'said'),
    [
        (
            (TEMPERATURE.replace('float64', 'float'), PACKAGE, CMAKE),
            'unknown_type',
            'msg/Temperature.msg, line 1',
        ),
        (
            (TEMPERATURE, PACKAGE, CMAKE.replace('ament_package()', '')),
            'missing_ament_package',
            'last line',
        ),
        (
            (TEMPERATURE, PACKAGE, CMAKE.replace('interfaces(${PROJECT_NAME}', 'interfaces(temp')),
            'target_name',
            'is temp, but the project is called temp_monitor_pkg',
        ),
        (
            (TEMPERATURE, PACKAGE, CMAKE.partition('rosidl_gen')[0] + 'ament_package()'),
            'no_messages',
            'rosidl_generate_interfaces',
        ),
    ],
    ids=['unknown type', 'no ament_package', 'other target', 'no messages'],
)
def test_failed_build_says_where_and_what_to_try(kernel, cells, cause, said):
    write(kernel, *cells)
    outputs = kernel.run('report = build_messages()')

    assert 'was not built' in outputs.text
    assert said in outputs.text
    assert outputs.streams['stderr'] == ''
    value = kernel.run('bool(report), report.diagnosis.cause_id, report.log.is_file()').value
    assert value == f"(False, '{cause}', True)"


def test_build_before_the_cells_names_the_cell_to_run(kernel):
    """Without a package, one sentence names the cell to run, and nothing is built."""
    kernel.run('from roslab import *')
    outputs = kernel.run('build_messages()')

    assert '%%rospkg package.xml' in '\n'.join(outputs.error['traceback'])


def test_build_of_a_stub_is_not_started(kernel, tmp_path):
    write(kernel, TEMPERATURE, CMAKE)
    kernel.run('%%rospkg package.xml\n<!-- YOUR CODE HERE -->')
    outputs = kernel.run('build_messages()')

    assert 'package.xml: not written yet' in outputs.text
    assert not (tmp_path / 'ros_ws' / 'build').exists()

"""Test the launcher's fix for rclpy: an event that another thread has just destroyed."""

from pathlib import Path
import subprocess
import sys

import pytest

from autograder.sandboxes.sandbox import HERE

pytestmark = [pytest.mark.ros]

PATCHES = Path(HERE, 'inside', 'rclpy_patches.py')
# Handle a list of waitables as an executor does, while another thread destroys one of them.
PROGRAM = """
import rclpy
from rclpy.impl.implementation_singleton import rclpy_implementation as impl
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('shaky')
publisher = node.create_publisher(String, 'topic', 10)
event = publisher.event_handlers[0]
event._ready_to_take_data = True
event.destroy()
wait_set = impl.WaitSet(0, 0, 0, 0, 0, 1, node.context.handle)
wait_set.clear_entities()
try:
    event.add_to_wait_set(wait_set)
    print('left out', event.is_ready(wait_set), event.take_data())
except impl.InvalidHandle:
    print('died')
node.destroy_node()
rclpy.shutdown()
"""


def said(*command: str) -> str:
    ran = subprocess.run(
        [sys.executable, *command], capture_output=True, text=True, check=True, timeout=60
    )
    return ran.stdout.strip()


@pytest.fixture
def program(tmp_path: Path) -> str:
    file = tmp_path / 'shaky.py'
    file.write_text(PROGRAM)
    return str(file)


def test_plain_rclpy_dies_of_it(program: str):
    """Once this test fails, rclpy has been fixed and the launcher's fix can be removed."""
    assert said(program) == 'died'


def test_the_launcher_leaves_a_destroyed_event_out(program: str):
    """The same happens in rclpy with subscriptions, timers, services and clients."""
    assert said(str(PATCHES), program) == 'left out False None'


def test_nothing_is_imported_for_the_program(tmp_path: Path):
    """The launcher must not hide a missing import in the program."""
    file = tmp_path / 'script.py'
    file.write_text('import sys\nprint(sorted(m for m in sys.modules if "rclpy" in m), __name__)')

    assert said(str(PATCHES), str(file)) == '[] __main__'


MANY = """
import rclpy
from rclpy.executors import SingleThreadedExecutor

rclpy.init()
executor = SingleThreadedExecutor()
for number in (*range(4, 12), *range(4)):
    executor.add_node(rclpy.create_node(f'node_{number}'))
print(*(node.get_name()[5:] for node in executor.get_nodes()))
rclpy.shutdown()
"""


def test_nodes_are_served_in_the_order_in_which_they_were_added(tmp_path: Path):
    """If two timers are due at the same time, the timer of the first node runs first."""
    file = tmp_path / 'many.py'
    file.write_text(MANY)

    assert said(str(PATCHES), str(file)) == '4 5 6 7 8 9 10 11 0 1 2 3'

"""
Provide the notebook that stock nbgrader grades, as one script.

``# %% NAME [POINTS]`` begins a cell; a cell with points is a grade cell that consists of a hidden
test.  The notebook is what an instructor with good knowledge of ROS 2 and nbgrader would write:
the student's main() runs in a thread of the kernel, and the tests listen in real time.  Checks and
points are those of the course's own exam, exams/visible/temperature_publisher.py.
"""

# Code in notebooks for learners has no annotations.
# ruff: noqa: ANN001, ANN201
# mypy: ignore-errors

# %% setup
import itertools
import math
import threading
import time

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from temp_monitor_pkg.msg import Temperature

WINDOW_S = 60


# %% temperature_publisher
### BEGIN SOLUTION
def main(args=None):
    """Mark the place where the benchmark inserts a submission."""
    raise NotImplementedError


### END SOLUTION


# %% starts_its_node 2
def run_student():
    """Run main(); its exceptions must not reach stderr, because nbgrader would give 0 points."""
    try:
        main()
    except BaseException as error:
        raised.append(error)


raised, readings, endpoints, names = [], [], [], set()
ours = Context()
rclpy.init(args=[], context=ours)
listener = Node('listener', context=ours, use_global_arguments=False)
any_writer = QoSProfile(
    depth=100,
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.VOLATILE,
)
listener.create_subscription(
    Temperature, 'temperature_topic', lambda m: readings.append((time.time(), m)), any_writer
)
executor = SingleThreadedExecutor(context=ours)
executor.add_node(listener)

student = threading.Thread(target=run_student, daemon=True)
student.start()


def see():
    """Run at most one callback within 0.2 s, then read the graph."""
    executor.spin_once(timeout_sec=0.2)
    names.update(set(listener.get_node_names()) - {'listener'})
    endpoints[:] = listener.get_publishers_info_by_topic('/temperature_topic') or endpoints


give_up = time.monotonic() + 10
while not names and student.is_alive() and time.monotonic() < give_up:
    see()
# Add half a second, so that the window includes the last expected tick but no further one.
end = time.monotonic() + WINDOW_S + 0.5
while names and student.is_alive() and time.monotonic() < end:
    see()
if rclpy.ok():
    rclpy.shutdown()
student.join(timeout=5)
executor.shutdown()
rclpy.shutdown(context=ours)

assert 'temperature_publisher' in names, f'nodes: {names}'

# %% publishes_readings 2
assert any(end.topic_type == 'temp_monitor_pkg/msg/Temperature' for end in endpoints)
assert readings, f'no message; raised: {raised}'

# %% publishes_once_per_second 3
assert abs(len(readings) - WINDOW_S) <= 1, f'{len(readings)} messages in {WINDOW_S} s'
gaps = [later[0] - earlier[0] for earlier, later in itertools.pairwise(readings)]
assert all(0.5 < gap < 1.5 for gap in gaps), f'gaps from {min(gaps)} to {max(gaps)} s'

# %% names_the_unit 1
assert readings
assert all(message.unit == 'Celsius' for _, message in readings)

# %% names_the_sensor 1
assert readings
assert all(message.sensor_id == 'temp_sensor_01' for _, message in readings)

# %% stamps_follow_the_clock 3
assert readings
for received, message in readings:
    stamp = message.timestamp.sec + message.timestamp.nanosec / 1e9
    assert -0.01 <= received - stamp <= 0.5, f'stamp {stamp}, received at {received}'

# %% readings_are_plausible 2
assert readings
values = [message.temperature_value for _, message in readings]
assert all(math.isfinite(value) and -40 <= value <= 125 for value in values)
assert len(set(values)) >= max(2, len(values) // 4)

# %% offers_reliable_qos 1
assert readings
for endpoint in endpoints:
    assert endpoint.qos_profile.reliability == ReliabilityPolicy.RELIABLE
    assert endpoint.qos_profile.durability == DurabilityPolicy.VOLATILE

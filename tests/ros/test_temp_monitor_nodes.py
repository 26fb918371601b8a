"""The course's two nodes as processes, driven from outside in simulated time."""

from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
import os
from pathlib import Path
import re
import subprocess
import threading
import time

from ament_index_python.packages import get_package_prefix
import pytest
from rcl_interfaces.msg import Log
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import LoggingSeverity
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock

from roslab.ros2.service_calls import meet
import temp_monitor_pkg
from temp_monitor_pkg.msg import Temperature
from tests.own_domain import own_domain

pytestmark = pytest.mark.ros

SOURCE = Path(__file__).parents[2] / 'temp_monitor_pkg' / 'temp_monitor_pkg'
DEADLINE_S = 60.0
GUARD_S = 270.0


class Operator:
    """A user with a second terminal, who starts programs, advances /clock and reads parameters."""

    def __init__(self, domain_id: int) -> None:
        self._environment = {**os.environ, 'ROS_DOMAIN_ID': str(domain_id)}
        self._processes: list[subprocess.Popen] = []
        # The only guard against a program that hangs; it ends a wait for output.
        self._guard = threading.Timer(GUARD_S, self._kill)
        self._guard.start()
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, domain_id=domain_id)
        self._node = rclpy.create_node('operator', context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._clock = self._node.create_publisher(Clock, '/clock', 10)
        self._now_ns = 0
        self._clients: dict[str, AsyncParameterClient] = {}
        self.readings: list[Temperature] = []
        self.logs: list[Log] = []
        self._node.create_subscription(
            Temperature, 'temperature_topic', self.readings.append, 1000
        )
        latched = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._node.create_subscription(Log, '/rosout', self.logs.append, latched)

    def run(self, executable: str, node: str, *arguments: str) -> subprocess.Popen:
        """Start a program and wait until its node answers."""
        prefix = Path(get_package_prefix('temp_monitor_pkg'))
        process = subprocess.Popen(
            [prefix / 'lib' / 'temp_monitor_pkg' / executable, '--ros-args', *arguments],
            env=self._environment,
            stdout=subprocess.DEVNULL,
        )
        self._processes.append(process)
        self._clients[node] = AsyncParameterClient(self._node, node)
        self.wait_for(self._clients[node].services_are_ready, f'{node} offers its services')
        # A response to a client that the node has not discovered yet would be lost.
        assert meet(self._node, f'/{node}/get_parameters', DEADLINE_S, self._waits)
        self.settle(node)
        return process

    def wait_for(self, condition, what: str) -> None:
        """Spin until the condition holds."""
        assert self._waits(condition, DEADLINE_S), f'not within {DEADLINE_S} s: {what}'

    def _waits(self, condition, seconds: float) -> bool:
        end = time.monotonic() + seconds
        while not (holds := condition()) and time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.1)
        return holds

    def answer_of(self, future, what: str):
        """Return the response of a service."""
        self.wait_for(future.done, f'an answer: {what}')
        return future.result()

    def settle(self, node: str) -> None:
        """Wait for two round trips through a node's executor: it has handled earlier messages."""
        for _ in range(2):
            self.answer_of(self._clients[node].get_parameters(['use_sim_time']), 'a round trip')

    def set(self, node: str, name: str, value):
        """Set one parameter through the node's service."""
        future = self._clients[node].set_parameters([Parameter(name, value=value)])
        return self.answer_of(future, f'set {name}').results[0]

    def describe(self, node: str, name: str):
        """Return a parameter's descriptor through the node's service."""
        future = self._clients[node].describe_parameters([name])
        return self.answer_of(future, f'describe {name}').descriptors[0]

    def advance(self, seconds: float, step_s: float = 0.25) -> None:
        """Advance /clock in small steps, and let every node do its work at each step."""
        for _ in range(round(seconds / step_s)):
            self._now_ns += round(step_s * 1e9)
            message = Clock()
            message.clock.sec, message.clock.nanosec = divmod(self._now_ns, 10**9)
            self._clock.publish(message)
            for node in self._clients:
                self.settle(node)

    @property
    def now_s(self) -> float:
        """Return the simulated time [s]."""
        return self._now_ns / 1e9

    def numbers(self, node: str, level: int) -> list[str]:
        """Return the first temperature in each line that a node has logged at a level."""
        lines = [log.msg for log in self.logs if (log.name, log.level) == (node, level)]
        return [re.search(r'-?\d+\.\d\d', line)[0] for line in lines]

    def close(self) -> None:
        """End the programs and this node."""
        self._guard.cancel()
        for process in self._processes:
            process.terminate()
        codes = [process.wait(timeout=DEADLINE_S) for process in self._processes]
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()
        assert codes == [0] * len(codes), 'every program ends with 0 on SIGTERM'

    def _kill(self) -> None:
        for process in self._processes:
            process.kill()


@pytest.fixture
def operator() -> Iterator[Operator]:
    """Create an operator in a domain that no other program uses."""
    with ExitStack() as until:
        person = Operator(own_domain(until))
        yield person
        person.close()


def test_built_package_is_the_source():
    """The package that tests and lessons import was built from the files in this project."""
    installed = Path(temp_monitor_pkg.__file__).parent
    stale = [
        path.name
        for path in SOURCE.glob('*.py')
        if (installed / path.name).read_bytes() != path.read_bytes()
    ]

    assert not stale, f'{stale}: changed since the build; run `make test` to build it again'


def test_one_heating_cycle_warns_for_each_hot_reading_and_no_other(operator):
    """The chapter's exercise in 90 simulated seconds: the two programs agree on every reading."""
    simulated = ('-p', 'use_sim_time:=true')
    operator.run('temp_subscriber', 'temperature_subscriber', *simulated)
    operator.run('temp_publisher', 'temperature_publisher', *simulated, '-p', 'seed:=7')
    infos = partial(operator.numbers, 'temperature_subscriber', LoggingSeverity.INFO)

    def heard() -> bool:
        operator.advance(1)
        return bool(operator.readings and infos())

    # Messages published before discovery is complete are lost, so ignore that time.
    operator.wait_for(heard, 'a first reading that both have heard')
    operator.advance(90)
    last = int(operator.now_s)
    operator.wait_for(lambda: operator.readings[-1].timestamp.sec == last, 'the last reading')
    values = [reading.temperature_value for reading in operator.readings][-90:]
    hot = [f'{value:.2f}' for value in values if value > 30.0]

    wanted = [f'{value:.2f}' for value in values]
    operator.wait_for(lambda: infos()[-1] == wanted[-1], 'the last line of the subscriber')
    stamps = [reading.timestamp for reading in operator.readings][-90:]
    assert [stamp.sec for stamp in stamps] == list(range(last - 89, last + 1))
    assert {stamp.nanosec for stamp in stamps} == {0}
    assert infos()[-90:] == wanted
    assert 10 < len(hot) < 60
    warned = operator.numbers('temperature_subscriber', LoggingSeverity.WARN)
    assert warned[-len(hot) :] == hot


def test_parameters_through_services(operator):
    """The node describes, refuses and sets parameters over the services that `ros2 param` uses."""
    node = 'temperature_publisher'
    operator.run('temp_publisher', node, '-p', 'use_sim_time:=true')
    limits = operator.describe(node, 'rate_hz').floating_point_range[0]
    refused = operator.set(node, 'rate_hz', 1000.0)
    unknown = operator.set(node, 'unit', 'Kelvin')

    assert (limits.from_value, limits.to_value) == (0.1, 100.0)
    assert (refused.successful, 'Max: 100.0' in refused.reason) == (False, True)
    assert (unknown.successful, 'Celsius, Fahrenheit' in unknown.reason) == (False, True)

    operator.advance(2)
    assert operator.set(node, 'rate_hz', 5.0).successful
    assert operator.set(node, 'unit', 'Fahrenheit').successful
    operator.advance(2, step_s=0.05)
    operator.wait_for(lambda: len(operator.readings) >= 12, '2 slow and 10 fast readings')

    assert [reading.unit for reading in operator.readings] == ['Celsius'] * 2 + ['Fahrenheit'] * 10
    assert operator.readings[-1].timestamp.sec == 4


def test_time_stands_still_without_a_clock(operator):
    """With use_sim_time and no /clock nothing is published: the timer is on the node's clock."""
    node = 'temperature_publisher'
    operator.run('temp_publisher', node, '-p', 'use_sim_time:=true', '-p', 'rate_hz:=100.0')
    for _ in range(20):
        operator.settle(node)

    assert operator.readings == []

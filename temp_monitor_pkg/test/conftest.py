"""Provide an isolated ROS environment per test: context, domain, executor and probe node."""

from collections.abc import Callable, Iterator
import random
import time
from typing import Any

import domain_coordinator
import pytest
from rcl_interfaces.msg import Log
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile

try:
    from autograder.simulation.virtual_time import virtual_time
except ImportError:  # the package was copied to a ROS workspace without the course

    @pytest.fixture
    def virtual_time() -> None:
        """Skip the test, because there is no virtual clock."""
        pytest.skip('needs the virtual clock of the course')


DEADLINE_S = 10.0


class RosWorld:
    """A separate context with a probe node and a single executor for all nodes."""

    def __init__(self, domain_id: int) -> None:
        """
        Create the context and the probe.

        :param domain_id: a ROS domain that no other program on this machine uses
        """
        self.context = rclpy.Context()
        rclpy.init(args=[], context=self.context, domain_id=domain_id)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.probe = rclpy.create_node('probe', context=self.context)
        self.executor.add_node(self.probe)
        self.nodes = [self.probe]
        self.logs: list[Log] = []
        latched = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.probe.create_subscription(Log, '/rosout', self.logs.append, latched)

    def start(self, node_class: type, **parameters: Any) -> Any:
        """
        Create a node in this context.

        :param node_class: the node's class
        :param parameters: initial values of parameters
        :returns: the node
        """
        overrides = [rclpy.Parameter(name, value=value) for name, value in parameters.items()]
        return self.adopt(node_class(context=self.context, parameter_overrides=overrides))

    def adopt(self, node: Any) -> Any:
        """
        Spin a node of this context, and destroy the node in :meth:`close`.

        :param node: a node of this world's context
        :returns: the node
        """
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def listen(self, topic: str, message_type: type) -> list:
        """
        Collect the messages of a topic.

        :param topic: the topic's name
        :param message_type: the topic's type
        :returns: a list that grows while the executor spins
        """
        messages: list = []
        self.probe.create_subscription(message_type, topic, messages.append, 100)
        return messages

    def spin_until(self, condition: Callable[[], bool], what: str) -> None:
        """
        Spin until a condition holds.

        :param condition: what to wait for
        :param what: description of the condition, for the error message
        """
        end = time.monotonic() + DEADLINE_S
        while not condition():
            assert time.monotonic() < end, f'not within {DEADLINE_S} s: {what}'
            self.executor.spin_once(timeout_sec=0.1)

    def close(self) -> None:
        """Destroy the nodes and the context."""
        self.executor.shutdown()
        for node in self.nodes:
            node.destroy_node()
        self.context.try_shutdown()


@pytest.fixture
def domain_id() -> Iterator[int]:
    """
    Reserve a ROS domain for one test.

    :returns: a domain that no other test on this machine uses at the same time
    """
    # Choose at random: programs that do not use the coordinator tend to use low ids.
    with domain_coordinator.domain_id(lambda: random.randint(1, 100)) as number:
        yield number


@pytest.fixture
def world(domain_id: int) -> Iterator[RosWorld]:
    """
    Create an isolated ROS environment for one test.

    :param domain_id: domain of the environment
    :returns: the environment
    """
    ros_world = RosWorld(domain_id)
    yield ros_world
    ros_world.close()

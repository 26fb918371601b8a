"""A private ROS world for each test: own context, own domain, one executor, a listening node."""

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
except ImportError:  # a ROS workspace without the course that this package belongs to

    @pytest.fixture
    def virtual_time() -> None:
        """Skip the test."""
        pytest.skip('needs the virtual clock of the course')


DEADLINE_S = 10.0


class RosWorld:
    """A context of its own with a probe node and the one executor that spins everything."""

    def __init__(self, domain_id: int) -> None:
        """
        Create the context and the probe.

        :param domain_id: domain that nothing else on this machine uses
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
        Create a node in this world.

        :param node_class: the node's class
        :param parameters: values as a user would give them at the start
        :returns: the node
        """
        overrides = [rclpy.Parameter(name, value=value) for name, value in parameters.items()]
        return self.adopt(node_class(context=self.context, parameter_overrides=overrides))

    def adopt(self, node: Any) -> Any:
        """
        Spin a node with this world and destroy it at its end.

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
        :returns: a list that grows while the world spins
        """
        messages: list = []
        self.probe.create_subscription(message_type, topic, messages.append, 100)
        return messages

    def spin_until(self, condition: Callable[[], bool], what: str) -> None:
        """
        Spin until a condition holds.

        :param condition: what to wait for
        :param what: the same in words, for the failure
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
    Reserve a domain for one test.

    :returns: an id that no other test of this machine has at the same time
    """
    # By chance and not counted from 1: those who do not ask the coordinator tend to use low ids.
    with domain_coordinator.domain_id(lambda: random.randint(1, 100)) as number:
        yield number


@pytest.fixture
def world(domain_id: int) -> Iterator[RosWorld]:
    """
    Make a private ROS world for one test.

    :param domain_id: domain of that world
    :returns: the world
    """
    ros_world = RosWorld(domain_id)
    yield ros_world
    ros_world.close()

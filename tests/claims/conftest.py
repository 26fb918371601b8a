"""
Provide the tests of claims with real nodes in an isolated ROS world.

``world`` is a private context on a domain that no other test process uses; nodes created with it
are destroyed at the end.  ``world.spin_until`` is the only way to wait; it has a time limit.
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
import time

import pytest
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from tests.own_domain import own_domain

_until = ExitStack()  # closed when this process ends
DOMAIN = own_domain(_until)


class World:
    def __init__(self) -> None:
        self.context = Context()
        self.context.init(args=[], domain_id=DOMAIN)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.nodes: list[Node] = []

    def node(self, name: str = 'subject') -> Node:
        """Create a node that the executor serves."""
        node = Node(name, context=self.context)
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def spin_until(self, condition: Callable[[], object], what: str) -> None:
        """Run callbacks until a condition holds; fail after a minute."""
        deadline = time.monotonic() + 60.0
        while not condition():
            assert time.monotonic() < deadline, f'waited a minute for {what}'
            self.executor.spin_once(timeout_sec=0.02)

    def close(self) -> None:
        self.executor.shutdown()
        for node in self.nodes:
            node.destroy_node()
        self.context.try_shutdown()


@pytest.fixture
def world() -> Iterator[World]:
    made = World()
    yield made
    made.close()

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
DOMAIN, ANOTHER_DOMAIN = own_domain(_until), own_domain(_until)


class World:
    another_domain = ANOTHER_DOMAIN

    def __init__(self, domain: int = DOMAIN) -> None:
        self.context = Context()
        self.context.init(args=[], domain_id=domain)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.nodes: list[Node] = []

    def node(self, name: str = 'subject', cls: type[Node] = Node, **options: object) -> Node:
        """Create a node that the executor serves."""
        node = cls(name, context=self.context, **options)
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def spin_until(
        self, condition: Callable[[], object], timeout: float = 60.0, what: str = 'a condition'
    ) -> None:
        """Run callbacks until a condition holds; fail after a timeout."""
        deadline = time.monotonic() + timeout
        while not condition():
            assert time.monotonic() < deadline, f'waited {timeout:g} s for {what}'
            self.executor.spin_once(timeout_sec=0.02)

    def drain(self) -> None:
        """Run only the callbacks that are ready now."""
        for _ in range(200):
            self.executor.spin_once(timeout_sec=0)

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


@pytest.fixture
def other_world() -> Iterator[World]:
    """Return a second participant in the same domain, as another process would be."""
    made = World()
    yield made
    made.close()

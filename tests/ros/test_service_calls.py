"""Call services of real nodes only after they have discovered the client."""

from collections.abc import Iterator
from contextlib import ExitStack, suppress
import time

import pytest
from rcl_interfaces.srv import GetParameters
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node, NodeNameNonExistentError

from roslab.ros2.service_calls import wait_for_discovery
from tests.own_domain import own_domain

pytestmark = [pytest.mark.ros]
SERVICE = '/asked/reset'


@pytest.fixture
def executors() -> Iterator[list[SingleThreadedExecutor]]:
    """Provide executors of two participants, which are like two processes."""
    with ExitStack() as until:
        domain, made = own_domain(until), []
        for _ in range(2):
            context = Context()
            context.init(args=[], domain_id=domain)
            until.callback(context.try_shutdown)
            made.append(SingleThreadedExecutor(context=context))
            until.callback(made[-1].shutdown)
        yield made


def a_node(executor: SingleThreadedExecutor, name: str, **options: bool) -> Node:
    """Create a node that the executor serves."""
    node = Node(name, context=executor.context, **options)
    executor.add_node(node)
    return node


def wait_until_known(node: Node, executor: SingleThreadedExecutor) -> None:
    """Wait until the node has discovered the service."""
    end = time.monotonic() + 60.0
    while True:
        with suppress(NodeNameNonExistentError):
            if SERVICE in dict(node.get_service_names_and_types_by_node('asked', '/')):
                return
        assert time.monotonic() < end
        executor.spin_once(timeout_sec=0.01)


def test_a_lost_answer_is_asked_for_again(executors):
    """Each attempt sends another request until the first response arrives."""
    asking, asked = executors
    node, server = a_node(asking, 'asking'), a_node(asked, 'asked')
    server.create_service(GetParameters, SERVICE, lambda _, answer: answer)
    (parameters,) = [
        each for each in server.services if each.service_name == '/asked/get_parameters'
    ]
    wait_until_known(node, asking)
    lost = []

    def wait(condition, seconds):
        for _ in range(1000):
            if condition():
                return True
            asking.spin_once(timeout_sec=0.01)
            if len(lost) < 2:  # take the request without sending a response
                header = parameters.handle.service_take_request(parameters.srv_type.Request)[1]
                if header is not None:
                    lost.append(header)
                    return False
            else:
                asked.spin_once(timeout_sec=0.01)
        return False

    assert wait_for_discovery(node, SERVICE, 60.0, wait)
    assert len(lost) == 2


def test_who_answers_nothing_is_not_met(executors):
    """The node that offers the service is not being spun."""
    asking, asked = executors
    node, server = a_node(asking, 'asking'), a_node(asked, 'asked')
    server.create_service(GetParameters, SERVICE, lambda _, answer: answer)
    wait_until_known(node, asking)

    def wait(condition, seconds):
        asking.spin_once(timeout_sec=0.01)
        return condition()

    assert not wait_for_discovery(node, SERVICE, 5.0, wait)
    assert not list(node.clients)

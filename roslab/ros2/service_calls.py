"""
Call a service once, from a process that has just started.

The two sides discover each other independently.  A client that has discovered the server may send
a request before the server has discovered the client.  Then the response is lost: rmw_fastrtps
waits 0.1 s for the client and drops the response ("client will not receive response").  To prevent
this, another client, created last, first calls a harmless service of the same node until it gets
a response.  Announcements arrive in order, so this response shows that the server's node has
discovered all earlier clients.
"""

from collections.abc import Callable
from typing import Any

from rcl_interfaces.srv import GetParameters
from rclpy.node import Node, NodeNameNonExistentError
from type_description_interfaces.srv import GetTypeDescription

from roslab.ros2.discovery import wait_for
from roslab.ros2.graph import full_name

ANSWER_S = 5.0
AGAIN_S = 1.0
HARMLESS = ((GetParameters, 'get_parameters'), (GetTypeDescription, 'get_type_description'))
"""Services that every node normally offers by default; a node may lack either or both."""

Wait = Callable[[Callable[[], Any], float], Any]


class NoAnswer(RuntimeError):
    """Raised when a service is missing or does not respond."""


def call(node: Node, kind: Any, name: str, limit_s: float = ANSWER_S, **request: Any) -> Any:
    """
    Call a service and return its response.

    :param limit_s: how long to wait for the service to appear, and then for its response [s]
    :raises NoAnswer: if the service is missing or does not respond
    """
    client = node.create_client(kind, name)
    try:
        if not wait_for(node, client.service_is_ready, limit_s):
            raise NoAnswer(f'Wait for service timed out: {name} is not available')
        if wait_for_discovery(node, name, limit_s):
            future = client.call_async(kind.Request(**request))
            if wait_for(node, future.done, limit_s):
                return future.result()
        raise NoAnswer(f'{name} did not answer within {limit_s:.0f} s: is its node being spun?')
    finally:
        node.destroy_client(client)


def wait_for_discovery(node: Node, service: str, limit_s: float, wait: Wait | None = None) -> bool:
    """
    Wait until the node that offers a service has discovered all current clients of our node.

    :param service: full name of the service, which our node must have discovered already
    :param limit_s: how long to wait [s]
    :param wait: given a condition and seconds, spins our node until the condition holds, and
        returns whether it does
    :returns: False if that node does not respond; True if it has no harmless service to call
    """
    wait = wait or (lambda condition, seconds: wait_for(node, condition, seconds))
    question = _harmless(node, service)
    if question is None:
        return True
    kind, name = question
    client = node.create_client(kind, name)
    try:
        answers: list[Any] = []
        for _ in range(max(1, round(limit_s / AGAIN_S))):
            if wait(client.service_is_ready, AGAIN_S):
                answers.append(client.call_async(kind.Request()))
                if wait(lambda: any(answer.done() for answer in answers), AGAIN_S):
                    return True
        return False
    finally:
        node.destroy_client(client)


def _harmless(node: Node, service: str) -> tuple[Any, str] | None:
    """Return a harmless service of the node that offers the given service."""
    for base, namespace in node.get_node_names_and_namespaces():
        try:
            known = node.get_service_names_and_types_by_node(base, namespace)
        except NodeNameNonExistentError:  # the node has disappeared
            continue
        names = {name for name, _ in known}
        if service in names:
            own = full_name(base, namespace)
            for kind, name in HARMLESS:
                if f'{own}/{name}' in names:
                    return kind, f'{own}/{name}'
    return None

"""
Call a service once, from a process that has just started.

Both sides discover each other on their own.  A client that knows the server may call before the
server knows the client, and then the answer is lost: rmw_fastrtps waits a tenth of a second
for the client and drops it ("client will not receive response").  So a client that was created
last first calls a harmless service of the same node until it answers.  Announcements arrive in
order, so this answer shows that the node knows the earlier clients.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rcl_interfaces.srv import GetParameters
from rclpy.node import Node, NodeNameNonExistentError
from type_description_interfaces.srv import GetTypeDescription

from roslab.ros2.discovery import full_name, wait_for

ANSWER_S = 5.0
AGAIN_S = 1.0
HARMLESS = ((GetParameters, 'get_parameters'), (GetTypeDescription, 'get_type_description'))
"""What nodes answer by themselves; most have both, and a node may be without either."""

Wait = Callable[[Callable[[], Any], float], Any]


def call(node: Node, kind: type, name: str, request: Any, limit_s: float = ANSWER_S) -> Any:
    """
    Call a service and return its answer.

    :param kind: class of the service
    :param name: full name of the service
    :param limit_s: how long to wait for the service to appear, and then for its answer [s]
    :raises RuntimeError: if the service is missing or does not answer
    """
    client = node.create_client(kind, name)
    try:
        if not wait_for(node, client.service_is_ready, limit_s):
            raise RuntimeError(f'Wait for service timed out: {name} is not there')
        if meet(node, name, limit_s):
            future = client.call_async(request)
            if wait_for(node, future.done, limit_s):
                return future.result()
        raise RuntimeError(f'{name} did not answer within {limit_s:.0f} s: is its node spun?')
    finally:
        node.destroy_client(client)


def meet(node: Node, service: str, limit_s: float, wait: Wait | None = None) -> bool:
    """
    Wait until the node that offers a service knows all current clients of our node.

    :param service: its full name; our node must know it already
    :param limit_s: how long to wait [s]
    :param wait: given a condition and seconds, spins our node until the condition holds, and
        returns whether it does
    :returns: False if that node does not answer; True also if it has no harmless service
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
    """Return a harmless service of the node that offers the given one."""
    for base, namespace in node.get_node_names_and_namespaces():
        try:
            known = node.get_service_names_and_types_by_node(base, namespace)
        except NodeNameNonExistentError:  # gone meanwhile
            continue
        names = {name for name, _ in known}
        if service in names:
            own = full_name(base, namespace)
            for kind, name in HARMLESS:
                if f'{own}/{name}' in names:
                    return kind, f'{own}/{name}'
    return None

"""Calling the services that nodes have by themselves: parameters and lifecycle."""

from __future__ import annotations

from typing import Any

from rclpy.node import Node

from roslab.ros2.discovery import wait_for

ANSWER_S = 5.0


def call(node: Node, kind: type, name: str, request: Any, limit_s: float = ANSWER_S) -> Any:
    """
    Call a service and return its answer.

    :param kind: class of the service
    :param name: full name of the service
    :param limit_s: how long to wait for it to be there, and then for its answer [s]
    :raises RuntimeError: if it is not there or does not answer
    """
    client = node.create_client(kind, name)
    try:
        if not wait_for(node, client.service_is_ready, limit_s):
            raise RuntimeError(f'Wait for service timed out: {name} is not there')
        future = client.call_async(request)
        if not wait_for(node, future.done, limit_s):
            raise RuntimeError(f'{name} did not answer within {limit_s:.0f} s: is its node spun?')
        return future.result()
    finally:
        node.destroy_client(client)


def has_service(node: Node, name: str) -> bool:
    """Tell whether a service is in the graph."""
    return any(known == name for known, _ in node.get_service_names_and_types())

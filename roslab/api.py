"""The short functions of a lesson, on the session of the running kernel."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from rclpy.node import Node
from rclpy.qos import QoSProfile

from roslab.listening import Listener
from roslab.logtable import log_table, LogTable
from roslab.session import session
from roslab.waiting import wait_until_in

T = TypeVar('T')


def start(
    factory: Callable[..., Any] | Node,
    *,
    name: str | None = None,
    parameters: Mapping[str, Any] | None = None,
) -> Node:
    """
    Make a node and run it in the background, in place of an older one of the same name.

    :param factory: a subclass of Node, a function that returns a node, or a node
    :param name: replaces the node's own name, as ``-r __node:=name`` does in a terminal
    :param parameters: initial values of declared parameters, as ``-p name:=value`` does
    """
    return session().start(factory, name, parameters)


def stop(node: Node | str) -> None:
    """
    Stop and destroy a node.

    :param node: the node, or its name
    """
    session().stop(node)


def stop_all() -> None:
    """Stop and destroy all nodes that were started here."""
    session().stop_all()


def nodes() -> dict[str, Node]:
    """Return the nodes that run here, by name."""
    return session().nodes()


def listen(
    topic: str, msg_type: type, *, depth: int = 10, qos: QoSProfile | None = None
) -> Listener:
    """
    Listen to a topic; what is heard is kept in ``messages``.

    :param topic: name of the topic
    :param msg_type: class of its messages
    :param depth: messages that are kept until the next callback
    :param qos: the whole profile, instead of a reliable one of that depth
    """
    return Listener(session(), topic, msg_type, qos or QoSProfile(depth=depth))


def wait_until(condition: Callable[[], T], timeout: float = 5.0, what: str = 'a condition') -> T:
    """
    Wait until something is true, while nodes go on.

    :param condition: called after each callback, until it returns something true
    :param timeout: the longest time to wait [s]
    :param what: the condition in words, for the message after a timeout
    :returns: what the condition returned
    :raises TimeoutError: with what may explain it
    """
    return wait_until_in(session(), condition, timeout, what)


def logs(node: Node | str | None = None) -> LogTable:
    """
    Return what was logged here so far, as a table.

    :param node: only this node, or the node of this name
    """
    if node is None:
        return log_table()
    name = node if isinstance(node, str) else node.get_fully_qualified_name()
    return log_table(name.strip('/').replace('/', '.'))

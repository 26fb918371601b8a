"""
Look up names in the live ROS graph: a topic, its type, the class of its messages.

Nodes of this kernel are visible at once, nodes of other processes only after discovery.  So the
functions look for a missing name for some seconds before they call it unknown.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
import importlib
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from roslab.errors import NotHereError, RoslabError
from roslab.session import Session
from roslab.waiting import wait_in

DISCOVERY_S = 3.0
"""Maximum time to discover a topic or a node of another process [s]."""

_QUIET = ('/parameter_events', '/rosout')


def is_hidden(name: str) -> bool:
    """
    Return whether ROS tools hide a name because one of its parts begins with an underscore.

    :param name: full name of a topic or a node
    """
    return any(part.startswith('_') for part in name.split('/'))


def topics_now(node: Node) -> dict[str, list[str]]:
    """
    Return the types of all non-hidden topics that a node has discovered.

    :param node: any node; it sees what its process has discovered
    """
    return {
        name: list(types)
        for name, types in sorted(node.get_topic_names_and_types())
        if not is_hidden(name)
    }


def nodes_now(node: Node, hidden: bool = False) -> list[str]:
    """
    Return the full names of all nodes in the current graph; a name may occur twice.

    :param node: any node
    :param hidden: include nodes whose names begin with an underscore
    """
    full = (
        f'{namespace.rstrip("/")}/{name}'
        for name, namespace in node.get_node_names_and_namespaces()
    )
    return sorted(name for name in full if hidden or not is_hidden(name))


def resolved(node: Node, topic: str) -> str:
    """
    Return the full name of a topic.

    :param topic: with or without the leading slash
    :raises RoslabError: if the name is not a valid topic name
    """
    try:
        name: str = node.resolve_topic_name(topic)
    except Exception as error:  # rclpy and rcl raise unrelated exception classes for invalid names
        words = str(error).partition(', at ')[0].splitlines() or ['']
        why = words[0].removeprefix('failed to resolve name: ').rstrip(':')
        raise RoslabError(f'{topic!r} cannot be the name of a topic: {why}.') from None
    return name


def find_topic(session: Session, topic: str, patience_s: float = DISCOVERY_S) -> tuple[str, str]:
    """
    Return the full name of a topic and its type.

    :param topic: with or without the leading slash
    :param patience_s: how long to wait for it to be discovered [s]
    :raises NotHereError: if the topic has no endpoint
    :raises RoslabError: if the endpoints have different types
    """
    node = session.helper
    name = resolved(node, topic)
    types = wait_in(session, lambda: topics_now(node).get(name), patience_s)
    if not types:
        raise not_here('topic', name, topics_now(node))
    if len(types) > 1:
        raise RoslabError(
            f'{name} has {len(types)} types, {" and ".join(types)}: a node uses the wrong one. '
            f'info({name!r}) shows which.'
        )
    return name, types[0]


def not_here(kind: str, name: str, known: Iterable[str]) -> NotHereError:
    """
    Return the error for a topic or node name that does not exist.

    :param kind: 'topic', 'node', or a phrase that names both
    :param name: the name that was not found
    :param known: the names that exist
    """
    names = [known_name for known_name in known if known_name not in _QUIET]
    near = get_close_matches(name, names, n=1, cutoff=0.7)
    if near:
        return NotHereError(f'There is no {kind} {name} now. Did you mean {near[0]}?')
    others = ', '.join(sorted(set(names))) or 'none'
    return NotHereError(
        f'There is no {kind} {name} now. Known: {others}. '
        'A node that should have it may not be started yet.'
    )


def message_class(type_name: str) -> Any:
    """
    Return the class of a message type.

    :param type_name: such as ``std_msgs/msg/String``
    :raises NotHereError: if its package cannot be imported here
    """
    parts = type_name.split('/')
    try:
        return getattr(importlib.import_module('.'.join(parts[:-1])), parts[-1])
    except (ImportError, AttributeError, ValueError):
        raise NotHereError(
            f'The message type {type_name} is not known in this kernel. Build its package here '
            'with build_messages(), or restart the kernel after it was built elsewhere.'
        ) from None


def matching_qos(publishers: Sequence[Any], depth: int = 10) -> QoSProfile:
    """
    Return a QoS profile compatible with all publishers of a topic, as ``ros2 topic echo`` does.

    :param publishers: rclpy's ``TopicEndpointInfo``; if empty, the result is rclpy's default
        profile with this depth
    :param depth: how many messages can wait in the queue for the callback
    """
    offered = [info.qos_profile for info in publishers]
    reliable = all(qos.reliability == ReliabilityPolicy.RELIABLE for qos in offered)
    lasting = bool(offered) and all(
        qos.durability == DurabilityPolicy.TRANSIENT_LOCAL for qos in offered
    )
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if lasting else DurabilityPolicy.VOLATILE,
    )

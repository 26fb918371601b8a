"""
Look up names in the live ROS graph, and explain why a name or messages are missing.

Nodes of this kernel are visible at once, nodes of other processes only after discovery.  So the
functions look for a missing name for some seconds before they report it as unknown.
"""

from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any

from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility, QoSProfile

from roslab.errors import NotHereError, RoslabError
from roslab.ros2.graph import QUIET_TOPICS, topic_types, topics_of
from roslab.ros2.interface import interface_class
from roslab.session import session, wait_in

DISCOVERY_S = 3.0
"""Maximum time to discover a topic or a node of another process [s]."""


def resolved(node: Node, topic: str) -> str:
    """Return the full name of a topic; RoslabError if it is not a valid topic name."""
    try:
        name: str = node.resolve_topic_name(topic)
    except Exception as error:  # rclpy and rcl raise unrelated exception classes for invalid names
        words = str(error).partition(', at ')[0].splitlines() or ['']
        why = words[0].removeprefix('failed to resolve name: ').rstrip(':')
        raise RoslabError(f'{topic!r} cannot be the name of a topic: {why}.') from None
    return name


def find_topic(topic: str) -> tuple[str, str]:
    """
    Return the full name of a topic and its type.

    :raises NotHereError: if the topic has no endpoint
    :raises RoslabError: if the endpoints have different types
    """
    node = session().helper
    name = resolved(node, topic)
    types = wait_in(lambda: topic_types(node, name), DISCOVERY_S)
    if not types:
        raise not_here('topic', name, topics_of(node))
    if len(types) > 1:
        raise RoslabError(
            f'{name} has {len(types)} types, {" and ".join(types)}: a node uses the wrong one. '
            f'info({name!r}) shows which.'
        )
    return name, types[0]


def not_here(kind: str, name: str, known: Iterable[str]) -> NotHereError:
    """Return the error for a topic or node name that does not exist."""
    names = [known_name for known_name in known if known_name not in QUIET_TOPICS]
    near = get_close_matches(name, names, n=1, cutoff=0.7)
    if near:
        return NotHereError(f'There is no {kind} {name} now. Did you mean {near[0]}?')
    others = ', '.join(sorted(set(names))) or 'none'
    return NotHereError(
        f'There is no {kind} {name} now. Known: {others}. '
        'Perhaps its node has not been started yet.'
    )


def message_class(type_name: str) -> Any:
    """Return the class of a message type; NotHereError if its package cannot be imported here."""
    try:
        return interface_class(type_name)
    except LookupError:
        raise NotHereError(
            f'The message type {type_name} is not known in this kernel. Build its package here '
            'with build_messages(); if it was built elsewhere, restart the kernel.'
        ) from None


def type_name(msg_type: type) -> str:
    """Return the ROS name of a message class, such as ``std_msgs/msg/String``."""
    package, kind = msg_type.__module__.split('.')[:2]
    return f'{package}/{kind}/{msg_type.__name__}'


def why_silent(node: Node, topic: str, msg_type: type, qos: QoSProfile) -> str:
    """Return a sentence that explains why a subscription received too few messages."""
    publishers = node.get_publishers_info_by_topic(topic)
    if not publishers:
        return no_publisher(node, topic)
    for publisher in publishers:
        name = publisher.node_name
        if publisher.topic_type != type_name(msg_type):
            return (
                f'{name} publishes {publisher.topic_type} on {topic}, not {type_name(msg_type)}. '
                'A publisher and a subscription connect only if their types are the same.'
            )
        compatibility, reason = qos_check_compatible(publisher.qos_profile, qos)
        if compatibility == QoSCompatibility.ERROR:
            reason = reason.strip().removesuffix(';')
            return f'{name} publishes on {topic}, but the QoS does not match. {reason}'.strip()
    names = ' and '.join(sorted({publisher.node_name for publisher in publishers}))
    return f'The subscription is connected to {names}, but too few messages have arrived.'


def no_publisher(node: Node, topic: str) -> str:
    """Return a message that nobody publishes on a topic, with a similar name or all others."""
    known = [name for name, _ in node.get_topic_names_and_types() if name not in QUIET_TOPICS]
    published = [name for name in known if node.count_publishers(name)]
    near = get_close_matches(node.resolve_topic_name(topic), published, n=1, cutoff=0.75)
    if near:
        return f'Nobody publishes on {topic}; did you mean {near[0]}?'
    others = ', '.join(sorted(published)) or 'none'
    return f'Nobody publishes on {topic}. Topics with a publisher: {others}.'

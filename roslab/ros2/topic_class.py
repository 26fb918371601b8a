"""Find the message class of a topic, given the type's name or the graph."""

from __future__ import annotations

from typing import Any

import rclpy
from rclpy.exceptions import InvalidTopicNameException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from rclpy.validate_full_topic_name import validate_full_topic_name

from roslab.ros2.graph import topic_types
from roslab.ros2.interface_files import interface_class


def named_class(name: str) -> Any:
    """
    Return the message class with a given type name.

    :raises RuntimeError: if there is no such class
    """
    try:
        return interface_class(name)
    except LookupError:
        raise RuntimeError('The passed message type is invalid') from None


def class_of_topic(node: Node, topic: str, *, wait: bool = False) -> Any | None:
    """
    Return the message class of a topic; print a warning if the topic has no endpoint.

    :param wait: whether to wait until the topic is discovered
    :returns: None if the graph does not contain the topic
    :raises RuntimeError: see :func:`known_class`
    """
    found = known_class(node, topic)
    if found is None:
        print(f'WARNING: topic [{topic}] does not appear to be published yet', flush=True)
    while wait and found is None:
        rclpy.spin_once(node, timeout_sec=0.05)
        found = known_class(node, topic)
    return found


def known_class(node: Node, topic: str) -> Any | None:
    """
    Return the message class of a topic, None if the graph does not contain the topic.

    :raises RuntimeError: if the name is invalid, or the topic has several types
    """
    try:
        full = expand_topic_name(topic, node.get_name(), node.get_namespace())
        validate_full_topic_name(full)
    except (ValueError, InvalidTopicNameException) as problem:
        raise RuntimeError(str(problem)) from None
    types = topic_types(node, full)
    if len(types) > 1:
        raise RuntimeError(
            f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]"
        )
    return named_class(types[0]) if types else None

"""
Implement ``echo``, ``hz``, ``info`` and ``topics``: command line tools inside a notebook.

The functions use the notebook's own hidden node and its executor, so cells may call them while
nodes of the notebook run.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
import math
import time
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile

from roslab.cli_text import echo_text, hz_text, node_info_text, topic_info_text, topic_list_text
from roslab.errors import RoslabError
from roslab.listening import Listener
from roslab.lookup import (
    DISCOVERY_S,
    find_topic,
    is_hidden,
    matching_qos,
    message_class,
    nodes_now,
    not_here,
    topics_now,
)
from roslab.output import say
from roslab.session import Session
from roslab.waiting import wait_in

_ACTION = '/_action/'
_MOST_KEPT = 100


def listen_as_found(
    session: Session, topic: str, qos: QoSProfile | None = None, depth: int = _MOST_KEPT
) -> Listener:
    """
    Subscribe to a topic with the type of its publishers and, by default, their QoS.

    :param topic: with or without the leading slash
    :param qos: profile of the subscription; None for one that fits the publishers
    :param depth: queue depth of the profile if ``qos`` is None
    :raises NotHereError: if the topic has no endpoint, or its type cannot be imported
    """
    name, kind = find_topic(session, topic)
    profile = qos or matching_qos(session.helper.get_publishers_info_by_topic(name), depth)
    return Listener(session, name, message_class(kind), profile)


def print_messages(
    session: Session, topic: str, count: int, timeout: float, qos: QoSProfile | None
) -> None:
    """
    Print messages as they arrive, as ``ros2 topic echo`` does.

    :param count: how many messages to print
    :param timeout: how long to wait for all of them [s]
    :raises TimeoutError: if too few messages arrive; the message lists possible reasons
    """
    _require_count(count, 1)
    listener = listen_as_found(session, topic, qos)
    end = time.monotonic() + timeout
    try:
        for index in range(count):
            left = max(0.0, end - time.monotonic())
            if not wait_in(session, partial(_longer, listener, index), left):
                raise listener.too_little(count, timeout)
            say(echo_text(listener[index]))
    finally:
        listener.stop()


def print_rate(session: Session, topic: str, count: int, timeout: float) -> None:
    """
    Print the rate at which messages arrive, as ``ros2 topic hz`` does.

    :param count: messages to measure, at least two
    :param timeout: how long to wait for them [s]
    :raises TimeoutError: if too few messages arrive; the message lists possible reasons
    """
    _require_count(count, 2)
    listener = listen_as_found(session, topic)
    try:
        listener.wait(count, timeout)
        say(hz_text(listener.times[:count]))
    finally:
        listener.stop()


def print_info(session: Session, name: str) -> None:
    """
    Print the output of ``ros2 topic info -v`` or ``ros2 node info``.

    :param name: name of a topic or a node, with or without the leading slash
    :raises NotHereError: if there is no such topic or node
    """
    if not isinstance(name, str) or not name.strip():
        raise RoslabError(f"info() expected a name, as in info('/chatter'), got {name!r}.")
    node = session.helper
    full = name if name.startswith('/') else f'/{name}'
    texts = wait_in(session, lambda: _texts(node, full), DISCOVERY_S)
    if not texts:
        raise not_here('topic or node', full, [*topics_now(node), *nodes_now(node)])
    say('\n\n'.join(texts))


def print_topics(session: Session, types: bool) -> None:
    """
    Print the output of ``ros2 topic list``.

    :param types: print the type of each topic too, as ``-t`` does
    """
    say(topic_list_text(topics_now(session.helper).items(), types))


def _texts(node: Node, name: str) -> list[str]:
    """Return the ``info`` texts of the topic and of the node with this name."""
    texts = []
    types = topics_now(node).get(name)
    if types:
        publishers = _ordered(node.get_publishers_info_by_topic(name))
        subscriptions = _ordered(node.get_subscriptions_info_by_topic(name))
        texts.append(topic_info_text(types, publishers, subscriptions))
    same = nodes_now(node).count(name)
    if same:
        texts.append(node_info_text(name, node_entities(node, name)))
    if same > 1:
        texts.append(
            f'{same} nodes have the exact name {name!r}; this describes only one of them.'
        )
    return texts


def _longer(listener: Listener, length: int) -> bool:
    return len(listener) > length


def _ordered(infos: Sequence[Any]) -> list[Any]:
    """Return endpoints sorted by node name; as in the ROS tools, hidden nodes are included."""
    return sorted(infos, key=lambda info: (info.node_namespace, info.node_name))


def node_entities(node: Node, full_name: str) -> dict[str, list[tuple[str, list[str]]]]:
    """
    Return the entities of a node, by the sections of ``ros2 node info``.

    :param node: any node; it is only used to read the graph
    :param full_name: full name of the node to describe
    """
    space, _, name = full_name.rpartition('/')
    space = space or '/'
    subscribers = node.get_subscriber_names_and_types_by_node(name, space)
    publishers = node.get_publisher_names_and_types_by_node(name, space)
    servers = node.get_service_names_and_types_by_node(name, space)
    clients = node.get_client_names_and_types_by_node(name, space)
    return {
        'Subscribers': _visible(subscribers),
        'Publishers': _visible(publishers),
        'Service Servers': _visible(servers),
        'Service Clients': _visible(clients),
        # An action consists of services and topics with hidden names.
        'Action Servers': _actions(servers),
        'Action Clients': _actions(clients),
    }


def _visible(found: Sequence[tuple[str, list[str]]]) -> list[tuple[str, list[str]]]:
    return [(name, list(types)) for name, types in found if not is_hidden(name)]


def _actions(services: Sequence[tuple[str, list[str]]]) -> list[tuple[str, list[str]]]:
    return [
        (name.partition(_ACTION)[0], [kind.removesuffix('_SendGoal') for kind in types])
        for name, types in services
        if name.endswith(f'{_ACTION}send_goal')
    ]


def _require_count(count: int, least: int) -> None:
    if not isinstance(count, int) or isinstance(count, bool) or count < least:
        raise RoslabError(f'count: expected at least {least} messages, got {count!r}.')
    if not math.isfinite(count) or count > 10_000:
        raise RoslabError(f'count: expected at most 10000 messages, got {count}.')

"""
Implement ``echo``, ``hz``, ``info`` and ``topics``: command line tools inside a notebook.

The functions use the notebook's own hidden node and its executor, so cells may call them while
nodes of the notebook run.
"""

from functools import partial
import time

from rclpy.node import Node
from rclpy.qos import QoSProfile

from roslab.cli_text import echo_text, hz_text, node_info_text, topic_info_text, topic_list_text
from roslab.errors import RoslabError
from roslab.listening import Listener
from roslab.lookup import DISCOVERY_S, find_topic, message_class, not_here
from roslab.output import say
from roslab.ros2.graph import (
    entities_of,
    node_names,
    qos_for_publishers,
    topic_endpoints,
    topic_types,
    topics_of,
)
from roslab.session import session, wait_in

_MOST_KEPT = 100


def listen_with_found_type(topic: str, qos: QoSProfile | None = None) -> Listener:
    """
    Subscribe to a topic with the type of its publishers and, by default, their QoS.

    :param qos: profile of the subscription; None for one that is compatible with the publishers
    :raises NotHereError: if the topic has no endpoint, or its type cannot be imported
    """
    name, kind = find_topic(topic)
    node = session().helper
    if qos is None and node.count_publishers(name):
        qos = qos_for_publishers(node, name, _MOST_KEPT, lambda _: None)
    return Listener(name, message_class(kind), qos or QoSProfile(depth=_MOST_KEPT))


def echo(
    topic: str, count: int = 1, timeout: float = 5.0, *, qos: QoSProfile | None = None
) -> None:
    """
    Print messages as they arrive, as ``ros2 topic echo`` does.

    :param topic: name of a topic, whose type is looked up in the graph
    :param count: how many messages to print
    :param timeout: how long to wait for all of them [s]
    :param qos: profile of the subscription, instead of one that is compatible with all publishers
    :raises TimeoutError: if too few messages arrive; the message lists possible reasons
    """
    _require_count(count, 1)
    listener = listen_with_found_type(topic, qos)
    end = time.monotonic() + timeout
    try:
        for index in range(count):
            left = max(0.0, end - time.monotonic())
            if not wait_in(partial(_longer, listener, index), left):
                raise listener.missing_messages_error(count, timeout)
            say(echo_text(listener[index]))
    finally:
        listener.stop()


def hz(topic: str, count: int = 5, timeout: float = 10.0) -> None:
    """
    Print how often messages arrive, as ``ros2 topic hz`` does.

    :param topic: name of a topic, whose type is looked up in the graph
    :param count: how many messages to measure, at least two
    :param timeout: how long to wait for them [s]
    :raises TimeoutError: if too few messages arrive; the message lists possible reasons
    """
    _require_count(count, 2)
    listener = listen_with_found_type(topic)
    try:
        listener.wait(count, timeout)
        say(hz_text(listener.times[:count]))
    finally:
        listener.stop()


def info(name: str) -> None:
    """
    Print the output of ``ros2 topic info -v`` for a topic, or of ``ros2 node info`` for a node.

    :param name: name of a topic or a node, with or without the leading slash
    :raises NotHereError: if there is no such topic or node
    """
    if not isinstance(name, str) or not name.strip():
        raise RoslabError(f"info() expected a name, as in info('/chatter'), got {name!r}.")
    node = session().helper
    full = name if name.startswith('/') else f'/{name}'
    texts = wait_in(lambda: _texts(node, full), DISCOVERY_S)
    if not texts:
        raise not_here('topic or node', full, [*topics_of(node), *node_names(node, hidden=False)])
    say('\n\n'.join(texts))


def topics(types: bool = True) -> None:
    """Print all topics, with their types as ``ros2 topic list -t`` does, unless types is False."""
    say(topic_list_text(topics_of(session().helper).items(), types))


def _texts(node: Node, name: str) -> list[str]:
    """Return the ``info`` texts of the topic and of the node with this name."""
    texts = []
    if types := topic_types(node, name):
        texts.append(topic_info_text(types, *topic_endpoints(node, name)))
    same = node_names(node, hidden=True).count(name)
    if same:
        texts.append(node_info_text(name, entities_of(node, name)))
    if same > 1:
        texts.append(
            f'{same} nodes have the exact name {name!r}; this describes only one of them.'
        )
    return texts


def _longer(listener: Listener, length: int) -> bool:
    return len(listener) > length


def _require_count(count: int, least: int) -> None:
    if not isinstance(count, int) or isinstance(count, bool) or count < least:
        raise RoslabError(f'count: expected at least {least} messages, got {count!r}.')
    if count > 10_000:
        raise RoslabError(f'count: expected at most 10000 messages, got {count}.')

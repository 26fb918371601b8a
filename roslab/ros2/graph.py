"""Read names and types from the ROS graph through a node, for commands and for notebooks."""

from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from rclpy.exceptions import InvalidTopicNameException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSPresetProfiles, QoSProfile, ReliabilityPolicy
from rclpy.validate_full_topic_name import validate_full_topic_name

from roslab.ros2.interface import interface_class

UNKNOWN = '_NODE_NAME_UNKNOWN_'
"""Name of a node whose endpoint was discovered shortly before the node."""
QUIET_TOPICS = ('/parameter_events', '/rosout')
"""Every node has endpoints on these topics, so pictures and hints leave them out."""
_STRONG = {
    'reliability': (ReliabilityPolicy.RELIABLE, 'BEST_EFFORT'),
    'durability': (DurabilityPolicy.TRANSIENT_LOCAL, 'VOLATILE'),
}
_SEND_GOAL = '/_action/send_goal'

Named = list[tuple[str, list[str]]]
"""Names of topics, services or actions, with their types."""


def is_hidden(name: str) -> bool:
    """Return whether ROS tools hide a full name because a part of it begins with an underscore."""
    return '/_' in name


def full_name(name: str, namespace: str) -> str:
    """Return the full name of a node, such as /lab/talker."""
    return f'{namespace.rstrip("/")}/{name}'


def node_names(node: Node, *, hidden: bool) -> list[str]:
    """Return the full names of all nodes, sorted; a name that two nodes share is listed twice."""
    return sorted(
        full_name(name, namespace)
        for name, namespace in node.get_node_names_and_namespaces()
        if hidden or not name.startswith('_')
    )


def node_known(node: Node, name: str) -> bool:
    """Return whether the graph contains a node with this full name, hidden or not."""
    return name in node_names(node, hidden=True)


def topics_of(node: Node, *, hidden: bool = False) -> dict[str, list[str]]:
    """Return the types of the topics by name, sorted."""
    found = sorted(node.get_topic_names_and_types())
    return {name: list(types) for name, types in found if hidden or not is_hidden(name)}


def topic_types(node: Node, name: str) -> list[str]:
    """Return the types of a topic, empty if the graph does not contain its full name."""
    return topics_of(node, hidden=True).get(name, [])


def topic_endpoints(node: Node, name: str) -> tuple[list[Any], list[Any]]:
    """Return the publishers and the subscriptions of a topic, each sorted by node."""
    publishers, subscriptions = (
        sorted(infos, key=lambda info: (info.node_namespace, info.node_name))
        for infos in (
            node.get_publishers_info_by_topic(name),
            node.get_subscriptions_info_by_topic(name),
        )
    )
    return publishers, subscriptions


def service_types(node: Node, name: str) -> list[str]:
    """Return the types of a service, empty if the graph does not contain its full name."""
    return dict(node.get_service_names_and_types()).get(name, [])


def entities_of(node: Node, name: str, *, hidden: bool = False) -> dict[str, Named]:
    """Return the entities of a node, by section of ``ros2 node info``."""
    namespace, _, base = name.rpartition('/')
    who = (base, namespace or '/')
    servers = node.get_service_names_and_types_by_node(*who)
    clients = node.get_client_names_and_types_by_node(*who)
    found: dict[str, Named] = {
        'Subscribers': node.get_subscriber_names_and_types_by_node(*who),
        'Publishers': node.get_publisher_names_and_types_by_node(*who),
        'Service Servers': servers,
        'Service Clients': clients,
        'Action Servers': _actions(servers),
        'Action Clients': _actions(clients),
    }
    return {
        section: [one for one in entities if hidden or not is_hidden(one[0])]
        for section, entities in found.items()
    }


def _actions(services: Named) -> Named:
    """Return the actions to which services belong: an action consists of services and topics."""
    return [
        (name.removesuffix(_SEND_GOAL), [one.removesuffix('_SendGoal') for one in types])
        for name, types in services
        if name.endswith(_SEND_GOAL)
    ]


def preset(name: str) -> QoSProfile:
    """Return a copy of a preset profile, which the caller may change."""
    profile = QoSPresetProfiles.get_from_short_key(name)
    return QoSProfile(**{key[1:]: getattr(profile, key[1:]) for key in QoSProfile.__slots__})


def qos_for_publishers(
    node: Node, topic: str, depth: int = 5, say: Callable[[str], object] = print
) -> QoSProfile:
    """
    Return a QoS profile that is compatible with every existing publisher.

    It requests the stronger policy only if all publishers offer it.

    :param topic: full name
    :param depth: how many messages can wait in the queue for the callback
    :param say: called with a note for each policy that only some publishers offer
    """
    qos = preset('sensor_data')
    qos.depth = depth
    publishers: Sequence[QoSProfile] = [
        info.qos_profile for info in node.get_publishers_info_by_topic(topic)
    ]
    for name, (policy, weak) in _STRONG.items():
        offers = [getattr(profile, name) == policy for profile in publishers]
        if offers and all(offers):
            setattr(qos, name, policy)
        elif any(offers):
            kind = f'QoS{name.capitalize()}Policy'
            say(
                f'Some, but not all, publishers are offering {kind}.{policy.name}. Falling back '
                f'to {kind}.{weak} as it will connect to all publishers'
            )
    return qos


def named_class(name: str) -> Any:
    """Return the message class with a type name; RuntimeError if there is no such class."""
    try:
        return interface_class(name)
    except LookupError:
        raise RuntimeError('The passed message type is invalid') from None


def class_of_topic(node: Node, topic: str, *, wait: bool = False) -> Any | None:
    """
    Return the message class of a topic; print a warning if the topic has no endpoint.

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

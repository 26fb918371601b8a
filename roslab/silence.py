"""Use the ROS graph to explain why no messages arrive on a topic."""

from __future__ import annotations

from difflib import get_close_matches

from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility, QoSProfile

_OWN_TOPICS = ('/rosout', '/parameter_events')


def type_name(msg_type: type) -> str:
    """Return the ROS name of a message class, such as ``std_msgs/msg/String``."""
    package, kind = msg_type.__module__.split('.')[:2]
    return f'{package}/{kind}/{msg_type.__name__}'


def why_silent(node: Node, topic: str, msg_type: type, qos: QoSProfile) -> str:
    """
    Return a sentence that explains why a subscription received too few messages.

    :param node: the node that subscribes
    :param topic: name of the topic as given to the subscription
    :param msg_type: message class of the subscription
    :param qos: profile of the subscription
    """
    publishers = node.get_publishers_info_by_topic(topic)
    if not publishers:
        return no_publisher(node, topic)
    for publisher in publishers:
        name = publisher.node_name
        if publisher.topic_type != type_name(msg_type):
            return (
                f'{name} publishes {publisher.topic_type} there, not {type_name(msg_type)}, '
                'and topics of different types do not connect.'
            )
        compatibility, reason = qos_check_compatible(publisher.qos_profile, qos)
        if compatibility == QoSCompatibility.ERROR:
            reason = reason.strip().removesuffix(';')
            return f'{name} publishes there, but the QoS does not match. {reason}'.strip()
    names = ' and '.join(sorted({publisher.node_name for publisher in publishers}))
    return f'{names} publishes there and is connected, but sends too little or too slowly.'


def no_publisher(node: Node, topic: str) -> str:
    """Return one sentence on a topic without publisher, with a similar name or all others."""
    known = [name for name, _ in node.get_topic_names_and_types() if name not in _OWN_TOPICS]
    published = [name for name in known if node.count_publishers(name)]
    near = get_close_matches(node.resolve_topic_name(topic), published, n=1, cutoff=0.75)
    if near:
        return f'Nobody publishes on {topic}; did you mean {near[0]}?'
    others = ', '.join(sorted(published)) or 'none'
    return f'Nobody publishes on {topic}. Topics with a publisher: {others}.'

"""
Find nodes of other processes in this notebook's domain before the notebook starts its own.

Such nodes belong to a terminal that has joined the domain, or to a notebook with the same domain.
This notebook receives everything that they publish, which can surprise the learner.
"""

from __future__ import annotations

from collections import Counter
import uuid

from rclpy.context import Context
from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from roslab.output import say
from roslab.ros2.discovery import wait_for_graph
from roslab.ros2.graph import full_name, node_names

LOOK_S = 0.3
"""Duration of the search [s]; the course's kernels announce themselves ten times a second."""
MOST_NAMED = 4
_PROCESS_BYTES = 8
"""Number of bytes at the beginning of an endpoint's id that are equal in one process."""


def nodes_of_others() -> list[str]:
    """Return the full names of the nodes of other processes, without hidden nodes."""
    context = Context()
    context.init(args=[])
    try:
        node = Node(
            f'_roslab_look_{uuid.uuid4().hex}',
            context=context,
            start_parameter_services=False,
            enable_rosout=False,
        )
        try:
            wait_for_graph(node, LOOK_S)
            found = Counter(node_names(node, hidden=False)) - Counter(_nodes_of_this_process(node))
            return sorted(found)
        finally:
            node.destroy_node()
    finally:
        context.try_shutdown()


def _nodes_of_this_process(node: Node) -> list[str]:
    """
    Return the full names of the nodes in the same process as a given node.

    :param node: a node with a unique name
    """
    # Every node has a publisher on this topic.
    infos = node.get_publishers_info_by_topic('/parameter_events')
    own = [_process_of(info) for info in infos if info.node_name == node.get_name()]
    return [
        full_name(info.node_name, info.node_namespace)
        for info in infos
        if _process_of(info) in own
    ]


def _process_of(info: TopicEndpointInfo) -> bytes:
    return bytes(info.endpoint_gid[:_PROCESS_BYTES])


def tell_of_strangers() -> None:
    """Print the nodes of other processes in the domain, if there are any."""
    names = nodes_of_others()
    if not names:
        return
    more = f' and {len(names) - MOST_NAMED} more' if len(names) > MOST_NAMED else ''
    say(
        f'Note: other programs in the ROS domain of this notebook run nodes already: '
        f'{", ".join(names[:MOST_NAMED])}{more}. This notebook hears them too.'
    )

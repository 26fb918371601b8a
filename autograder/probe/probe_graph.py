"""
Read the ROS graph: the nodes and endpoints other than the probe's own.

The student's program can forge discovery data, so a name may be any string and does not identify a
node.  The probe recognises its own endpoints by its participant id, which it reads before another
node can take its name.
"""

from collections.abc import Iterator
import re
from typing import Any

from probe_wire import qos_json  # type: ignore[import-not-found]  # next to this file
from rclpy.node import Node, NodeNameNonExistentError

# Ignore subscriptions on these topics, which ROS itself creates for nodes.
HIDDEN_TOPICS = ('/parameter_events', '/rosout', '/clock')
# Ignore services of these packages, for the same reason.
HIDDEN_SERVICES = ('rcl_interfaces/', 'type_description_interfaces/', 'lifecycle_msgs/')
MOST_NODES, MOST_ENDPOINTS = 200, 500  # limits of the lists; ``count`` includes every endpoint
LONGEST_NAME = 256
PROCESS_BYTES = 8  # the start of an endpoint's id in Fast DDS: vendor, machine and process
# A full node name that rcl accepts; a query with any other name is an error.
NODE_NAME = re.compile(r'(?:/[A-Za-z_][A-Za-z0-9_]*)+')


class Graph:
    """
    The ROS graph as the probe's node sees it.

    :param node: the probe's node, which subscribes to ``/rosout``; no other node has its name yet
    """

    def __init__(self, node: Node) -> None:
        """Read the common prefix of the ids of the probe's own endpoints."""
        self.node = node
        self.own_name = node.get_fully_qualified_name()
        infos = node.get_subscriptions_info_by_topic('/rosout')
        own = next(info for info in infos if info.node_name == node.get_name())
        self.own_prefix = bytes(own.endpoint_gid[:12])
        self.processes: dict[bytes, int] = {}

    def names(self) -> list[str]:
        """Return the full names of all nodes but the probe's; keep other nodes with its name."""
        found = sorted(
            f'{namespace.rstrip("/")}/{name}'[:LONGEST_NAME]
            for name, namespace in self.node.get_node_names_and_namespaces()
            if name != '_NODE_NAME_UNKNOWN_'
        )
        found = [name for name in found if self._has_publisher(name)]
        if self.own_name in found:
            found.remove(self.own_name)
        return found

    def _has_publisher(self, name: str) -> bool:
        """
        Return whether a node has a publisher; every node has one for ``/parameter_events``.

        If a program ends as soon as it is discovered, the middleware may receive its node's data
        after the removal of all its endpoints.  Then the middleware lists the node forever.
        """
        if not NODE_NAME.fullmatch(name):
            return True
        namespace, _, base = name.rpartition('/')
        try:
            return bool(self.node.get_publisher_names_and_types_by_node(base, namespace or '/'))
        except NodeNameNonExistentError:
            return False

    def askable(self) -> list[str]:
        """Return the distinct names of the nodes whose services can be called."""
        return sorted({name for name in self.names() if NODE_NAME.fullmatch(name)})

    def facts(self) -> dict[str, Any]:
        """Return all nodes, and all endpoints of other participants, with type and QoS."""
        names = self.names()
        endpoints = [one for name in names for one in self._services(name)]
        for topic, _ in self.node.get_topic_names_and_types():
            found = self.node.get_publishers_info_by_topic(topic)
            endpoints += self._described(topic, 'publisher', found)
            if topic not in HIDDEN_TOPICS:
                found = self.node.get_subscriptions_info_by_topic(topic)
                endpoints += self._described(topic, 'subscription', found)
        endpoints.sort(key=lambda e: (e['topic'], e['kind'], e['node'], e['type']))
        for end in endpoints:  # replace process ids, which vary between runs, with stable numbers
            if 'process' in end:
                end['process'] = self.processes.setdefault(end['process'], len(self.processes))
        return {
            'nodes': names[:MOST_NODES],
            'endpoints': endpoints[:MOST_ENDPOINTS],
            'count': len(endpoints),
        }

    def _services(self, name: str) -> Iterator[dict[str, Any]]:
        """Yield the services of a node, without those that each node has."""
        if not NODE_NAME.fullmatch(name):
            return
        namespace, _, base = name.rpartition('/')
        try:
            found = self.node.get_service_names_and_types_by_node(base, namespace or '/')
        except NodeNameNonExistentError:
            return
        for service, types in found:
            for kind in (one for one in types if not one.startswith(HIDDEN_SERVICES)):
                where = {'topic': service[:LONGEST_NAME], 'kind': 'service', 'node': name}
                yield {**where, 'type': kind[:LONGEST_NAME]}

    def _described(self, topic: str, kind: str, found: Any) -> list[dict[str, Any]]:
        return [
            {
                'topic': topic[:LONGEST_NAME],
                'kind': kind,
                'node': f'{info.node_namespace.rstrip("/")}/{info.node_name}'[:LONGEST_NAME],
                'type': info.topic_type[:LONGEST_NAME],
                'type_hash': str(info.topic_type_hash),
                'process': bytes(info.endpoint_gid[:PROCESS_BYTES]),
                'qos': qos_json(info.qos_profile),
            }
            for info in found
            if bytes(info.endpoint_gid[:12]) != self.own_prefix
        ]

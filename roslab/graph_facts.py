"""
Read the publishers and subscriptions of the live ROS graph as plain data.

An endpoint is *matched* if an endpoint on the other side has the same type and a compatible QoS
profile.  The graph also lists endpoints without a match, so this module distinguishes the two.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple
import uuid

from rcl_interfaces.msg import ParameterEvent
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import qos_check_compatible, QoSCompatibility, QoSProfile

from drawing.connections import Edge
from roslab.ros2.graph import full_name, is_hidden, node_names, QUIET_TOPICS, topics_of, UNKNOWN
from roslab.session import HELPER_NAME

NOBODY_SUBSCRIBES = 'nobody subscribes'
NOBODY_PUBLISHES = 'nobody publishes'
NOTEBOOK_LISTENS = 'this notebook listens'
ANOTHER_LISTENS = 'another notebook listens'
HIDDEN_LISTENS = 'only a hidden node listens'
HIDDEN_PUBLISHES = 'only a hidden node publishes'

_POLICIES = ('reliability', 'durability', 'deadline', 'liveliness', 'liveliness_lease_duration')


@dataclass(frozen=True)
class Endpoint:
    """
    A publisher or a subscription.

    :param node: full name of its node
    :param here: whether it belongs to this kernel's participant; True without a check if no other
        notebook is in the graph
    """

    node: str
    type: str
    qos: QoSProfile
    here: bool = True

    @property
    def hidden(self) -> bool:
        """Return whether its node is hidden, like the node of the notebook's listeners."""
        return is_hidden(self.node)


@dataclass(frozen=True)
class Topic:
    """A topic with all its endpoints, including those of hidden nodes."""

    name: str
    publishers: tuple[Endpoint, ...] = ()
    subscriptions: tuple[Endpoint, ...] = ()

    @property
    def ends(self) -> tuple[Endpoint, ...]:
        """All its endpoints."""
        return (*self.publishers, *self.subscriptions)

    @property
    def types(self) -> list[str]:
        """All types of its endpoints; more than one type is an error."""
        return sorted({end.type for end in self.ends})

    @property
    def hidden(self) -> bool:
        """Return whether all its endpoints belong to hidden nodes, which are then shown."""
        return all(end.hidden for end in self.ends)


class Pair(NamedTuple):
    """A publisher and a subscription on a topic, and the reason why they do not match, or ''."""

    publisher: str
    topic: str
    subscription: str
    reason: str = ''


@dataclass(frozen=True)
class Facts:
    """
    The graph at one moment.

    :param nodes: full names; a name that n nodes share is listed n times
    """

    nodes: tuple[str, ...]
    topics: tuple[Topic, ...]
    everything: bool = False

    @cached_property
    def pairs(self) -> list[Pair]:
        """All pairs of visible endpoints, sorted."""
        found: dict[tuple[str, str, str], set[str]] = {}
        for topic in self.topics:
            for out, into in product(
                self._shown(topic, topic.publishers), self._shown(topic, topic.subscriptions)
            ):
                names = topic.name, out.node, into.node
                found.setdefault(names, set()).add(mismatch(out, into))
        # If two nodes have several pairs of endpoints, one matched pair is enough.
        return [
            Pair(publisher, topic, subscription, reason)
            for (topic, publisher, subscription), reasons in sorted(found.items())
            for reason in ([''] if '' in reasons else sorted(reasons))
        ]

    @cached_property
    def edges(self) -> list[Edge]:
        """All arrows, sorted by topic, publishers first."""
        found = []
        for topic in self.topics:
            for ends, others, outward in (
                (topic.publishers, topic.subscriptions, True),
                (topic.subscriptions, topic.publishers, False),
            ):
                for name in sorted({end.node for end in self._shown(topic, ends)}):
                    own = [end for end in ends if end.node == name]
                    matched, remark = self._verdict(topic, own, others, outward)
                    found.append(Edge(name, topic.name, outward, matched, remark))
        return found

    def label(self, node: str) -> str:
        """Return the label of a node in the text and the picture."""
        if node.endswith(UNKNOWN):
            return '(a node not yet known)'
        if node == f'/{HELPER_NAME}':
            return f'{node} (of a notebook)'
        same = self.nodes.count(node)
        return f'{node} ({same} nodes)' if same > 1 else node

    def _shown(self, topic: Topic, ends: Iterable[Endpoint]) -> list[Endpoint]:
        return [end for end in ends if self.everything or topic.hidden or not end.hidden]

    def _verdict(
        self, topic: Topic, own: Sequence[Endpoint], others: Sequence[Endpoint], outward: bool
    ) -> tuple[bool, str]:
        """Return whether endpoints of a node are matched, and a remark."""
        fitting = [other for other in others if any(not _between(e, other, outward) for e in own)]
        if self._shown(topic, fitting):
            return True, ''
        if fitting:
            return True, _unseen(fitting, outward)
        visible = self._shown(topic, others)
        reasons = sorted({_between(e, other, outward) for e in own for other in visible or others})
        if not reasons:
            return False, NOBODY_SUBSCRIBES if outward else NOBODY_PUBLISHES
        return False, '; '.join(reasons) + ('' if visible else f' ({_unseen(others, outward)})')


def _between(end: Endpoint, other: Endpoint, outward: bool) -> str:
    """Return why two endpoints do not match, or an empty string if they do."""
    return mismatch(end, other) if outward else mismatch(other, end)


def _unseen(ends: Iterable[Endpoint], outward: bool) -> str:
    """Return a description of the other side's endpoints that the picture does not show."""
    if not outward:
        return HIDDEN_PUBLISHES
    helpers = [end for end in ends if end.node == f'/{HELPER_NAME}']
    if any(end.here for end in helpers):
        return NOTEBOOK_LISTENS
    return ANOTHER_LISTENS if helpers else HIDDEN_LISTENS


def mismatch(publisher: Endpoint, subscription: Endpoint) -> str:
    """Return why two endpoints of a topic do not match, or an empty string if they do."""
    if publisher.type != subscription.type:
        return f'type differs: {publisher.type} | {subscription.type}'
    offers, wants = publisher.qos, subscription.qos
    compatibility, said = qos_check_compatible(offers, wants)
    if compatibility != QoSCompatibility.ERROR:
        return ''
    found = [
        f'{policy.replace("_", " ")}: offers {_policy(offers, policy)}, '
        f'wants {_policy(wants, policy)}'
        for policy in _POLICIES
        if qos_check_compatible(offers, _wanting(offers, wants, policy))[0]
        == QoSCompatibility.ERROR
    ]
    return '; '.join(found) or said.removeprefix('ERROR: ').strip().rstrip(';')


def _wanting(offers: QoSProfile, wants: QoSProfile, policy: str) -> QoSProfile:
    """Return a profile that differs from the offered one in a single requested policy."""
    values = {name: getattr(offers, name) for name in _POLICIES}
    values[policy] = getattr(wants, policy)
    return QoSProfile(depth=1, **values)


def _policy(qos: QoSProfile, policy: str) -> str:
    value = getattr(qos, policy)
    if isinstance(value, Duration):
        seconds = value.nanoseconds / 1e9
        return 'none' if not 0 < seconds < 1e9 else f'{seconds:g} s'
    return str(value.name)


def read_graph(node: Node, everything: bool = False) -> Facts:
    """
    Return the current graph as seen by one node.

    The graph has the topics of ``ros2 topic list``, so it includes a hidden node if no other node
    has an endpoint on the same topic: a notebook's listener may have misspelt the topic's name.

    :param node: any node; it sees what its process has discovered
    :param everything: include hidden nodes and topics, ``/rosout`` and ``/parameter_events``
    """
    known = node_names(node, hidden=True)
    own = _participant_of(node) if known.count(f'/{HELPER_NAME}') > 1 else b''
    topics = []
    for name in topics_of(node, hidden=everything):
        if everything or name not in QUIET_TOPICS:
            topic = Topic(
                name,
                _endpoints(node.get_publishers_info_by_topic(name), own),
                _endpoints(node.get_subscriptions_info_by_topic(name), own),
            )
            if everything or topic.ends:
                topics.append(topic)
    missing = {end.node for topic in topics for end in topic.ends} - set(known)
    alone = {end.node for topic in topics if topic.hidden for end in topic.ends}
    shown = (
        name for name in (*known, *missing) if everything or name in alone or not is_hidden(name)
    )
    return Facts(tuple(sorted(shown)), tuple(topics), everything)


def only_topic(facts: Facts, topic: str) -> Facts:
    """Return the part of a graph that concerns one topic."""
    topics = tuple(found for found in facts.topics if found.name == topic)
    ends = {end.node for found in topics for end in found.ends}
    return Facts(tuple(n for n in facts.nodes if n in ends), topics, facts.everything)


def _participant_of(node: Node) -> bytes:
    """Return the leading bytes that the ids of a node's endpoints share, its participant's id."""
    # A node of another kernel may have the same name, but never has this topic.
    topic = f'/_roslab/of_{uuid.uuid4().hex}'
    publisher = node.create_publisher(ParameterEvent, topic, 1)
    try:
        return bytes(node.get_publishers_info_by_topic(topic)[0].endpoint_gid[:12])
    finally:
        node.destroy_publisher(publisher)


def _endpoints(infos: Iterable[Any], own: bytes) -> tuple[Endpoint, ...]:
    found = []
    for info in infos:
        # Discovery may report an endpoint shortly before it reports the endpoint's node.
        unknown = info.node_name == UNKNOWN
        full = f'/?{UNKNOWN}' if unknown else full_name(info.node_name, info.node_namespace)
        here = bytes(info.endpoint_gid).startswith(own)
        found.append(Endpoint(full, info.topic_type, info.qos_profile, here))
    return tuple(sorted(found, key=lambda end: (end.node, end.type)))

"""Publish a bag again, with its types, its quality of service and its timing."""

from collections.abc import Callable, Collection
import time

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import qos_check_compatible, QoSCompatibility, ReliabilityPolicy

from roslab.bags.bag import Bag, BagTopic, profile_to_offer
from roslab.bags.reader import BagError, messages_of
from roslab.ros2.interface import hash_of, interface_class

CONNECT_S = 3.0
"""Maximum time for subscriptions of other nodes to connect before the first message [s]."""
LONGEST_WAIT_S = 0.5
"""A signal that arrives just before a wait begins does not end the wait, so each wait is short."""
_ACKNOWLEDGED = Duration(seconds=2.0)


class Player:
    """
    Publishes the messages of a bag.

    :param topics: full names of the topics to publish, none for all
    :raises BagError: if a topic is missing, or a type is not installed or has different fields
    """

    def __init__(self, node: Node, bag: Bag, topics: Collection[str] = ()) -> None:
        self._bag = bag
        self._node = node
        known = {topic.name: topic for topic in bag.topics}
        missing = ', '.join(sorted(set(topics) - set(known)))
        if missing:
            raise BagError(
                f'{bag.path}: no messages on {missing}. Topics in this bag: {", ".join(known)}'
            )
        chosen = [one for one in bag.topics if not topics or one.name in topics]
        kinds = {topic.name: _class_of(bag, topic) for topic in chosen}
        self._publishers: dict[str, Publisher] = {}
        for topic in chosen:
            try:
                profile = profile_to_offer(list(topic.profiles))
            except ValueError as error:
                raise BagError(f'{bag.path}: {topic.name}: {error}.') from None
            kind = kinds[topic.name]
            self._publishers[topic.name] = node.create_publisher(kind, topic.name, profile)

    def connected(self) -> bool:
        """Return whether every subscription that can connect has done so."""
        return all(
            one.get_subscription_count()
            >= sum(
                qos_check_compatible(one.qos_profile, info.qos_profile)[0]
                != QoSCompatibility.ERROR
                for info in self._node.get_subscriptions_info_by_topic(name)
            )
            for name, one in self._publishers.items()
        )

    def play(self, rate: float, wait: Callable[[float], object] = time.sleep) -> int:
        """
        Publish all messages, and wait until reliable subscriptions have received them.

        :param rate: speed relative to the recording, 2.0 for twice as fast
        :param wait: waits for a time [s]
        :returns: how many messages were published
        :raises BagError: if part of the bag is damaged
        """
        began, count = time.monotonic(), 0
        for topic, received_ns, data in messages_of(self._bag):
            if topic in self._publishers:
                due = began + (received_ns - self._bag.start_ns) / 1e9 / rate
                while (left := due - time.monotonic()) > 0:
                    wait(min(left, LONGEST_WAIT_S))
                self._publishers[topic].publish(data)
                count += 1
        for publisher in self._publishers.values():
            if publisher.qos_profile.reliability == ReliabilityPolicy.RELIABLE:
                publisher.wait_for_all_acked(_ACKNOWLEDGED)
        return count


def _class_of(bag: Bag, topic: BagTopic) -> type:
    """Return the class of a topic's messages, whose fields must be the recorded ones."""
    try:
        kind: type = interface_class(topic.type)
        now = hash_of(topic.type)
    except LookupError:
        raise BagError(
            f'{bag.path}: {topic.name} has messages of the type {topic.type}, which is not '
            'installed here. Try: build its package first'
        ) from None
    if topic.hash and now and topic.hash != now:
        raise BagError(
            f'{bag.path}: {topic.type} has changed since {topic.name} was recorded. '
            'Try: record it again'
        )
    return kind

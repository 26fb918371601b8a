"""Subscribe to topics and pass their messages on as bytes, as the publisher serialised them."""

from collections import deque
from collections.abc import Callable, Iterable
from functools import partial
import time
from typing import Any

from rclpy.node import Node
from rclpy.subscription import Subscription
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from roslab.bags.writer import BagWriter
from roslab.ros2.graph import qos_for_publishers
from roslab.ros2.interface import interface_class

_DEPTH = 1000
"""How many messages may wait for the next callback, so that a burst is not lost."""


class Recorder:
    """
    Records topics as soon as they have a publisher.

    Callbacks only store messages, because they may run in another thread; :meth:`drain` writes.

    :param node: a node that something else spins
    :param tell: called with the name of each topic to which the recorder subscribes
    """

    def __init__(
        self,
        node: Node,
        writer: BagWriter,
        topics: Iterable[str] = (),
        tell: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.node = node
        self.heard: deque[tuple[str, bytes, int, int]] = deque()
        self.subscriptions: dict[str, Subscription] = {}
        self.refused: dict[str, str] = {}
        self._writer = writer
        self._topics = set(topics)
        self._tell = tell

    def look(self) -> None:
        """Subscribe to topics that have gained a publisher since the last check."""
        for name, types in self.node.get_topic_names_and_types():
            if name in self.subscriptions or name in self.refused:
                continue
            asked = name in self._topics if self._topics else not topic_or_service_is_hidden(name)
            if asked and self.node.count_publishers(name):
                self._subscribe(name, types)

    def _subscribe(self, name: str, types: list[str]) -> None:
        if len(types) > 1:
            self.refused[name] = f'{name} has several types, {" and ".join(types)}.'
            return
        offered = [one.qos_profile for one in self.node.get_publishers_info_by_topic(name)]
        qos = qos_for_publishers(self.node, name, _DEPTH)
        try:
            kind = interface_class(types[0])
            self._writer.add_topic(name, types[0], offered)
        except LookupError:
            self.refused[name] = f'The type of {name}, {types[0]}, is not installed here.'
            return
        self.subscriptions[name] = self.node.create_subscription(
            kind, name, partial(_store, self.heard, name), qos, raw=True
        )
        self._tell(name)

    def drain(self) -> None:
        """Write the messages that have arrived."""
        while self.heard:
            self._writer.write(*self.heard.popleft())


def _store(heard: deque[tuple[str, bytes, int, int]], name: str, data: bytes, about: Any) -> None:
    received_ns = about['received_timestamp'] or time.time_ns()
    heard.append((name, data, received_ns, about['source_timestamp'] or received_ns))

"""Subscribe to a topic from a notebook cell."""

from collections import deque
from collections.abc import Iterator
import time
from typing import Any
import weakref

from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

from roslab.errors import RoslabError
from roslab.interrupts import HeldInterrupts
from roslab.lookup import type_name, why_silent
from roslab.ros2.graph import topic_types
from roslab.session import session, timeout_error, wait_in

_MOST_MESSAGES = 10_000


class Listener:
    """
    Stores the messages that arrive on a topic.

    It receives messages as long as a variable refers to it, so a cell that runs again replaces its
    listener.  ``stop_all()`` ends its subscription too but keeps the received messages; ``wait``
    and ``clear`` subscribe again.
    """

    def __init__(self, topic: str, msg_type: type, qos: QoSProfile) -> None:
        self.topic = topic
        self.msg_type = msg_type
        self.qos = qos
        self._session = session()
        self._heard: deque[tuple[float, Any]] = deque(maxlen=_MOST_MESSAGES)
        self.began = time.monotonic()
        self._begin()

    @property
    def messages(self) -> list[Any]:
        """All messages received so far, oldest first."""
        return [message for _, message in tuple(self._heard)]

    @property
    def times(self) -> list[float]:
        """Times at which the messages arrived, in seconds since listening began."""
        return [heard - self.began for heard, _ in tuple(self._heard)]

    @property
    def now(self) -> float:
        """The current time on the scale of ``times``, to mark other events [s]."""
        return time.monotonic() - self.began

    @property
    def last(self) -> Any | None:
        """The newest message, or None before the first."""
        return self._heard[-1][1] if self._heard else None

    @property
    def alive(self) -> bool:
        """Return whether the listener can still receive messages."""
        return self._end.alive and self._session.owns(self._node)

    def _begin(self) -> None:
        self._node = self._session.helper
        with HeldInterrupts():
            # The callback refers to the deque, not to the listener, so that the listener can be
            # garbage-collected.
            subscription = _subscribe(self._node, self.topic, self.msg_type, self.qos, self._heard)
            # The garbage collector may run the finalizer in any thread.
            forget = self._session.forget
            self._end = weakref.finalize(self, forget, self._node, subscription)
            # At exit, the session destroys entire nodes including their subscriptions.
            self._end.atexit = False

    def _begin_again(self) -> None:
        """Subscribe again after stop_all() or a shutdown of ROS, but not after ``stop``."""
        if self._end.alive and not self._session.owns(self._node):
            self._end.detach()
            self._begin()

    def wait(self, count: int = 1, timeout: float = 10.0) -> list[Any]:
        """
        Wait until a number of messages have arrived since listening began.

        :param count: how many messages to wait for
        :param timeout: how long to wait [s]
        :returns: all messages received so far
        :raises TimeoutError: after the timeout; the message gives a reason if the graph shows one
        """
        heard = self._heard
        try:
            self._begin_again()
            if not wait_in(lambda: len(heard) >= count, timeout):
                raise self.missing_messages_error(count, timeout)
            return self.messages
        finally:
            # IPython stores the last traceback, which would keep the subscription alive.
            del self

    def missing_messages_error(self, count: int, timeout: float) -> TimeoutError:
        """Return the error of a wait that timed out, with possible reasons."""
        hints = self._session.hints if self._session.nodes() else self._session.losses
        return timeout_error(
            f'Heard {len(self)} of {count} messages on {self.topic} in {timeout:g} s.',
            why_silent(self._node, self.topic, self.msg_type, self.qos),
            hints(),
        )

    def clear(self) -> None:
        """Discard all received messages, to wait for new ones."""
        self._begin_again()
        self._heard.clear()

    def stop(self) -> None:
        """Stop listening and keep the received messages."""
        self._end()

    def __len__(self) -> int:
        return len(self._heard)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.messages)

    def __getitem__(self, index: int) -> Any:
        return self.messages[index]

    def __repr__(self) -> str:
        state = 'listening' if self.alive else 'stopped'
        return f'<{self.topic} [{type_name(self.msg_type)}]: {len(self)} heard, {state}>'


def _subscribe(
    node: Node, topic: str, msg_type: type, qos: QoSProfile, heard: deque[tuple[float, Any]]
) -> Subscription:
    if not isinstance(topic, str):
        example = f"listen('chatter', {getattr(topic, '__name__', 'String')})"
        raise RoslabError(
            f'The first argument of listen() must be the name of a topic, as in {example}, '
            f'not {topic!r}.'
        )
    if not (isinstance(msg_type, type) and hasattr(msg_type, 'get_fields_and_field_types')):
        raise RoslabError(
            f'listen({topic!r}, ...) expected a message class, as in '
            f'listen({topic!r}, String) after "from std_msgs.msg import String", got {msg_type!r}.'
        )
    # Check first, because the middleware reports a second type with a misleading error on stderr.
    known = topic_types(node, node.resolve_topic_name(topic))
    if known and type_name(msg_type) not in known:
        raise RoslabError(
            f'{topic} carries {" and ".join(known)}, so you cannot subscribe to it with '
            f'{type_name(msg_type)}. Listen with the type that the publisher uses.'
        )
    return node.create_subscription(
        msg_type, topic, lambda message: heard.append((time.monotonic(), message)), qos
    )


def listen(
    topic: str, msg_type: type, *, depth: int = 10, qos: QoSProfile | None = None
) -> Listener:
    """
    Subscribe to a topic and store the received messages in ``messages``.

    :param topic: name of the topic
    :param msg_type: class of the topic's messages
    :param depth: how many messages can wait in the queue for the callback
    :param qos: a complete QoS profile, instead of a reliable one of this depth
    """
    return Listener(topic, msg_type, qos or QoSProfile(depth=depth))

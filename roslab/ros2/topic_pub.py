"""Implement ``ros2 topic pub``."""

import argparse
import array
from collections.abc import Mapping
import time
from typing import Any

import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
import yaml

from roslab.cli_text import item_type
from roslab.ros2.cli import flag, natural, option, positive_float, verb
from roslab.ros2.discovery import NODE, ros_node
from roslab.ros2.graph import named_class, preset
from roslab.ros2.interface import interface_class
from roslab.ros2.qos_options import qos_arguments, qos_asked_for

_LOOK_S = 0.1
_ACKNOWLEDGED_S = 3
_LOOKS_A_LINE = 10
"""Polls between two lines of output, to print one line per second."""


@verb(
    'topic pub',
    option('topic_name', help="Name of the ROS topic to publish to, such as '/chatter'"),
    option('message_type', help="Type of the message, such as 'std_msgs/msg/String'"),
    option('values', nargs='?', default='{}', help="YAML values, such as 'data: hello'"),
    option('-r', '--rate', metavar='N', type=positive_float, default=1.0, help='Hz (default: 1)'),
    option('-p', '--print', metavar='N', type=int, default=1, help='print every N-th message'),
    flag('-1', '--once', 'publish one message and exit', exclusive=True),
    option(
        '-t',
        '--times',
        type=natural,
        default=0,
        metavar='N',
        help='publish N messages and exit',
        exclusive=True,
    ),
    option(
        '-w',
        '--wait-matching-subscriptions',
        type=natural,
        metavar='N',
        help='wait until N subscriptions match (default: 1 with -1 or -t, otherwise 0)',
    ),
    option(
        '--max-wait-time-secs',
        type=positive_float,
        metavar='S',
        help='time to wait for matching subscriptions (default: forever)',
    ),
    option(
        '--keep-alive',
        metavar='S',
        type=positive_float,
        default=0.1,
        help='keep the publisher for S seconds after the last message (default: 0.1)',
    ),
    option('-n', '--node-name', help='name of the publishing node'),
    *qos_arguments('publish', 'default'),
    *NODE,
)
def publish(args: argparse.Namespace) -> None:
    """Publish a message to a topic."""
    message_class = named_class(args.message_type)
    values = parsed(args.values)
    times = 1 if args.once else args.times
    wanted = args.wait_matching_subscriptions
    with ros_node(args, args.node_name) as node:
        qos = qos_asked_for(args, 'default') or preset('default')
        publisher = node.create_publisher(message_class, args.topic_name, qos)
        message = message_class()
        try:
            fill(message, values, node.get_clock().now().to_msg())
        except Exception as problem:
            raise RuntimeError(f'Failed to populate field: {problem}') from None
        wanted = int(times > 0) if wanted is None else wanted
        _wait_for_subscriptions(node, publisher, wanted, args.max_wait_time_secs)
        print('publisher: beginning loop', flush=True)
        _publish(args, node, publisher, message, values, times)
        if times:
            # Wait until reliable subscribers have acknowledged.  Best-effort subscribers never do,
            # so also wait for a fixed time, as ros2 does.
            publisher.wait_for_all_acked(Duration(seconds=_ACKNOWLEDGED_S))
            _spin_for(node, args.keep_alive)


def _spin_for(node: Node, seconds: float) -> None:
    """Spin for some time, so that QoS events of the publisher are reported."""
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        rclpy.spin_once(node, timeout_sec=left)


def _wait_for_subscriptions(
    node: Node, publisher: Publisher, wanted: int, limit_s: float | None
) -> None:
    looks = 0
    while (have := publisher.get_subscription_count()) < wanted:
        if looks % _LOOKS_A_LINE == 0:
            print(f'Waiting for at least {wanted} matching subscription(s)...', flush=True)
        if limit_s is not None and looks * _LOOK_S >= limit_s:
            raise RuntimeError(
                f'Timed out waiting for subscribers: Expected {wanted} subscribers but only got '
                f'{have} subscribers'
            )
        looks += 1
        _spin_for(node, _LOOK_S)


def _publish(
    args: argparse.Namespace,
    node: Node,
    publisher: Publisher,
    message: Any,
    values: dict[str, Any],
    times: int,
) -> None:
    """Publish immediately, then at the given rate until the count is reached."""
    count = 0

    def tick() -> None:
        nonlocal count
        count += 1
        fill(message, values, node.get_clock().now().to_msg())
        if args.print and count % args.print == 0:
            print(f'publishing #{count}: {message!r}\n', flush=True)
        publisher.publish(message)

    tick()
    timer = node.create_timer(1.0 / args.rate, tick)
    while times == 0 or count < times:
        rclpy.spin_once(node, timeout_sec=0.1)
    node.destroy_timer(timer)


def parsed(text: str) -> dict[str, Any]:
    """Parse YAML text into a dictionary; RuntimeError if it is not YAML, or not a mapping."""
    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise RuntimeError(f'The passed value is not YAML: {error}') from None
    if values is None or values == '':
        return {}
    if not isinstance(values, dict):
        raise RuntimeError('The passed value needs to be a dictionary in YAML format')
    return values


def fill(message: Any, values: Mapping[str, Any], now: Any = None) -> None:
    """
    Set fields of a message from a dictionary.

    :param values: values by field name; a nested message is a nested mapping
    :param now: the current time as a message, for ``stamp: now`` and ``header: auto``
    :raises AttributeError: if a field does not exist
    :raises TypeError, ValueError, AssertionError: if a value does not fit its field
    """
    kinds = message.get_fields_and_field_types()
    for name, value in values.items():
        old = getattr(message, name)
        if now is not None and value == 'now' and kinds[name] == 'builtin_interfaces/Time':
            setattr(message, name, now)
        elif now is not None and value == 'auto' and kinds[name] == 'std_msgs/Header':
            old.stamp = now
        elif hasattr(old, 'get_fields_and_field_types'):
            fill(old, value or {}, now)
        else:
            setattr(message, name, _converted(old, value, kinds[name], now))


def _converted(old: Any, value: Any, kind: str, now: Any) -> Any:
    """Return a value converted to the type of its field."""
    item = item_type(kind)
    if isinstance(old, list):
        if '/' in item:
            return [_message(item, one, now) for one in value]
        return [_single(one, item) for one in value]
    if isinstance(old, array.array):
        return array.array(old.typecode, value)
    if hasattr(old, 'dtype'):
        import numpy

        return numpy.array(value, dtype=old.dtype)
    if isinstance(old, bytes):
        return bytes([value]) if isinstance(value, int) else str(value).encode('latin-1')
    return type(old)(value)


def _single(value: Any, kind: str) -> Any:
    if kind in ('boolean', 'bool'):
        return bool(value)
    if kind == 'octet':
        return bytes([value])
    return str(value)


def _message(kind: str, value: Mapping[str, Any], now: Any) -> Any:
    message = interface_class(kind)()
    fill(message, value, now)
    return message

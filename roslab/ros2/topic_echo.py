"""Implement the verbs of ``ros2 topic`` that subscribe: ``echo``, ``hz`` and ``bw``."""

import argparse
from collections.abc import Callable
import time
from typing import Any

import rclpy
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
import yaml

from roslab.cli_text import field_text, hz_text, message_dict, Shorten, TRUNCATE_AT
from roslab.ros2.cli import flag, Option, option, positive_int, verb
from roslab.ros2.discovery import knowing_node, NODE
from roslab.ros2.graph import class_of_topic, known_class, named_class, qos_for_publishers
from roslab.ros2.qos_options import qos_arguments, qos_asked_for

_BETWEEN_S = 1.0
"""Time between two reports of ``hz`` and ``bw`` [s]."""


@verb(
    'topic echo',
    option('topic_name', help="Name of the ROS topic to listen to, such as '/chatter'"),
    option('message_type', nargs='?', help="Type of the message, such as 'std_msgs/msg/String'"),
    *qos_arguments('subscribe', 'sensor_data'),
    flag('--csv', 'print all fields of a message on one line, separated by commas'),
    flag('--once', 'print the first message and exit'),
    flag('--flow-style', 'print collections on one line (not with --csv)'),
    flag('--no-arr', 'print only the type and length of arrays'),
    flag('--no-str', 'print only the length of strings'),
    flag('--raw', 'print the bytes of the message as received'),
    flag('--no-lost-messages', 'do not report messages that were lost'),
    flag('--include-message-info', 'print when a message was sent and received'),
    option('--field', metavar='NAME', help="print only this field, such as 'header.stamp'"),
    option('--timeout', type=float, metavar='S', help='give up after S seconds'),
    option('--filter', metavar='EXPR', help='print only messages m for which EXPR is true'),
    flag('-f', '--full-length', 'print strings and arrays in full'),
    option(
        '-l',
        '--truncate-length',
        type=int,
        default=TRUNCATE_AT,
        metavar='N',
        help=f'maximum length of strings and arrays (default: {TRUNCATE_AT})',
    ),
    *NODE,
)
def echo(args: argparse.Namespace) -> None:
    """Output messages from a topic."""
    accept = eval(f'lambda m: {args.filter}') if args.filter else (lambda _: True)
    show = _printer(args)
    seen: list[Any] = []

    def heard(message: Any, information: Any) -> None:
        if not seen and accept(message):
            show(message, information)
            if args.once:
                seen.append(message)

    named = named_class(args.message_type) if args.message_type else None
    known = None if named else (lambda node: known_class(node, args.topic_name))
    with knowing_node(args, known) as node:
        message_class = named or class_of_topic(node, args.topic_name)
        if message_class is None:
            raise RuntimeError('Could not determine the type for the passed topic')
        qos = qos_asked_for(args, 'sensor_data') or qos_for_publishers(node, args.topic_name)
        events = None if args.no_lost_messages else SubscriptionEventCallbacks(message_lost=_lost)
        node.create_subscription(
            message_class, args.topic_name, heard, qos, event_callbacks=events, raw=args.raw
        )
        deadline = None if args.timeout is None else time.monotonic() + args.timeout
        while not seen and (deadline is None or time.monotonic() < deadline):
            rclpy.spin_once(node, timeout_sec=0.1)


def _lost(event: Any) -> None:
    print(
        'A message was lost!!!\n'
        f'\ttotal count change:{event.total_count_change}\n\ttotal count: {event.total_count}'
    )


def _printer(args: argparse.Namespace) -> Callable[[Any, Any], None]:
    """Return a function that prints one message according to the options."""
    truncate = None if args.full_length else args.truncate_length
    shorten = Shorten(truncate, args.no_arr, args.no_str)

    def show(message: Any, information: Any) -> None:
        if args.include_message_info and not args.csv:
            print(yaml.safe_dump(dict(information), sort_keys=False), end='---\n')
        if args.raw:
            text = f'{message!r}\n'
        else:
            text = _text(*_selected(message, args.field), args, shorten)
        print(text.rstrip('\n') if args.csv else f'{text}---', flush=True)

    return show


def _text(value: Any, kind: str, args: argparse.Namespace, shorten: Shorten) -> str:
    """Return the text of a message or a field, with a line break."""
    if args.csv and hasattr(value, 'get_fields_and_field_types'):
        return ','.join(str(item) for item in _flat(message_dict(value)))
    return field_text(value, kind, shorten, flow=args.flow_style and not args.csv)


def _selected(message: Any, path: str | None) -> tuple[Any, str]:
    """Return one field of a message and its type; RuntimeError if the field does not exist."""
    value, kind = message, ''
    for name in path.split('.') if path else ():
        name, _, index = name.partition('[')
        kinds: dict[str, str] = getattr(value, 'get_fields_and_field_types', dict)()
        if name not in kinds:
            raise RuntimeError(f"Invalid field '{path}': the message has no field '{name}'")
        value, kind = getattr(value, name), kinds[name]
        if index:
            value, kind = value[int(index.rstrip(']'))], ''
    return value, kind


def _flat(value: Any) -> list[Any]:
    """Return the single values in nested dictionaries and lists."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [single for item in value for single in _flat(item)]
    return [value]


def _options(window: int = 10000) -> list[Option]:
    """Return the options; ``window`` is the default number of messages per statistic."""
    return [
        option('topic_name', help="Name of the ROS topic to listen to, such as '/chatter'"),
        option(
            '-w',
            '--window',
            type=positive_int,
            default=window,
            metavar='N',
            help=f'number of messages per statistic (default: {window})',
        ),
        *NODE,
    ]


@verb('topic hz', *_options(), flag('--wall-time', 'measure with the wall clock'))
def hz(args: argparse.Namespace) -> None:
    """Print the average receiving rate to screen."""
    times: list[float] = []

    def heard(_: bytes, node: Node) -> None:
        # With --use-sim-time, the node's clock follows /clock.
        times.append(time.time() if args.wall_time else node.get_clock().now().nanoseconds * 1e-9)
        if times[-1] < times[0]:
            print('time has reset, resetting counters')
            times.clear()
        del times[: -args.window - 1]

    _report(args, heard, lambda: hz_text(times) if len(times) > 1 else '')


@verb('topic bw', *_options(100))
def bw(args: argparse.Namespace) -> None:
    """Display bandwidth used by topic."""
    heard_at: list[tuple[float, int]] = []

    def heard(data: bytes, _: Node) -> None:
        heard_at.append((time.monotonic(), len(data)))
        del heard_at[: -args.window]

    def text() -> str:
        sizes = [size for _, size in heard_at]
        if len(sizes) < 2:
            return ''
        rate = sum(sizes) / (time.monotonic() - heard_at[0][0])
        mean, low, high = (_bytes(n) for n in (sum(sizes) / len(sizes), min(sizes), max(sizes)))
        return (
            f'{_bytes(rate)}/s from {len(sizes)} messages\n'
            f'\tMessage size mean: {mean} min: {low} max: {high}'
        )

    _report(args, heard, text, f'Subscribed to [{args.topic_name}]')


def _bytes(number: float) -> str:
    for unit, name in ((1e6, 'MB'), (1e3, 'KB')):
        if number >= unit:
            return f'{number / unit:.2f} {name}'
    return f'{number:.0f} B'


def _report(
    args: argparse.Namespace,
    heard: Callable[[bytes, Node], None],
    text: Callable[[], str],
    greeting: str = '',
) -> None:
    """
    Subscribe, and print a report once a second if messages have arrived since the last report.

    :param heard: called with the bytes of each message
    """
    arrived = 0

    def callback(data: Any) -> None:
        nonlocal arrived
        arrived += 1
        heard(data, node)

    with knowing_node(args, lambda node: known_class(node, args.topic_name)) as node:
        kind = class_of_topic(node, args.topic_name, wait=True)
        qos = qos_for_publishers(node, args.topic_name)
        node.create_subscription(kind, args.topic_name, callback, qos, raw=True)
        if greeting:
            print(greeting, flush=True)
        shown_at, shown = time.monotonic(), 0
        while True:
            rclpy.spin_once(node, timeout_sec=0.1)
            if arrived > shown and time.monotonic() - shown_at >= _BETWEEN_S and (line := text()):
                print(line, flush=True)
                shown_at, shown = time.monotonic(), arrived

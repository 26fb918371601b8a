"""Implement ``ros2 topic echo``."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
import time
from typing import Any

import rclpy
from rclpy.event_handler import SubscriptionEventCallbacks

from roslab.cli_text import field_text, message_dict, message_yaml, TRUNCATE_AT
from roslab.ros2.cli import Outcome
from roslab.ros2.discovery import add_node_arguments, knowing_node
from roslab.ros2.qos_options import add_qos_arguments, qos_asked_for, qos_for_publishers
from roslab.ros2.topic_class import class_of_topic, known_class, named_class


def add_echo_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    parser.add_argument('topic_name', help="Name of the ROS topic to listen to, '/chatter'")
    parser.add_argument(
        'message_type', nargs='?', help="Type of the ROS message, 'std_msgs/msg/String'"
    )
    add_qos_arguments(parser, 'subscribe', 'sensor_data')
    switches = {
        '--csv': 'all fields of a message on one line, separated by commas',
        '--once': 'print the first message and exit',
        '--flow-style': 'print collections in one line (not with --csv)',
        '--no-arr': 'only type and length of arrays',
        '--no-str': 'only the length of texts',
        '--raw': 'the bytes of the message as they were received',
        '--no-lost-messages': 'do not report messages that were lost',
        '--include-message-info': 'also when a message was sent and received',
    }
    for name, words in switches.items():
        parser.add_argument(name, action='store_true', help=words)
    parser.add_argument('--field', metavar='NAME', help="only this field, 'header.stamp'")
    parser.add_argument('--timeout', type=float, metavar='S', help='give up after so many seconds')
    parser.add_argument('--filter', metavar='EXPR', help='only messages m for which this is true')
    parser.add_argument(
        '-f', '--full-length', action='store_true', help='texts and arrays in full length'
    )
    parser.add_argument(
        '-l',
        '--truncate-length',
        type=int,
        default=TRUNCATE_AT,
        metavar='N',
        help=f'where longer texts and arrays are cut (default: {TRUNCATE_AT})',
    )
    add_node_arguments(parser)


def echo(args: argparse.Namespace) -> Outcome:
    """Print the messages of a topic until the user or an option ends the command."""
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
            return 'Could not determine the type for the passed topic'
        qos = qos_asked_for(args, 'sensor_data') or qos_for_publishers(node, args.topic_name)
        events = None if args.no_lost_messages else SubscriptionEventCallbacks(message_lost=_lost)
        node.create_subscription(
            message_class,
            args.topic_name,
            heard,
            qos,
            event_callbacks=events,
            raw=args.raw,
        )
        deadline = None if args.timeout is None else time.monotonic() + args.timeout
        while not seen and (deadline is None or time.monotonic() < deadline):
            rclpy.spin_once(node, timeout_sec=0.1)
    return None


def _lost(event: Any) -> None:
    print(
        'A message was lost!!!\n'
        f'\ttotal count change:{event.total_count_change}\n\ttotal count: {event.total_count}'
    )


def _printer(args: argparse.Namespace) -> Callable[[Any, Any], None]:
    """Return a function that prints one message according to the options."""
    how = {'truncate': None if args.full_length else args.truncate_length}
    how |= {'no_arr': args.no_arr, 'no_str': args.no_str}
    to_text = partial(_csv, args, how) if args.csv else partial(_yaml, args, how)

    def show(message: Any, information: Any) -> None:
        if args.include_message_info and not args.csv:
            import yaml

            print(yaml.safe_dump(dict(information), sort_keys=False), end='---\n')
        print(to_text(message), flush=True)

    return show


def _selected(message: Any, path: str | None) -> tuple[Any, str]:
    """
    Return one field of a message and its type.

    :raises RuntimeError: if the field does not exist
    """
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


def _yaml(args: argparse.Namespace, how: dict[str, Any], message: Any) -> str:
    if args.raw:
        return f'{message!r}\n---'
    value, kind = _selected(message, args.field)
    if hasattr(value, 'get_fields_and_field_types'):
        return f'{message_yaml(value, **how, flow=args.flow_style)}---'
    return f'{field_text(value, kind, **how, flow=args.flow_style)}---'


def _csv(args: argparse.Namespace, how: dict[str, Any], message: Any) -> str:
    if args.raw:
        return repr(message)
    value, kind = _selected(message, args.field)
    if not hasattr(value, 'get_fields_and_field_types'):
        return field_text(value, kind, **how).rstrip('\n')
    return ','.join(str(item) for item in _flat(message_dict(value)))


def _flat(value: Any) -> list[Any]:
    """Return the single values in nested dictionaries and lists."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [single for item in value for single in _flat(item)]
    return [value]

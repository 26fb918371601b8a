"""Implement ``ros2 topic hz``, ``bw`` and ``delay``, which print one line a second."""

from __future__ import annotations

import argparse
from collections.abc import Callable
import math
import time
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.serialization import deserialize_message

from roslab.cli_text import hz_text
from roslab.ros2.cli import Outcome
from roslab.ros2.discovery import add_node_arguments, knowing_node
from roslab.ros2.qos_options import qos_for_publishers
from roslab.ros2.topic_class import class_of_topic, known_class

_WINDOW = 10000
_BETWEEN_S = 1.0


def positive_int(text: str) -> int:
    """Parse an integer greater than zero; for argparse."""
    if (number := int(text)) <= 0:
        raise argparse.ArgumentTypeError('value must be a positive integer')
    return number


def add_rate_arguments(parser: argparse.ArgumentParser, window: int = _WINDOW) -> None:
    """
    Add the options.

    :param window: default number of messages per statistic
    """
    parser.add_argument('topic_name', help="Name of the ROS topic to listen to, '/chatter'")
    parser.add_argument(
        '-w',
        '--window',
        type=positive_int,
        default=window,
        metavar='N',
        help=f'how many messages are counted together (default: {window})',
    )
    add_node_arguments(parser)


def hz(args: argparse.Namespace) -> Outcome:
    """Print the rate at which messages arrive."""
    times: list[float] = []

    def heard(_: bytes, node: Node) -> None:
        # With --use-sim-time, the node's clock follows /clock.
        wall = getattr(args, 'wall_time', False)
        times.append(time.time() if wall else node.get_clock().now().nanoseconds * 1e-9)
        if times[-1] < times[0]:
            print('time has reset, resetting counters')
            times.clear()
        del times[: -args.window - 1]

    return _report(args, heard, lambda: hz_text(times) if len(times) > 1 else '')


def bw(args: argparse.Namespace) -> Outcome:
    """Print the bandwidth of the messages that arrive."""
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

    return _report(args, heard, text, f'Subscribed to [{args.topic_name}]')


def _bytes(number: float) -> str:
    for unit, name in ((1e6, 'MB'), (1e3, 'KB')):
        if number >= unit:
            return f'{number / unit:.2f} {name}'
    return f'{number:.0f} B'


def delay(args: argparse.Namespace) -> Outcome:
    """Print the age of messages on arrival, from the stamps in their headers."""
    delays: list[float] = []

    def heard(data: bytes, node: Node) -> None:
        message = deserialize_message(data, args.message_class)
        if not hasattr(message, 'header'):
            raise RuntimeError('msg does not have header')
        stamp = message.header.stamp
        now = node.get_clock().now().nanoseconds * 1e-9
        delays.append(now - stamp.sec - stamp.nanosec * 1e-9)
        del delays[: -args.window]

    def text() -> str:
        if not delays:
            return ''
        mean = sum(delays) / len(delays)
        deviation = math.sqrt(sum((one - mean) ** 2 for one in delays) / len(delays))
        return (
            f'average delay: {mean:.3f}\n\tmin: {min(delays):.3f}s max: {max(delays):.3f}s '
            f'std dev: {deviation:.5f}s window: {len(delays)}'
        )

    return _report(args, heard, text)


def _report(
    args: argparse.Namespace,
    heard: Callable[[bytes, Node], None],
    text: Callable[[], str],
    greeting: str = '',
) -> Outcome:
    """
    Subscribe, and print a text once a second if messages have arrived since the last one.

    :param heard: called with the bytes of each message
    :param text: returns the text to print, '' if there is none yet
    """
    arrived = 0

    def callback(data: Any) -> None:
        nonlocal arrived
        arrived += 1
        heard(data, node)

    with knowing_node(args, lambda node: known_class(node, args.topic_name)) as node:
        args.message_class = class_of_topic(node, args.topic_name, wait=True)
        qos = qos_for_publishers(node, args.topic_name)
        node.create_subscription(args.message_class, args.topic_name, callback, qos, raw=True)
        if greeting:
            print(greeting, flush=True)
        told_at, told = time.monotonic(), 0
        while True:
            rclpy.spin_once(node, timeout_sec=0.1)
            if arrived > told and time.monotonic() - told_at >= _BETWEEN_S and (line := text()):
                print(line, flush=True)
                told_at, told = time.monotonic(), arrived

"""Implement ``ros2 topic hz`` and ``bw``, which print a report once a second."""

import argparse
from collections.abc import Callable
import time
from typing import Any

import rclpy
from rclpy.node import Node

from roslab.cli_text import hz_text
from roslab.ros2.cli import flag, Option, option, positive_int, verb
from roslab.ros2.discovery import knowing_node, NODE
from roslab.ros2.graph import class_of_topic, known_class, qos_for_publishers

_BETWEEN_S = 1.0


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

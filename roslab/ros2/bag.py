"""``ros2 bag``: record, describe and play MCAP files."""

from __future__ import annotations

import argparse
from datetime import datetime
from pathlib import Path
import signal
import sys
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from roslab.bags.bag import Bag, to_yaml
from roslab.bags.player import CONNECT_S, Player
from roslab.bags.reader import open_bag
from roslab.bags.recorder import Recorder
from roslab.bags.writer import BagWriter
from roslab.ros2.cli import Outcome, verbs_of
from roslab.ros2.discovery import ros_node, wait_for, wait_for_graph
from roslab.ros2.topic_pub import positive_float

_LOOK_S = 0.1
"""Time between two looks for new topics, as ``--polling-interval`` of the real command [s]."""


def add_arguments(group: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    add = verbs_of(group)
    parser = add('info', info, 'Print information about a bag to the screen')
    _add_path(parser)
    parser.add_argument('-t', '--topic-name', action='store_true', help='only names of topics')
    _add_storage(parser)
    parser = add('play', play, 'Play back ROS data from a bag')
    _add_path(parser)
    parser.add_argument(
        '-r',
        '--rate',
        type=positive_float,
        default=1.0,
        help='how many times as fast (default: 1)',
    )
    parser.add_argument('--topics', nargs='+', default=[], metavar='TOPIC', help='only these')
    parser.add_argument(
        '-d', '--delay', type=float, default=0.0, metavar='S', help='wait before the first message'
    )
    parser.add_argument('-l', '--loop', action='store_true', help='begin again at the end')
    _add_storage(parser)
    parser = add('record', record, 'Record ROS data to a bag')
    parser.add_argument('topics_positional', nargs='*', metavar='TOPIC', help='topics to record')
    parser.add_argument('--topics', nargs='+', default=[], metavar='TOPIC', help='the same')
    parser.add_argument('-a', '--all', action='store_true', help='all topics that are not hidden')
    parser.add_argument('-o', '--output', help='folder to create (default: named after the time)')
    _add_storage(parser)


def _add_path(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('bag_path', type=Path, help='Bag to open: a folder or an .mcap file')


def _add_storage(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('-s', '--storage', choices=['mcap'], help='the format; only mcap here')
    parser.set_defaults(use_sim_time=False)


def info(args: argparse.Namespace) -> Outcome:
    """Print the summary of a bag."""
    bag = open_bag(args.bag_path)
    if args.topic_name:
        print('\n'.join(topic.name for topic in bag.topics))
    else:
        # The real command frames the summary with an empty line and a count of services.
        print(f'\n{bag}\nService:           0\nService information: \n')
    return None


def play(args: argparse.Namespace) -> Outcome:
    """Publish the messages of a bag."""
    bag = open_bag(args.bag_path)
    with ros_node(args, 'rosbag2_player') as node:
        player = Player(node, bag, [node.resolve_topic_name(topic) for topic in args.topics])
        wait_for_graph(node)
        wait_for(node, player.connected, CONNECT_S)
        node.get_logger().info(f'Set rate to {args.rate:g}')
        while True:
            time.sleep(args.delay)
            player.play(args.rate)
            if not args.loop:
                return None


def record(args: argparse.Namespace) -> Outcome:
    """Record topics until Ctrl-C; the bag is complete then."""
    topics = [*args.topics_positional, *args.topics]
    if not topics and not args.all:
        return '[ERROR] [ros2bag]: Need to specify at least one option out of --all, --topics'
    folder = Path(args.output or f'{datetime.now():rosbag2_%Y_%m_%d-%H_%M_%S}')
    if folder.exists():
        return f"[ERROR] [ros2bag]: Output folder '{folder}' already exists."
    # Ctrl-C shuts ROS down, which ends the loop; KeyboardInterrupt could cut off a write.
    signal.signal(signal.SIGINT, lambda *_: None)
    with ros_node(args, 'rosbag2_recorder') as node:
        try:
            folder.mkdir(parents=True)
            bag = _record(node, folder / f'{folder.name}_0.mcap', topics)
        except OSError as error:
            return f'[ERROR] [ros2bag]: {folder}: {error.strerror or error}'
        finally:
            if folder.is_dir() and not any(folder.iterdir()):
                folder.rmdir()
    if bag is None:
        return '[WARN] [ros2bag]: No message arrived, so nothing was written.'
    about = {'rosbag2_bagfile_information': bag.metadata()}
    (folder / 'metadata.yaml').write_text(to_yaml(about), encoding='utf-8')
    return None


def _record(node: Node, file: Path, topics: list[str]) -> Bag | None:
    say = node.get_logger().info
    with BagWriter(file) as writer:
        recorder = Recorder(
            node,
            writer,
            [node.resolve_topic_name(topic) for topic in topics],
            lambda name: say(f"Subscribed to topic '{name}'"),
        )
        say('Listening for topics...')
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        try:
            while rclpy.ok():
                recorder.look()
                executor.spin_once(timeout_sec=_LOOK_S)
                recorder.drain()
        except Exception:
            # After a signal has shut the context down, ignore exceptions of rclpy.
            if rclpy.ok():
                raise
        recorder.drain()
    for why in recorder.refused.values():
        print(f'[WARN] [ros2bag]: {why}', file=sys.stderr)
    return writer.bag

"""``ros2 bag``: record, describe and play MCAP files."""

import argparse
from datetime import datetime
from pathlib import Path
import signal
import sys
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from roslab.bags.bag import Bag
from roslab.bags.player import CONNECT_S, Player
from roslab.bags.reader import open_bag
from roslab.bags.writer import BagWriter, Recorder
from roslab.cli_text import to_yaml
from roslab.ros2.cli import flag, option, positive_float, verb
from roslab.ros2.discovery import ros_node, wait_for, wait_for_graph

_LOOK_S = 0.1
"""Time between two checks for new topics, as ``--polling-interval`` of the real command [s]."""

_PATH = option('bag_path', type=Path, help='Bag to open: a folder or an .mcap file')
_STORAGE = option('-s', '--storage', choices=['mcap'], help='storage format (only mcap)')
_TOPICS = option('--topics', nargs='+', default=[], metavar='TOPIC', help='use only these')


@verb('bag info', _PATH, flag('-t', '--topic-name', 'print only the topic names'), _STORAGE)
def info(args: argparse.Namespace) -> None:
    """Print information about a bag to the screen."""
    bag = open_bag(args.bag_path)
    if args.topic_name:
        print('\n'.join(topic.name for topic in bag.topics))
    else:
        # The real command frames the summary with an empty line and a count of services.
        print(f'\n{bag}\nService:           0\nService information: \n')


@verb(
    'bag play',
    _PATH,
    option(
        '-r',
        '--rate',
        type=positive_float,
        default=1.0,
        help='speed relative to the recording (default: 1)',
    ),
    _TOPICS,
    option(
        '-d', '--delay', type=float, default=0.0, metavar='S', help='wait S seconds before playing'
    ),
    flag('-l', '--loop', 'start again at the end'),
    _STORAGE,
)
def play(args: argparse.Namespace) -> None:
    """Play back ROS data from a bag."""
    bag = open_bag(args.bag_path)
    with ros_node(None, 'rosbag2_player') as node:
        player = Player(node, bag, [node.resolve_topic_name(topic) for topic in args.topics])
        wait_for_graph(node)
        wait_for(node, player.connected, CONNECT_S)
        node.get_logger().info(f'Set rate to {args.rate:g}')
        while True:
            time.sleep(args.delay)
            player.play(args.rate)
            if not args.loop:
                return


@verb(
    'bag record',
    option('topics_positional', nargs='*', metavar='TOPIC', help='topics to record'),
    _TOPICS,
    flag('-a', '--all', 'record all topics that are not hidden'),
    option('-o', '--output', help='folder to create (default: named after the time)'),
    _STORAGE,
)
def record(args: argparse.Namespace) -> None:
    """Record ROS data to a bag."""
    topics = [*args.topics_positional, *args.topics]
    if not topics and not args.all:
        raise RuntimeError(
            '[ERROR] [ros2bag]: Need to specify at least one option out of --all, --topics'
        )
    folder = Path(args.output or f'{datetime.now():rosbag2_%Y_%m_%d-%H_%M_%S}')
    if folder.exists():
        raise RuntimeError(f"[ERROR] [ros2bag]: Output folder '{folder}' already exists.")
    # Ctrl-C shuts ROS down, which ends the loop; KeyboardInterrupt could cut off a write.
    signal.signal(signal.SIGINT, lambda *_: None)
    with ros_node(None, 'rosbag2_recorder') as node:
        try:
            folder.mkdir(parents=True)
            bag = _record(node, folder / f'{folder.name}_0.mcap', topics)
        except OSError as error:
            why = f'[ERROR] [ros2bag]: {folder}: {error.strerror or error}'
            raise RuntimeError(why) from None
        finally:
            if folder.is_dir() and not any(folder.iterdir()):
                folder.rmdir()
    if bag is None:
        raise RuntimeError('[WARN] [ros2bag]: No message arrived, so nothing was written.')
    about = {'rosbag2_bagfile_information': bag.metadata()}
    (folder / 'metadata.yaml').write_text(to_yaml(about), encoding='utf-8')


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

"""Implement ``ros2 node``, and the verbs of ``ros2 topic`` that only read the graph."""

import argparse
from collections.abc import Callable
import sys

from roslab.cli_text import node_info_text, topic_info_text, topic_list_text
from roslab.ros2.cli import flag, option, verb
from roslab.ros2.discovery import knowing_node, NODE
from roslab.ros2.graph import (
    entities_of,
    node_known,
    node_names,
    topic_endpoints,
    topic_types,
    topics_of,
)

_TOPIC = option('topic_name', help="Name of the ROS topic, such as '/chatter'")


@verb(
    'node list',
    flag('-a', '--all', 'include hidden nodes'),
    flag('-c', '--count-nodes', 'print only the number of nodes'),
    *NODE,
)
def list_nodes(args: argparse.Namespace) -> None:
    """Output a list of available nodes."""
    with knowing_node(args) as node:
        names = node_names(node, hidden=args.all)
    if args.count_nodes:
        print(len(names))
        return
    if len(set(names)) < len(names):
        print(
            'WARNING: Be aware that there are nodes in the graph that share an exact name, which '
            'can have unintended side effects.',
            file=sys.stderr,
        )
    if names:
        print('\n'.join(names))


@verb(
    'node info',
    option('node_name', help='Fully qualified node name, such as /talker'),
    flag('--include-hidden', 'include hidden topics, services and actions'),
    *NODE,
)
def node_info(args: argparse.Namespace) -> None:
    """Output information about a node."""
    name, hidden = args.node_name, args.include_hidden
    with knowing_node(args, lambda node: node_known(node, name)) as node:
        count = node_names(node, hidden=hidden).count(name)
        if count == 0:
            raise RuntimeError(f"Unable to find node '{name}'")
        if count > 1:
            print(
                f"There are {count} nodes in the graph with the exact name '{name}'. "
                'You are seeing information about only one of them.',
                file=sys.stderr,
            )
        print(node_info_text(name, entities_of(node, name, hidden=hidden)))


@verb(
    'topic list',
    flag('-t', '--show-types', 'print types too'),
    flag('-v', '--verbose', 'print all details'),
    flag('-c', '--count-topics', 'print only the number of topics'),
    option(
        '-a',
        '--include-hidden-topics',
        action='store_true',
        default=argparse.SUPPRESS,
        help='include hidden topics',
    ),
    *NODE,
)
def list_topics(args: argparse.Namespace) -> None:
    """Output a list of available topics."""
    with knowing_node(args) as node:
        topics = topics_of(node, hidden=args.include_hidden_topics)
        if args.count_topics:
            print(len(topics))
        elif args.verbose:
            print(_table('Published', 'publisher', topics, node.count_publishers))
            print(_table('Subscribed', 'subscriber', topics, node.count_subscribers))
        elif topics:
            print(topic_list_text(topics.items(), types=args.show_types))


def _table(
    title: str, role: str, topics: dict[str, list[str]], count: Callable[[str], int]
) -> str:
    """Return the publishers' or subscribers' block of ``-v``, with a final line break."""
    lines = [f'{title} topics:']
    for name, types in topics.items():
        if number := count(name):
            plural = 's' if number > 1 else ''
            lines.append(f' * {name} [{", ".join(types)}] {number} {role}{plural}')
    return '\n'.join(lines) + '\n'


@verb(
    'topic info', _TOPIC, flag('-v', '--verbose', 'print nodes, type hashes, GIDs and QoS'), *NODE
)
def topic_info(args: argparse.Namespace) -> None:
    """Print information about a topic."""
    with knowing_node(args, lambda node: topic_types(node, args.topic_name)) as node:
        types = topic_types(node, args.topic_name)
        if not types:
            raise RuntimeError(f"Unknown topic '{args.topic_name}'")
        ends = topic_endpoints(node, args.topic_name)
        text = topic_info_text(types, *ends, verbose=args.verbose)
        print(text, end='\n\n' if args.verbose else '\n')


@verb('topic type', _TOPIC, *NODE)
def show_type(args: argparse.Namespace) -> None:
    """Print a topic's type."""
    with knowing_node(args, lambda node: topic_types(node, args.topic_name)) as node:
        types = topic_types(node, args.topic_name)
    if not types:
        raise SystemExit(1)
    print('\n'.join(types))

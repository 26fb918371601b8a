"""Implement the verbs of ``ros2 topic`` that only read the graph."""

import argparse
from collections.abc import Callable

from roslab.cli_text import topic_info_text, topic_list_text
from roslab.ros2.cli import flag, option, verb
from roslab.ros2.discovery import knowing_node, NODE
from roslab.ros2.graph import topic_endpoints, topic_types, topics_of

_TOPIC = option('topic_name', help="Name of the ROS topic, such as '/chatter'")


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
def info(args: argparse.Namespace) -> None:
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

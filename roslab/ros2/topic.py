"""Implement ``ros2 topic``: register its verbs, and define those that only read the graph."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence

from roslab.cli_text import topic_info_text, topic_list_text
from roslab.ros2.cli import Outcome, verbs_of
from roslab.ros2.discovery import add_node_arguments, knowing_node, topic_types, topics_of
from roslab.ros2.topic_echo import add_echo_arguments, echo
from roslab.ros2.topic_pub import add_pub_arguments, publish
from roslab.ros2.topic_rate import add_rate_arguments, bw, delay, hz


def add_arguments(group: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    group.add_argument('--include-hidden-topics', action='store_true', help='also hidden topics')
    add = verbs_of(group)
    add_rate_arguments(add('bw', bw, 'Display bandwidth used by topic'), 100)
    add_rate_arguments(add('delay', delay, 'Display delay of topic from timestamp in header'))
    add_echo_arguments(add('echo', echo, 'Output messages from a topic'))
    parser = add('find', find, 'Output a list of available topics of a given type')
    parser.add_argument('topic_type', help="Name of the ROS topic type, 'std_msgs/msg/String'")
    _add_list_arguments(parser)
    parser = add('hz', hz, 'Print the average receiving rate to screen')
    add_rate_arguments(parser)
    parser.add_argument('--wall-time', action='store_true', help='measure with the wall clock')
    parser = add('info', info, 'Print information about a topic')
    parser.add_argument('topic_name', help="Name of the ROS topic to get info, '/chatter'")
    parser.add_argument(
        '-v', '--verbose', action='store_true', help='also nodes, type hashes, GIDs and QoS'
    )
    add_node_arguments(parser)
    parser = add('list', list_topics, 'Output a list of available topics')
    parser.add_argument('-t', '--show-types', action='store_true', help='also the topic type')
    parser.add_argument('-v', '--verbose', action='store_true', help='full details')
    _add_list_arguments(parser)
    add_pub_arguments(add('pub', publish, 'Publish a message to a topic'))
    parser = add('type', show_type, "Print a topic's type")
    parser.add_argument('topic_name', help="Name of the ROS topic, '/chatter'")
    add_node_arguments(parser)


def _add_list_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '-c', '--count-topics', action='store_true', help='only the number of topics'
    )
    parser.add_argument(
        '-a',
        '--include-hidden-topics',
        action='store_true',
        default=argparse.SUPPRESS,
        help='also hidden topics',
    )
    add_node_arguments(parser)


def list_topics(args: argparse.Namespace) -> Outcome:
    """Print the names of the topics."""
    with knowing_node(args) as node:
        topics = topics_of(node, hidden=args.include_hidden_topics)
        if args.count_topics:
            print(len(topics))
        elif args.verbose:
            print(_table('Published', 'publisher', topics, node.count_publishers))
            print(_table('Subscribed', 'subscriber', topics, node.count_subscribers))
        elif topics:
            print(topic_list_text(topics, types=args.show_types))
    return None


def _table(
    title: str,
    role: str,
    topics: Sequence[tuple[str, list[str]]],
    count: Callable[[str], int],
) -> str:
    """Return the publishers' or subscribers' block of ``-v``, with a final line break."""
    lines = [f'{title} topics:']
    for name, types in topics:
        if number := count(name):
            plural = 's' if number > 1 else ''
            lines.append(f' * {name} [{", ".join(types)}] {number} {role}{plural}')
    return '\n'.join(lines) + '\n'


def info(args: argparse.Namespace) -> Outcome:
    """Print types, number of endpoints and, on request, the endpoints of a topic."""
    with knowing_node(args, lambda node: topic_types(node, args.topic_name)) as node:
        types = topic_types(node, args.topic_name)
        if not types:
            return f"Unknown topic '{args.topic_name}'"
        publishers = node.get_publishers_info_by_topic(args.topic_name)
        subscriptions = node.get_subscriptions_info_by_topic(args.topic_name)
        text = topic_info_text(types, publishers, subscriptions, args.verbose)
        print(text, end='\n\n' if args.verbose else '\n')
    return None


def show_type(args: argparse.Namespace) -> Outcome:
    """Print the types of a topic."""
    with knowing_node(args, lambda node: topic_types(node, args.topic_name)) as node:
        types = topic_types(node, args.topic_name)
    if not types:
        return 1
    print('\n'.join(types))
    return None


def find(args: argparse.Namespace) -> Outcome:
    """Print the topics that have a given type."""
    with knowing_node(args) as node:
        topics = topics_of(node, hidden=args.include_hidden_topics)
    found = [name for name, types in topics if args.topic_type in types]
    if args.count_topics:
        print(len(found))
    elif found:
        print('\n'.join(found))
    return None

"""Implement ``ros2 node``."""

from __future__ import annotations

import argparse
import sys

from rclpy.node import Node

from roslab.cli_text import NamesAndTypes, node_info_text
from roslab.ros2.cli import Outcome, verbs_of
from roslab.ros2.discovery import add_node_arguments, knowing_node, node_known, node_names

_SERVICE = '/_action/send_goal'


def add_arguments(group: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    add = verbs_of(group)
    parser = add('info', info, 'Output information about a node')
    parser.add_argument('node_name', help='Fully qualified node name, /talker')
    parser.add_argument(
        '--include-hidden', action='store_true', help='also hidden topics, services and actions'
    )
    add_node_arguments(parser)
    parser = add('list', list_nodes, 'Output a list of available nodes')
    parser.add_argument('-a', '--all', action='store_true', help='also hidden nodes')
    parser.add_argument(
        '-c', '--count-nodes', action='store_true', help='only the number of nodes'
    )
    add_node_arguments(parser)


def list_nodes(args: argparse.Namespace) -> Outcome:
    """Print the names of the nodes."""
    with knowing_node(args) as node:
        names = node_names(node, hidden=args.all)
    if args.count_nodes:
        print(len(names))
        return None
    if len(set(names)) < len(names):
        print(
            'WARNING: Be aware that there are nodes in the graph that share an exact name, which '
            'can have unintended side effects.',
            file=sys.stderr,
        )
    if names:
        print('\n'.join(names))
    return None


def info(args: argparse.Namespace) -> Outcome:
    """Print the topics, services and actions of a node."""
    with knowing_node(args, lambda node: node_known(node, args.node_name)) as node:
        count = node_names(node, hidden=args.include_hidden).count(args.node_name)
        if count == 0:
            return f"Unable to find node '{args.node_name}'"
        if count > 1:
            print(
                f"There are {count} nodes in the graph with the exact name '{args.node_name}'. "
                'You are seeing information about only one of them.',
                file=sys.stderr,
            )
        entities = entities_of(node, args.node_name, hidden=args.include_hidden)
    print(node_info_text(args.node_name, entities))
    return None


def entities_of(node: Node, name: str, *, hidden: bool) -> dict[str, NamesAndTypes]:
    """
    Return the entities of a node, by section of ``ros2 node info``.

    :param node: a node that has discovered the graph
    :param name: full name of the node to describe
    :param hidden: include names with a part that begins with an underscore
    """
    namespace, _, base = name.rpartition('/')
    who = (base, namespace or '/')
    topics = node.get_subscriber_names_and_types_by_node(*who)
    published = node.get_publisher_names_and_types_by_node(*who)
    servers = node.get_service_names_and_types_by_node(*who)
    clients = node.get_client_names_and_types_by_node(*who)
    found: dict[str, NamesAndTypes] = {
        'Subscribers': topics,
        'Publishers': published,
        'Service Servers': servers,
        'Service Clients': clients,
        'Action Servers': _actions(servers, _SERVICE, '_SendGoal'),
        'Action Clients': _actions(clients, _SERVICE, '_SendGoal'),
    }
    if hidden:
        return found
    return {
        section: [(entity, types) for entity, types in entities if '/_' not in entity]
        for section, entities in found.items()
    }


def _actions(services: NamesAndTypes, suffix: str, kind: str) -> NamesAndTypes:
    """Return the actions to which services belong: an action consists of services and topics."""
    return [
        (name.removesuffix(suffix), [one.removesuffix(kind) for one in types])
        for name, types in services
        if name.endswith(suffix)
    ]

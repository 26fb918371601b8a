"""Implement ``ros2 node``."""

import argparse
import sys

from roslab.cli_text import node_info_text
from roslab.ros2.cli import flag, option, verb
from roslab.ros2.discovery import knowing_node, NODE
from roslab.ros2.graph import entities_of, node_known, node_names


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
def info(args: argparse.Namespace) -> None:
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

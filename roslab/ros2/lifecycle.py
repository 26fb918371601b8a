"""Implement ``ros2 lifecycle``."""

import argparse
from collections.abc import Sequence
import sys
from typing import Any

from lifecycle_msgs.srv import ChangeState, GetAvailableTransitions, GetState
from rclpy.node import Node

from roslab.ros2.cli import flag, option, verb
from roslab.ros2.discovery import asking, HIDDEN_NODES, knowing_node, NODE, NODE_NAME
from roslab.ros2.graph import node_names, service_types
from roslab.ros2.service_calls import call, NoAnswer


def _lifecycle_nodes(node: Node, *, hidden: bool) -> list[str]:
    names = dict.fromkeys(node_names(node, hidden=hidden))
    return [name for name in names if _has_lifecycle(node, name)]


def _has_lifecycle(node: Node, name: str) -> bool:
    return bool(service_types(node, f'{name}/get_state'))


@verb(
    'lifecycle nodes',
    flag('-a', '--all', 'include hidden nodes'),
    flag('-c', '--count-nodes', 'print only the number of nodes'),
    *NODE,
)
def nodes(args: argparse.Namespace) -> None:
    """Output a list of nodes with lifecycle."""
    with knowing_node(args) as node:
        names = _lifecycle_nodes(node, hidden=args.all)
    if args.count_nodes:
        print(len(names))
    elif names:
        print('\n'.join(names))


@verb(
    'lifecycle get',
    option('node_name', nargs='?', help='Name of the ROS node'),
    HIDDEN_NODES,
    *NODE,
)
def get(args: argparse.Namespace) -> None:
    """Get lifecycle state for one or more nodes."""
    if args.node_name:
        with asking(args, _has_lifecycle) as (node, name):
            print(_state(node, name))
        return
    with knowing_node(args) as node:
        for name in _lifecycle_nodes(node, hidden=args.include_hidden_nodes):
            try:
                print(f'{name}: {_state(node, name)}', flush=True)
            except NoAnswer as error:
                where = f"Exception while calling service of node '{name}'"
                print(f'{where}: {error}', file=sys.stderr)


def _state(node: Node, name: str) -> str:
    state = call(node, GetState, f'{name}/get_state').current_state
    return f'{state.label} [{state.id}]'


def _transitions(node: Node, name: str, service: str) -> Sequence[Any]:
    return call(node, GetAvailableTransitions, f'{name}/{service}').available_transitions


@verb('lifecycle list', NODE_NAME, flag('-a', '--all', 'include all states'), HIDDEN_NODES, *NODE)
def list_transitions(args: argparse.Namespace) -> None:
    """Output a list of available transitions."""
    service = 'get_transition_graph' if args.all else 'get_available_transitions'
    with asking(args, _has_lifecycle) as (node, name):
        for one in _transitions(node, name, service):
            print(
                f'- {one.transition.label} [{one.transition.id}]\n'
                f'\tStart: {one.start_state.label}\n\tGoal: {one.goal_state.label}'
            )


@verb(
    'lifecycle set',
    NODE_NAME,
    option('transition', help='The lifecycle transition, by name or number'),
    HIDDEN_NODES,
    *NODE,
)
def set_state(args: argparse.Namespace) -> None:
    """Trigger lifecycle state transition."""
    with asking(args, _has_lifecycle) as (node, name):
        known = _transitions(node, name, 'get_available_transitions')
        names = {one.transition.label: one.transition for one in known}
        names |= {str(one.transition.id): one.transition for one in known}
        if args.transition not in names:
            lines = (f'\n- {one.transition.label} [{one.transition.id}]' for one in known)
            raise RuntimeError(
                f'Unknown transition requested, available ones are:{"".join(lines)}'
            )
        wanted = names[args.transition]
        # A transition may take long, for example to open a device.
        if call(node, ChangeState, f'{name}/change_state', 60.0, transition=wanted).success:
            print('Transitioning successful')
        else:
            print('Transitioning failed', file=sys.stderr)

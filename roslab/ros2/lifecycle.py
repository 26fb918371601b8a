"""Implement ``ros2 lifecycle``."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
import sys
from typing import Any

from lifecycle_msgs.srv import ChangeState, GetAvailableTransitions, GetState
from rclpy.node import Node

from roslab.ros2.cli import Outcome, verbs_of
from roslab.ros2.discovery import (
    add_node_arguments,
    asking,
    knowing_node,
    node_names,
    service_types,
)
from roslab.ros2.service_calls import call, NoAnswer


def add_arguments(group: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    add = verbs_of(group)
    parser = add('get', get, 'Get lifecycle state for one or more nodes')
    parser.add_argument('node_name', nargs='?', help='Name of the ROS node')
    _add_common(parser)
    parser = add('list', list_transitions, 'Output a list of available transitions')
    parser.add_argument('node_name', help='Name of the ROS node')
    parser.add_argument('-a', '--all', action='store_true', help='those of all states')
    _add_common(parser)
    parser = add('nodes', nodes, 'Output a list of nodes with lifecycle')
    parser.add_argument('-a', '--all', action='store_true', help='also hidden nodes')
    parser.add_argument('-c', '--count-nodes', action='store_true', help='only their number')
    add_node_arguments(parser)
    parser = add('set', set_state, 'Trigger lifecycle state transition')
    parser.add_argument('node_name', help='Name of the ROS node')
    parser.add_argument('transition', help='The lifecycle transition, by name or number')
    _add_common(parser)


def _add_common(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--include-hidden-nodes', action='store_true', help='also hidden ones')
    add_node_arguments(parser)


def _lifecycle_nodes(node: Node, *, hidden: bool) -> list[str]:
    names = dict.fromkeys(node_names(node, hidden=hidden))
    return [name for name in names if _has_lifecycle(node, name)]


def _has_lifecycle(node: Node, name: str) -> bool:
    return bool(service_types(node, f'{name}/get_state'))


def nodes(args: argparse.Namespace) -> Outcome:
    """Print the names of the lifecycle nodes."""
    with knowing_node(args) as node:
        names = _lifecycle_nodes(node, hidden=args.all)
    if args.count_nodes:
        print(len(names))
    elif names:
        print('\n'.join(names))
    return None


def get(args: argparse.Namespace) -> Outcome:
    """Print the state of one node or of all lifecycle nodes."""
    if args.node_name:
        with asking(args, _has_lifecycle) as (node, name):
            print(_state(node, name))
        return None
    with knowing_node(args) as node:
        for name in _lifecycle_nodes(node, hidden=args.include_hidden_nodes):
            try:
                print(f'{name}: {_state(node, name)}', flush=True)
            except NoAnswer as error:
                where = f"Exception while calling service of node '{name}'"
                print(f'{where}: {error}', file=sys.stderr)
    return None


def _state(node: Node, name: str) -> str:
    state = call(node, GetState, f'{name}/get_state', GetState.Request()).current_state
    return f'{state.label} [{state.id}]'


def _transitions(node: Node, name: str, service: str) -> Sequence[Any]:
    request = GetAvailableTransitions.Request()
    answer = call(node, GetAvailableTransitions, f'{name}/{service}', request)
    return list(answer.available_transitions)


def list_transitions(args: argparse.Namespace) -> Outcome:
    """Print the available transitions of a node."""
    service = 'get_transition_graph' if args.all else 'get_available_transitions'
    with asking(args, _has_lifecycle) as (node, name):
        for one in _transitions(node, name, service):
            print(
                f'- {one.transition.label} [{one.transition.id}]\n'
                f'\tStart: {one.start_state.label}\n\tGoal: {one.goal_state.label}'
            )
    return None


def set_state(args: argparse.Namespace) -> Outcome:
    """Trigger a transition and print its outcome."""
    with asking(args, _has_lifecycle) as (node, name):
        known = _transitions(node, name, 'get_available_transitions')
        wanted = next(
            (
                one.transition
                for one in known
                if args.transition in (one.transition.label, str(one.transition.id))
            ),
            None,
        )
        if wanted is None:
            lines = (f'\n- {one.transition.label} [{one.transition.id}]' for one in known)
            return 'Unknown transition requested, available ones are:' + ''.join(lines)
        request = ChangeState.Request(transition=wanted)
        # A transition may take long, for example to open a device.
        if call(node, ChangeState, f'{name}/change_state', request, 60.0).success:
            print('Transitioning successful')
        else:
            print('Transitioning failed', file=sys.stderr)
    return None

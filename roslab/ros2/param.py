"""Implement ``ros2 param``."""

import argparse
import sys

from rcl_interfaces.msg import Parameter
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.node import Node
from rclpy.parameter import (
    get_parameter_value,
    parameter_dict_from_yaml_file,
    parameter_value_to_python,
)

from roslab.ros2.cli import flag, option, verb
from roslab.ros2.discovery import asking, HIDDEN_NODES, knowing_node, NODE, NODE_NAME
from roslab.ros2.graph import node_names, service_types
from roslab.ros2.service_calls import call

TYPES = (
    'not set',
    'boolean',
    'integer',
    'double',
    'string',
    'byte array',
    'boolean array',
    'integer array',
    'double array',
    'string array',
)
"""Names of the types, by their numbers in ``rcl_interfaces/msg/ParameterType``."""
_NODE = (HIDDEN_NODES, *NODE)
_NAME = option('parameter_name', help='Name of the parameter')


@verb(
    'param list',
    option('node_name', nargs='?', help='Name of the ROS node'),
    option('--param-prefixes', nargs='+', default=[], help='list only these prefixes'),
    flag('--param-type', 'print types too'),
    *_NODE,
)
def list_parameters(args: argparse.Namespace) -> None:
    """Output a list of available parameters."""
    if args.node_name:
        with asking(args) as (node, name):
            _list(args, node, name)
        return
    with knowing_node(args) as node:
        for name in dict.fromkeys(node_names(node, hidden=args.include_hidden_nodes)):
            if service_types(node, f'{name}/list_parameters'):
                _list(args, node, name)


def _list(args: argparse.Namespace, node: Node, name: str) -> None:
    described = []
    try:
        answer = call(
            node, ListParameters, f'{name}/list_parameters', prefixes=args.param_prefixes
        )
        found = sorted(answer.result.names)
        if args.param_type:
            service = f'{name}/describe_parameters'
            described = call(node, DescribeParameters, service, names=found).descriptors
    except RuntimeError as problem:
        print(f"Exception while calling service of node '{name}': {problem}", file=sys.stderr)
        return
    if not args.node_name:
        print(f'{name}:')
    kinds = {one.name: f' (type: {TYPES[one.type]})' for one in described}
    for parameter in found:
        print(f'  {parameter}{kinds.get(parameter, "")}')


@verb('param get', NODE_NAME, _NAME, flag('--hide-type', 'print only the value'), *_NODE)
def get(args: argparse.Namespace) -> None:
    """Get parameter."""
    with asking(args) as (node, name):
        names = [args.parameter_name]
        values = call(node, GetParameters, f'{name}/get_parameters', names=names).values
    if not values:
        raise RuntimeError('Parameter not set')
    kind, value = TYPES[values[0].type], parameter_value_to_python(values[0])
    if args.hide_type or value is None:
        print(value if args.hide_type else 'Parameter not set.')
        return
    word = kind.removesuffix(' array').capitalize()
    print(f'{word} {"value is" if word.lower() == kind else "values are"}: {value}')


@verb(
    'param set', NODE_NAME, _NAME, option('value', help='Value of the parameter, as YAML'), *_NODE
)
def set_parameter(args: argparse.Namespace) -> None:
    """Set parameter."""
    with asking(args) as (node, name):
        parameter = Parameter(name=args.parameter_name, value=get_parameter_value(args.value))
        _set(node, name, [parameter], 'Set parameter', 'Setting parameter')


def _set(node: Node, name: str, parameters: list[Parameter], done: str, refused: str) -> None:
    """
    Set parameters and print the outcomes.

    :param done: words for success, in which ``{}`` stands for the name of the parameter
    :param refused: words for a refusal
    """
    answer = call(node, SetParameters, f'{name}/set_parameters', parameters=parameters)
    for one, result in zip(parameters, answer.results, strict=True):
        reason = f': {result.reason}' if result.reason else ''
        if result.successful:
            print(f'{done.format(one.name)} successful{reason}')
        else:
            print(f'{refused.format(one.name)} failed{reason}', file=sys.stderr)


@verb(
    'param load',
    NODE_NAME,
    option('parameter_file', help='Parameter file'),
    flag('--no-use-wildcard', 'ignore the wildcard section /**'),
    *_NODE,
)
def load(args: argparse.Namespace) -> None:
    """Load parameter file for a node."""
    with asking(args) as (node, name):
        try:
            found = parameter_dict_from_yaml_file(
                args.parameter_file, not args.no_use_wildcard, target_nodes=[name]
            )
        except (OSError, RuntimeError) as problem:
            raise RuntimeError(str(problem)) from None
        _set(node, name, list(found.values()), 'Set parameter {}', 'Set parameter {}')

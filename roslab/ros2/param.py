"""Implement ``ros2 param``."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
import sys
from typing import Any

from rcl_interfaces.msg import Parameter, ParameterDescriptor, ParameterType
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.node import Node
from rclpy.parameter import (
    get_parameter_value,
    parameter_dict_from_yaml_file,
    parameter_value_to_python,
)
import yaml

from roslab.ros2.cli import flag, option, verb
from roslab.ros2.discovery import asking, HIDDEN_NODES, knowing_node, NODE, NODE_NAME
from roslab.ros2.graph import node_names, service_types
from roslab.ros2.service_calls import call

TYPES = {
    ParameterType.PARAMETER_BOOL: ('boolean', 'Boolean value is:'),
    ParameterType.PARAMETER_INTEGER: ('integer', 'Integer value is:'),
    ParameterType.PARAMETER_DOUBLE: ('double', 'Double value is:'),
    ParameterType.PARAMETER_STRING: ('string', 'String value is:'),
    ParameterType.PARAMETER_BYTE_ARRAY: ('byte array', 'Byte values are:'),
    ParameterType.PARAMETER_BOOL_ARRAY: ('boolean array', 'Boolean values are:'),
    ParameterType.PARAMETER_INTEGER_ARRAY: ('integer array', 'Integer values are:'),
    ParameterType.PARAMETER_DOUBLE_ARRAY: ('double array', 'Double values are:'),
    ParameterType.PARAMETER_STRING_ARRAY: ('string array', 'String values are:'),
    ParameterType.PARAMETER_NOT_SET: ('not set', 'Parameter not set.'),
}


_NODE = (HIDDEN_NODES, *NODE)
_NAME = option('parameter_name', help='Name of the parameter')


@verb(
    'param list',
    option('node_name', nargs='?', help='Name of the ROS node'),
    option('--param-prefixes', nargs='+', default=[], help='only with these prefixes'),
    flag('--param-type', 'also their types'),
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
    try:
        found = _names(node, name, args.param_prefixes)
        described = _descriptors(node, name, found) if args.param_type else []
    except RuntimeError as problem:
        print(f"Exception while calling service of node '{name}': {problem}", file=sys.stderr)
        return
    if not args.node_name:
        print(f'{name}:')
    kinds = {one.name: f' (type: {TYPES[one.type][0]})' for one in described}
    for parameter in found:
        print(f'  {parameter}{kinds.get(parameter, "")}')


def _names(node: Node, name: str, prefixes: list[str]) -> list[str]:
    answer = call(node, ListParameters, f'{name}/list_parameters', prefixes=prefixes)
    return sorted(answer.result.names)


def _descriptors(node: Node, name: str, parameters: list[str]) -> list[ParameterDescriptor]:
    answer = call(node, DescribeParameters, f'{name}/describe_parameters', names=parameters)
    return list(answer.descriptors)


@verb('param get', NODE_NAME, _NAME, flag('--hide-type', 'only the value'), *_NODE)
def get(args: argparse.Namespace) -> None:
    """Get parameter."""
    with asking(args) as (node, name):
        names = [args.parameter_name]
        values = call(node, GetParameters, f'{name}/get_parameters', names=names).values
    if not values:
        raise RuntimeError('Parameter not set')
    label, value = TYPES[values[0].type][1], parameter_value_to_python(values[0])
    said = label if value is None else f'{label} {value}'
    print(value if args.hide_type else said)


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
    flag('--no-use-wildcard', 'ignore the part of /**'),
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


@verb(
    'param describe',
    NODE_NAME,
    option('parameter_names', nargs='+', help='Names of the parameters'),
    *_NODE,
)
def describe(args: argparse.Namespace) -> None:
    """Show descriptive information about declared parameters."""
    with asking(args) as (node, name):
        descriptors = _descriptors(node, name, args.parameter_names)
    for one in descriptors:
        print('\n'.join(_description(one)))


def _description(one: ParameterDescriptor) -> Iterator[str]:
    yield f'Parameter name: {one.name}'
    yield f'  Type: {TYPES[one.type][0]}'
    if one.description:
        yield f'  Description: {one.description}'
    yield '  Constraints:'
    if one.read_only:
        yield '    Read only: true'
    for limits in [*one.floating_point_range, *one.integer_range][:1]:
        yield f'    Min value: {limits.from_value}'
        yield f'    Max value: {limits.to_value}'
        if limits.step:
            yield f'    Step: {limits.step}'
    if one.additional_constraints:
        yield f'    Additional constraints: {one.additional_constraints}'


@verb('param dump', NODE_NAME, *_NODE)
def dump(args: argparse.Namespace) -> None:
    """Show all of the parameters of a node in a YAML file format."""
    with asking(args) as (node, name):
        names = _names(node, name, [])
        values = call(node, GetParameters, f'{name}/get_parameters', names=names).values
    parameters: dict[str, Any] = {}
    for parameter, value in zip(names, values, strict=True):
        *groups, last = parameter.split('.')
        place = parameters
        for group in groups:
            place = place.setdefault(group, {})
        place[last] = _plain(parameter_value_to_python(value))
    print(yaml.safe_dump({name: {'ros__parameters': parameters}}, default_flow_style=False))


def _plain(value: Any) -> Any:
    """Return a value as a type that YAML can represent."""
    if isinstance(value, bytes):
        return value.decode('latin-1')
    if isinstance(value, (bool, int, float, str)) or value is None:
        return value
    return [_plain(one) for one in value]

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

from roslab.ros2.cli import Outcome, verbs_of
from roslab.ros2.discovery import (
    add_node_arguments,
    asking,
    knowing_node,
    node_names,
    service_types,
)
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


def add_arguments(group: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    add = verbs_of(group)
    for name, function, words in (
        ('describe', describe, 'Show descriptive information about declared parameters'),
        ('dump', dump, 'Show all of the parameters of a node in a YAML file format'),
        ('get', get, 'Get parameter'),
        ('list', list_parameters, 'Output a list of available parameters'),
        ('load', load, 'Load parameter file for a node'),
        ('set', set_parameter, 'Set parameter'),
    ):
        parser = add(name, function, words)
        nargs = '?' if name == 'list' else None
        parser.add_argument('node_name', nargs=nargs, help='Name of the ROS node')
        parser.add_argument('--include-hidden-nodes', action='store_true', help='also hidden ones')
        add_node_arguments(parser)
        _ADD.get(name, lambda _: None)(parser)


def _add_names(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('parameter_names', nargs='+', help='Names of the parameters')


def _add_get(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('parameter_name', help='Name of the parameter')
    parser.add_argument('--hide-type', action='store_true', help='only the value')


def _add_list(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--param-prefixes', nargs='+', default=[], help='only with these prefixes')
    parser.add_argument('--param-type', action='store_true', help='also their types')


def _add_load(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('parameter_file', help='Parameter file')
    parser.add_argument('--no-use-wildcard', action='store_true', help='ignore the part of /**')


def _add_set(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('parameter_name', help='Name of the parameter')
    parser.add_argument('value', help='Value of the parameter, as YAML')


_ADD = {
    'describe': _add_names,
    'get': _add_get,
    'list': _add_list,
    'load': _add_load,
    'set': _add_set,
}


def list_parameters(args: argparse.Namespace) -> Outcome:
    """Print the parameter names of one node or of all nodes."""
    if args.node_name:
        with asking(args) as (node, name):
            _list(args, node, name)
        return None
    with knowing_node(args) as node:
        for name in dict.fromkeys(node_names(node, hidden=args.include_hidden_nodes)):
            if service_types(node, f'{name}/list_parameters'):
                _list(args, node, name)
    return None


def _list(args: argparse.Namespace, node: Node, name: str) -> None:
    try:
        found = _names(node, name, args.param_prefixes)
        types = _types(node, name, found) if args.param_type else {}
    except RuntimeError as problem:
        print(f"Exception while calling service of node '{name}': {problem}", file=sys.stderr)
        return
    if not args.node_name:
        print(f'{name}:')
    for parameter in found:
        kind = f' (type: {types[parameter]})' if args.param_type else ''
        print(f'  {parameter}{kind}')


def _names(node: Node, name: str, prefixes: list[str]) -> list[str]:
    request = ListParameters.Request(prefixes=prefixes)
    answer = call(node, ListParameters, f'{name}/list_parameters', request)
    return sorted(answer.result.names)


def _descriptors(node: Node, name: str, parameters: list[str]) -> list[ParameterDescriptor]:
    request = DescribeParameters.Request(names=parameters)
    return list(call(node, DescribeParameters, f'{name}/describe_parameters', request).descriptors)


def _types(node: Node, name: str, parameters: list[str]) -> dict[str, str]:
    return {one.name: TYPES[one.type][0] for one in _descriptors(node, name, parameters)}


def _values(node: Node, name: str, parameters: list[str]) -> list[Any]:
    request = GetParameters.Request(names=parameters)
    return list(call(node, GetParameters, f'{name}/get_parameters', request).values)


def get(args: argparse.Namespace) -> Outcome:
    """Print the value of a parameter."""
    with asking(args) as (node, name):
        values = _values(node, name, [args.parameter_name])
    if not values:
        return 'Parameter not set'
    label = TYPES[values[0].type][1]
    if values[0].type == ParameterType.PARAMETER_NOT_SET:
        print(None if args.hide_type else label)
        return None
    value = parameter_value_to_python(values[0])
    print(value if args.hide_type else f'{label} {value}')
    return None


def set_parameter(args: argparse.Namespace) -> Outcome:
    """Set a parameter and print whether the node accepted it; as in Jazzy, both exit with 0."""
    with asking(args) as (node, name):
        parameter = Parameter(name=args.parameter_name, value=get_parameter_value(args.value))
        for _, result in _set(node, name, [parameter]):
            reason = f': {result.reason}' if result.reason else ''
            if result.successful:
                print(f'Set parameter successful{reason}')
            else:
                print(f'Setting parameter failed{reason}', file=sys.stderr)
    return None


def _set(node: Node, name: str, parameters: list[Parameter]) -> list[tuple[str, Any]]:
    request = SetParameters.Request(parameters=parameters)
    answer = call(node, SetParameters, f'{name}/set_parameters', request)
    return [(one.name, result) for one, result in zip(parameters, answer.results, strict=True)]


def load(args: argparse.Namespace) -> Outcome:
    """Set the parameters of a node from a file."""
    with asking(args) as (node, name):
        try:
            found = parameter_dict_from_yaml_file(
                args.parameter_file, not args.no_use_wildcard, target_nodes=[name]
            )
        except (OSError, RuntimeError) as problem:
            return str(problem)
        for parameter, result in _set(node, name, list(found.values())):
            reason = f': {result.reason}' if result.reason else ''
            if result.successful:
                print(f'Set parameter {parameter} successful{reason}')
            else:
                print(f'Set parameter {parameter} failed{reason}', file=sys.stderr)
    return None


def describe(args: argparse.Namespace) -> Outcome:
    """Print the descriptions of parameters."""
    with asking(args) as (node, name):
        descriptors = _descriptors(node, name, args.parameter_names)
    for one in descriptors:
        print('\n'.join(_description(one)))
    return None


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


def dump(args: argparse.Namespace) -> Outcome:
    """Print the parameters of a node as a parameter file."""
    import yaml

    with asking(args) as (node, name):
        names = _names(node, name, [])
        values = _values(node, name, names)
    parameters: dict[str, Any] = {}
    for parameter, value in zip(names, values, strict=True):
        *groups, last = parameter.split('.')
        place = parameters
        for group in groups:
            place = place.setdefault(group, {})
        place[last] = _plain(parameter_value_to_python(value))
    print(yaml.safe_dump({name: {'ros__parameters': parameters}}, default_flow_style=False))
    return None


def _plain(value: Any) -> Any:
    """Return a value as a type that YAML can represent."""
    if isinstance(value, bytes):
        return value.decode('latin-1')
    if isinstance(value, (bool, int, float, str)) or value is None:
        return value
    return [_plain(one) for one in value]

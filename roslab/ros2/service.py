"""Implement ``ros2 service``."""

from __future__ import annotations

import argparse

from roslab.ros2.cli import Outcome, verbs_of
from roslab.ros2.discovery import add_node_arguments, knowing_node, service_types, wait_for
from roslab.ros2.filling import fill, parsed
from roslab.ros2.interface_files import interface_class
from roslab.ros2.service_calls import ANSWER_S, meet


def add_arguments(group: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    add = verbs_of(group)
    parser = add('call', call_service, 'Call a service')
    parser.add_argument('service_name', help="Name of the ROS service, '/add_two_ints'")
    parser.add_argument('service_type', help="Type of the ROS service, 'std_srvs/srv/Empty'")
    parser.add_argument('values', nargs='?', default='{}', help='the request as YAML')
    add_node_arguments(parser)
    parser = add('list', list_services, 'Output a list of available services')
    parser.add_argument('-t', '--show-types', action='store_true', help='also their types')
    parser.add_argument('-c', '--count-services', action='store_true', help='only their number')
    parser.add_argument(
        '-a', '--include-hidden-services', action='store_true', help='also hidden services'
    )
    add_node_arguments(parser)
    parser = add('type', show_type, "Output a service's type")
    parser.add_argument('service_name', help="Name of the ROS service, '/add_two_ints'")
    add_node_arguments(parser)


def list_services(args: argparse.Namespace) -> Outcome:
    """Print the names of the services."""
    with knowing_node(args) as node:
        found = sorted(node.get_service_names_and_types())
    hidden = args.include_hidden_services
    services = [(name, types) for name, types in found if hidden or '/_' not in name]
    if args.count_services:
        print(len(services))
        return None
    for name, types in services:
        print(f'{name} [{", ".join(types)}]' if args.show_types else name)
    return None


def show_type(args: argparse.Namespace) -> Outcome:
    """Print the types of a service."""
    with knowing_node(args, lambda node: service_types(node, args.service_name)) as node:
        types = service_types(node, args.service_name)
    if not types:
        return 1
    print('\n'.join(types))
    return None


def call_service(args: argparse.Namespace) -> Outcome:
    """Call a service and print its response."""
    try:
        kind = interface_class(args.service_type, 'srv')
    except (LookupError, ValueError):
        return 'The passed service type is invalid'
    request = kind.Request()
    try:
        fill(request, parsed(args.values))
    except (AttributeError, TypeError, ValueError, AssertionError) as problem:
        return f'Failed to populate field: {problem}'
    with knowing_node(args) as node:
        client = node.create_client(kind, args.service_name)
        if not client.service_is_ready():
            print('waiting for service to become available...', flush=True)
        wait_for(node, client.service_is_ready, float('inf'))
        print(f'requester: making request: {request!r}\n', flush=True)
        meet(node, client.service_name, ANSWER_S)
        future = client.call_async(request)
        wait_for(node, future.done, float('inf'))
        print(f'response:\n{future.result()!r}\n')
    return None

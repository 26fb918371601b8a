"""Implement ``ros2 service``."""

from __future__ import annotations

import argparse

from roslab.ros2.cli import flag, option, verb
from roslab.ros2.discovery import knowing_node, NODE, wait_for
from roslab.ros2.filling import fill, parsed
from roslab.ros2.graph import is_hidden, service_types
from roslab.ros2.interface_files import interface_class
from roslab.ros2.service_calls import ANSWER_S, meet

_SERVICE = option('service_name', help="Name of the ROS service, '/add_two_ints'")


@verb(
    'service list',
    flag('-t', '--show-types', 'also their types'),
    flag('-c', '--count-services', 'only their number'),
    flag('-a', '--include-hidden-services', 'also hidden services'),
    *NODE,
)
def list_services(args: argparse.Namespace) -> None:
    """Output a list of available services."""
    with knowing_node(args) as node:
        found = sorted(node.get_service_names_and_types())
    services = [one for one in found if args.include_hidden_services or not is_hidden(one[0])]
    if args.count_services:
        print(len(services))
        return
    for name, types in services:
        print(f'{name} [{", ".join(types)}]' if args.show_types else name)


@verb('service type', _SERVICE, *NODE)
def show_type(args: argparse.Namespace) -> None:
    """Output a service's type."""
    with knowing_node(args, lambda node: service_types(node, args.service_name)) as node:
        types = service_types(node, args.service_name)
    if not types:
        raise SystemExit(1)
    print('\n'.join(types))


@verb(
    'service call',
    _SERVICE,
    option('service_type', help="Type of the ROS service, 'std_srvs/srv/Empty'"),
    option('values', nargs='?', default='{}', help='the request as YAML'),
    *NODE,
)
def call_service(args: argparse.Namespace) -> None:
    """Call a service."""
    try:
        kind = interface_class(args.service_type, 'srv')
    except LookupError:
        raise RuntimeError('The passed service type is invalid') from None
    request = kind.Request()
    try:
        fill(request, parsed(args.values))
    except (AttributeError, TypeError, ValueError, AssertionError) as problem:
        raise RuntimeError(f'Failed to populate field: {problem}') from None
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

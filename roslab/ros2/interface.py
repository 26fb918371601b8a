"""Implement ``ros2 interface``."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
import re
import sys

from roslab.ros2.cli import Outcome, verbs_of
from roslab.ros2.interface_files import (
    interface_class,
    interface_file,
    interfaces_of,
    KINDS,
    packages_with_interfaces,
)

_PRIMITIVE = re.compile(r'(bool|byte|char|float32|float64|u?int(8|16|32|64)|w?string)(<=\d+)?')
_CONSTANT = re.compile(r'\S+\s+\w+\s*=')


def add_arguments(group: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    add = verbs_of(group)
    _add_kinds(add('list', list_interfaces, 'List all interface types available'))
    parser = add('package', package, 'Output a list of available interface types of one package')
    parser.add_argument('package_name', help='Name of the ROS package, std_msgs')
    _add_kinds(parser)
    _add_kinds(add('packages', packages, 'Output a list of packages that provide interfaces'))
    parser = add('proto', proto, 'Output an interface prototype')
    parser.add_argument('type', help="Name of the interface, 'std_msgs/msg/String'")
    parser.add_argument('--no-quotes', action='store_true', help='leave the quotes out')
    parser = add('show', show, 'Output the interface definition')
    comments = parser.add_mutually_exclusive_group()
    comments.add_argument('--all-comments', action='store_true', help='also those of parts')
    comments.add_argument('--no-comments', action='store_true', help='no comments, no empty lines')
    parser.add_argument('type', help="'std_msgs/msg/String', or - to read it from stdin")


def _add_kinds(parser: argparse.ArgumentParser) -> None:
    for kind, title in KINDS.items():
        parser.add_argument(
            f'-{kind[0]}',
            f'--only-{kind}s',
            dest='kinds',
            action='append_const',
            const=kind,
            help=f'only {title.lower()}',
        )


def _kinds(args: argparse.Namespace) -> list[str]:
    return args.kinds or list(KINDS)


def list_interfaces(args: argparse.Namespace) -> Outcome:
    """Print all interfaces, grouped by kind."""
    for kind in _kinds(args):
        print(f'{KINDS[kind]}:')
        for name in packages_with_interfaces():
            for interface in interfaces_of(name, [kind]):
                print(f'    {name}/{interface}')
    return None


def package(args: argparse.Namespace) -> Outcome:
    """Print the interfaces of one package."""
    try:
        for interface in interfaces_of(args.package_name, _kinds(args)):
            print(f'{args.package_name}/{interface}')
    except LookupError as problem:
        return problem.args[0]
    return None


def packages(args: argparse.Namespace) -> Outcome:
    """Print the packages that have interfaces."""
    for name in packages_with_interfaces():
        if interfaces_of(name, _kinds(args)):
            print(name)
    return None


def proto(args: argparse.Namespace) -> Outcome:
    """Print an interface with its default values, as a template."""
    from roslab.cli_text import message_yaml

    try:
        interface = interface_class(args.type)
    except (LookupError, ValueError) as problem:
        return problem.args[0]
    for part in ('Request', 'Goal'):
        interface = getattr(interface, part, interface)
    quote = '' if args.no_quotes else '"'
    print(f'{quote}{message_yaml(interface(), truncate=None)}{quote}')
    return None


def show(args: argparse.Namespace) -> Outcome:
    """Print the definition of an interface, including the definitions of nested types."""
    name = args.type
    if name == '-':
        name = sys.stdin.readline().strip()
    top = 'none' if args.no_comments else 'all'
    try:
        for line in definition(name, top, 'all' if args.all_comments else 'none'):
            print(line)
    except (LookupError, ValueError) as problem:
        return problem.args[0]
    return None


def definition(name: str, comments: str, nested: str, depth: int = 0) -> Iterator[str]:
    """
    Yield the lines of a definition; a nested definition follows its field, one tab deeper.

    :param name: name of the interface, such as std_msgs/msg/Header
    :param comments: 'all' or 'none': keep or drop comments and empty lines
    :param nested: the same for nested definitions
    :raises ValueError: if the name is malformed
    :raises LookupError: if there is no such interface
    """
    for line in interface_file(name).read_text(encoding='utf-8').splitlines():
        bare = _without_comment(line)
        text = line.rstrip() if comments == 'all' else bare
        if text or comments == 'all':
            yield '\t' * depth + text if text else ''
        if part := _part(bare, name.split('/')[0]):
            yield from definition(part, nested, nested, depth + 1)


def parts_of(name: str) -> Iterator[str]:
    """
    Yield the full names of the message types in the fields of an interface.

    :param name: such as std_msgs/msg/Header
    :raises LookupError: if there is no such interface
    """
    for line in interface_file(name).read_text(encoding='utf-8').splitlines():
        if part := _part(_without_comment(line), name.split('/')[0]):
            yield part


def _without_comment(line: str) -> str:
    """Return a line without its comment; a # inside a string constant does not start a comment."""
    if re.match(r'\s*w?string(<=\d+)?\s+\w+\s*=', line):
        return line.strip()
    return line.partition('#')[0].strip()


def _part(line: str, package_name: str) -> str:
    """Return the full type name if a line defines a field with a message type, otherwise ''."""
    if not line or line == '---' or _CONSTANT.match(line):
        return ''
    kind = line.split()[0].partition('[')[0]
    if _PRIMITIVE.fullmatch(kind):
        return ''
    parts = kind.split('/')
    return f'{parts[0]}/msg/{parts[-1]}' if len(parts) > 1 else f'{package_name}/msg/{kind}'

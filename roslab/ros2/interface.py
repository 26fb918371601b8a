"""Implement ``ros2 interface``."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
import re
import sys

from roslab.ros2.cli import flag, option, verb
from roslab.ros2.interface_files import (
    interface_file,
    interfaces_of,
    KINDS,
    packages_with_interfaces,
)

_PRIMITIVE = re.compile(r'(bool|byte|char|float32|float64|u?int(8|16|32|64)|w?string)(<=\d+)?')
_CONSTANT = re.compile(r'\S+\s+\w+\s*=')


_PACKAGE = option('package_name', help='Name of the ROS package, std_msgs')
_ONLY = tuple(
    option(
        f'-{kind[0]}',
        f'--only-{kind}s',
        dest='kinds',
        action='append_const',
        const=kind,
        help=f'only {title.lower()}',
    )
    for kind, title in KINDS.items()
)


@verb('interface list', *_ONLY)
def list_interfaces(args: argparse.Namespace) -> None:
    """List all interface types available."""
    for kind in args.kinds or KINDS:
        print(f'{KINDS[kind]}:')
        for name in packages_with_interfaces():
            for interface in interfaces_of(name, [kind]):
                print(f'    {name}/{interface}')


@verb('interface package', _PACKAGE, *_ONLY)
def package(args: argparse.Namespace) -> None:
    """Output a list of available interface types of one package."""
    for interface in interfaces_of(args.package_name, args.kinds or KINDS):
        print(f'{args.package_name}/{interface}')


@verb(
    'interface show',
    flag('--all-comments', 'also those of parts', exclusive=True),
    flag('--no-comments', 'no comments, no empty lines', exclusive=True),
    option('type', help="'std_msgs/msg/String', or - to read it from stdin"),
)
def show(args: argparse.Namespace) -> None:
    """Output the interface definition."""
    name = sys.stdin.readline().strip() if args.type == '-' else args.type
    top = 'none' if args.no_comments else 'all'
    for line in definition(name, top, 'all' if args.all_comments else 'none'):
        print(line)


def definition(name: str, comments: str, nested: str, depth: int = 0) -> Iterator[str]:
    """
    Yield the lines of a definition; a nested definition follows its field, one tab deeper.

    :param name: name of the interface, such as std_msgs/msg/Header
    :param comments: 'all' or 'none': keep or drop comments and empty lines
    :param nested: the same for nested definitions
    :raises InterfaceError: if there is no such interface
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

    :raises InterfaceError: if there is no such interface
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

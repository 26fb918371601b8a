"""Find installed interfaces and their definitions, and implement ``ros2 interface``."""

import argparse
from collections.abc import Iterable, Iterator
from importlib import import_module
import json
from pathlib import Path
import re
import sys
from typing import Any

from ament_index_python.packages import get_package_share_directory, PackageNotFoundError
from ament_index_python.resources import get_resource, get_resources

from roslab.ros2.cli import flag, option, verb

KINDS = {'msg': 'Messages', 'srv': 'Services', 'action': 'Actions'}
_SEPARATOR = '=' * 80
_PRIMITIVE = re.compile(r'(bool|byte|char|float32|float64|u?int(8|16|32|64)|w?string)(<=\d+)?')
_CONSTANT = re.compile(r'\S+\s+\w+\s*=')


class InterfaceError(LookupError, RuntimeError):
    """Raised if an interface or its package is not installed; ``ros2`` prints it as one line."""


def packages_with_interfaces() -> list[str]:
    """Return the names of all packages that have interfaces, sorted."""
    return sorted(get_resources('rosidl_interfaces'))


def interfaces_of(package: str, kinds: Iterable[str] = KINDS) -> list[str]:
    """Return the sorted interfaces of a package, such as msg/String; InterfaceError for none."""
    try:
        text, _ = get_resource('rosidl_interfaces', package)
    except LookupError:
        raise InterfaceError(f"Unknown package '{package}'") from None
    wanted = tuple(f'{kind}/' for kind in kinds)
    return sorted(
        {
            line.rpartition('.')[0]
            for line in text.splitlines()
            # The index also lists several generated files per interface and the parts of services.
            if line.endswith(('.msg', '.srv', '.action')) and line.startswith(wanted)
        }
    )


def interface_file(name: str) -> Path:
    """Return the file that defines an interface; InterfaceError if the name has none."""
    parts = name.split('/')
    if len(parts) != 3 or not all(parts):
        raise InterfaceError(f"Invalid name '{name}'. Expected three parts separated by '/'")
    package, kind, interface = parts
    try:
        share = Path(get_package_share_directory(package))
    except (PackageNotFoundError, ValueError):
        raise InterfaceError(f"Unknown package '{package}'") from None
    path = share / kind / f'{interface}.{kind}'
    if not path.is_file():
        raise InterfaceError(f"Could not find the interface '{path}'")
    return path


def interface_class(name: str) -> Any:
    """
    Return the Python class of an interface.

    :param name: name of the interface, such as std_msgs/msg/String or std_msgs/String
    :raises InterfaceError: if the name is malformed or the class cannot be imported
    """
    parts = name.split('/')
    if len(parts) == 2:
        parts.insert(1, 'msg')
    if len(parts) != 3 or not all(parts):
        raise InterfaceError(f"'{name}' is not an interface name such as std_msgs/msg/String")
    try:
        return getattr(import_module(f'{parts[0]}.{parts[1]}'), parts[2])
    except (ImportError, AttributeError) as error:
        raise InterfaceError(f"'{name}' cannot be imported: {error}") from None


_PACKAGE = option('package_name', help='Name of the ROS package, such as std_msgs')
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
    flag('--all-comments', 'include comments of nested types', exclusive=True),
    flag('--no-comments', 'omit comments and empty lines', exclusive=True),
    option('type', help="such as 'std_msgs/msg/String', or - for stdin"),
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
    """Yield the full names of the message types in the fields of an interface."""
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


def definition_of(name: str) -> str:
    """Return the definition of a message type and its parts; LookupError if one is missing."""
    texts: dict[str, str] = {}
    waiting = [name]
    while waiting:
        one = waiting.pop(0)
        if one not in texts:
            texts[one] = interface_file(one).read_text(encoding='utf-8')
            waiting += parts_of(one)
    own = texts.pop(name)
    parts = (
        f'{_SEPARATOR}\nMSG: {part.replace("/msg/", "/")}\n{text}' for part, text in texts.items()
    )
    return '\n'.join([own, *parts])


def hash_of(name: str) -> str:
    """
    Return the hash of a message type, which changes with its fields but not with its comments.

    :returns: such as ``RIHS01_df66...``, or ``''`` if the package was built without hashes
    :raises LookupError: if the type is not installed
    """
    file = interface_file(name).with_suffix('.json')
    if not file.is_file():
        return ''
    hashes = json.loads(file.read_text(encoding='utf-8'))['type_hashes']
    return next((one['hash_string'] for one in hashes if one['type_name'] == name), '')

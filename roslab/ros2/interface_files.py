"""Find installed interfaces: their names, files and Python classes."""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import Any

from ament_index_python.packages import get_package_share_directory, PackageNotFoundError
from ament_index_python.resources import get_resource, get_resources

KINDS = {'msg': 'Messages', 'srv': 'Services', 'action': 'Actions'}


class InterfaceError(LookupError, RuntimeError):
    """An interface or its package that is not installed; ``ros2`` prints it as one line."""


def packages_with_interfaces() -> list[str]:
    """Return the names of all packages that have interfaces, sorted."""
    return sorted(get_resources('rosidl_interfaces'))


def interfaces_of(package: str, kinds: Iterable[str] = KINDS) -> list[str]:
    """
    Return the interfaces of a package, such as msg/String, sorted.

    :param kinds: which of msg, srv and action to include
    :raises InterfaceError: if the package does not exist or has no interfaces
    """
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
    """
    Return the path of the file that defines an interface.

    :raises InterfaceError: if the name is malformed, or there is no such package or interface
    """
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


def interface_class(name: str, kind: str = 'msg') -> Any:
    """
    Return the Python class of an interface.

    :param name: name of the interface, such as std_msgs/msg/String or std_msgs/String
    :param kind: the middle part to use if the name has only two parts
    :raises InterfaceError: if the name is malformed or the class cannot be imported
    """
    parts = name.split('/')
    if len(parts) == 2:
        parts.insert(1, kind)
    if len(parts) != 3 or not all(parts):
        raise InterfaceError(f"'{name}' is no interface name such as std_msgs/msg/String")
    try:
        return getattr(import_module(f'{parts[0]}.{parts[1]}'), parts[2])
    except (ImportError, AttributeError) as error:
        raise InterfaceError(f"'{name}' cannot be imported: {error}") from None

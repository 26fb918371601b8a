"""Implement ``ros2 pkg`` and ``ros2 run``."""

import argparse
import os
from pathlib import Path
import shlex

from ament_index_python.packages import (
    get_package_prefix,
    get_packages_with_prefixes,
    PackageNotFoundError,
)

from roslab.ros2.cli import flag, option, verb


class PackageMissingError(RuntimeError):
    """Raised if no installed package has the given name."""

    def __init__(self) -> None:
        super().__init__('Package not found')


_PACKAGE = option('package_name', help='Name of the ROS package')


def prefix_of(package: str) -> Path:
    """Return the folder of an installed package; PackageMissingError if it is not installed."""
    try:
        return Path(get_package_prefix(package))
    except (PackageNotFoundError, ValueError):
        raise PackageMissingError from None


def executables_of(package: str) -> list[Path]:
    """Return the programs of a package that ``ros2 run`` can start, sorted."""
    folder = prefix_of(package) / 'lib' / package
    return sorted(
        path for path in folder.rglob('*') if path.is_file() and os.access(path, os.X_OK)
    )


@verb(
    'pkg executables',
    option('package_name', nargs='?', help='Name of the ROS package'),
    flag('--full-path', 'print full paths'),
)
def executables(args: argparse.Namespace) -> None:
    """Output a list of package specific executables."""
    names = [args.package_name] if args.package_name else sorted(get_packages_with_prefixes())
    for name in names:
        for path in executables_of(name):
            print(path if args.full_path else f'{name} {path.name}')


@verb('pkg list')
def list_packages(_: argparse.Namespace) -> None:
    """Output a list of available packages."""
    print('\n'.join(sorted(get_packages_with_prefixes())))


@verb('pkg prefix', _PACKAGE, flag('--share', 'print its folder for shared files'))
def prefix(args: argparse.Namespace) -> None:
    """Output the prefix path of a package."""
    path = prefix_of(args.package_name)
    print(path / 'share' / args.package_name if args.share else path)


def executable_of(package: str, name: str) -> Path | None:
    """Return a program of a package, else None; RuntimeError if the package is not installed."""
    try:
        found = executables_of(package)
    except PackageMissingError:
        raise RuntimeError(f"Package '{package}' not found") from None
    return next((path for path in found if path.name == name), None)


@verb(
    'run',
    option('--prefix', help="command to put in front, such as 'gdb -ex run --args'"),
    _PACKAGE,
    option('executable_name', help='Name of the executable'),
    option('argv', nargs=argparse.REMAINDER, help='arguments of the executable, --ros-args ...'),
)
def run(args: argparse.Namespace) -> None:
    """Replace this process with the executable, which then gets Ctrl-C and sets the exit code."""
    path = executable_of(args.package_name, args.executable_name)
    if path is None:
        raise RuntimeError('No executable found')
    command = [*shlex.split(args.prefix or ''), str(path), *args.argv]
    try:
        os.execvp(command[0], command)
    except OSError as error:
        raise RuntimeError(f'{command[0]}: {error.strerror}') from None

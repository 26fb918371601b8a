"""Implement ``ros2 pkg``."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from ament_index_python.packages import (
    get_package_prefix,
    get_packages_with_prefixes,
    PackageNotFoundError,
)

from roslab.ros2.cli import Outcome, verbs_of


class PackageMissingError(RuntimeError):
    """Raised if no installed package has the given name."""

    def __init__(self) -> None:
        super().__init__('Package not found')


def add_arguments(group: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    from roslab.ros2.pkg_create import add_create_arguments, create

    add = verbs_of(group)
    add_create_arguments(add('create', create, 'Create a new ROS 2 package'))
    parser = add('executables', executables, 'Output a list of package specific executables')
    parser.add_argument('package_name', nargs='?', help='Name of the ROS package')
    parser.add_argument('--full-path', action='store_true', help='their full paths')
    add('list', list_packages, 'Output a list of available packages')
    parser = add('prefix', prefix, 'Output the prefix path of a package')
    parser.add_argument('package_name', help='Name of the ROS package')
    parser.add_argument('--share', action='store_true', help='its folder for shared files')
    parser = add('xml', xml, 'Output the XML of the package manifest or a specific tag')
    parser.add_argument('package_name', help='Name of the ROS package')
    parser.add_argument('-t', '--tag', help='only the text of this tag, version')


def prefix_of(package: str) -> Path:
    """
    Return the folder in which a package is installed.

    :raises PackageMissingError: if the package is not installed
    """
    try:
        return Path(get_package_prefix(package))
    except (PackageNotFoundError, ValueError):
        raise PackageMissingError from None


def executables_of(package: str) -> list[Path]:
    """
    Return the programs of a package that ``ros2 run`` can start, sorted.

    :raises PackageMissingError: if the package is not installed
    """
    folder = prefix_of(package) / 'lib' / package
    return sorted(
        path for path in folder.rglob('*') if path.is_file() and os.access(path, os.X_OK)
    )


def executables(args: argparse.Namespace) -> Outcome:
    """Print the programs of one package or of all packages."""
    names = [args.package_name] if args.package_name else sorted(get_packages_with_prefixes())
    for name in names:
        for path in executables_of(name):
            print(path if args.full_path else f'{name} {path.name}')
    return None


def list_packages(args: argparse.Namespace) -> Outcome:
    """Print the names of the installed packages."""
    print('\n'.join(sorted(get_packages_with_prefixes())))
    return None


def prefix(args: argparse.Namespace) -> Outcome:
    """Print the folder in which a package is installed."""
    path = prefix_of(args.package_name)
    print(path / 'share' / args.package_name if args.share else path)
    return None


def xml(args: argparse.Namespace) -> Outcome:
    """Print the manifest of a package, or the text of one of its tags."""
    from xml.etree import ElementTree

    path = prefix_of(args.package_name) / 'share' / args.package_name / 'package.xml'
    text = path.read_text(encoding='utf-8')
    if args.tag is None:
        print(text.rstrip('\n'))
        return None
    tags = [found.text or '' for found in ElementTree.fromstring(text).iter(args.tag)]
    if not tags:
        return f"No tag '{args.tag}' found in '{path}'"
    print('\n'.join(tags))
    return None

"""Implement ``ros2 run``."""

from __future__ import annotations

import argparse
import os
import shlex

from roslab.ros2.cli import Outcome
from roslab.ros2.pkg import executables_of, PackageMissingError


def add_arguments(group: argparse.ArgumentParser) -> None:
    """Add the options; this command has no verbs."""
    group.add_argument('--prefix', help="command to put in front, such as 'gdb -ex run --args'")
    group.add_argument('package_name', help='Name of the ROS package')
    group.add_argument('executable_name', help='Name of the executable')
    group.add_argument(
        'argv', nargs=argparse.REMAINDER, help='arguments of the executable, --ros-args ...'
    )
    group.set_defaults(verb=run)


def run(args: argparse.Namespace) -> Outcome:
    """Replace this process with the executable, which then gets Ctrl-C and sets the exit code."""
    try:
        found = executables_of(args.package_name)
    except PackageMissingError:
        return f"Package '{args.package_name}' not found"
    path = next((path for path in found if path.name == args.executable_name), None)
    if path is None:
        return 'No executable found'
    command = [*shlex.split(args.prefix or ''), str(path), *args.argv]
    try:
        os.execvp(command[0], command)
    except OSError as error:
        return f'{command[0]}: {error.strerror}'

"""Implement ``ros2 daemon``, which reports that there is no daemon."""

import argparse

from roslab.ros2.cli import verb

_WHY = 'this ros2 has none; each command discovers the graph itself'


@verb('daemon status')
def status(_: argparse.Namespace) -> None:
    """Output the status of the daemon."""
    print(f'The daemon is not running: {_WHY}')


@verb('daemon stop')
def stop(args: argparse.Namespace) -> None:
    """Stop the daemon if it is running."""
    status(args)


@verb('daemon start')
def start(_: argparse.Namespace) -> None:
    """Start the daemon if it is not running."""
    raise RuntimeError(f'The daemon cannot be started: {_WHY}')

"""Implement ``ros2 daemon``, which reports that there is no daemon."""

from __future__ import annotations

import argparse

from roslab.ros2.cli import Outcome, verbs_of

_WHY = 'this ros2 has none, each command looks at the graph itself'


def add_arguments(group: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    add = verbs_of(group)
    add('start', start, 'Start the daemon if it is not running')
    add('status', status, 'Output the status of the daemon')
    add('stop', stop, 'Stop the daemon if it is running')


def status(args: argparse.Namespace) -> Outcome:
    """Print that the daemon is not running."""
    print(f'The daemon is not running: {_WHY}')
    return None


def stop(args: argparse.Namespace) -> Outcome:
    """Print that the daemon is not running; there is nothing to stop."""
    return status(args)


def start(args: argparse.Namespace) -> Outcome:
    """Fail: there is no daemon to start."""
    return f'The daemon cannot be started: {_WHY}'

"""
Parse the command line of ``ros2``, run the verb and report its result.

A verb is a function of the parsed arguments.  Its return value decides the exit of ``ros2``: None
or 0 for success, another number as the exit code, a string as an error on stderr with exit code 1.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from importlib import import_module
import os
import signal
import sys
from typing import NoReturn

Outcome = int | str | None
Verb = Callable[[argparse.Namespace], Outcome]
AddVerb = Callable[[str, Verb, str], argparse.ArgumentParser]

ABOUT = (
    "The course's own small ros2 command: the same verbs, options and output as ROS 2 Jazzy's. "
    'Where a full installation of ROS 2 is in use, its own ros2 comes first.'
)
GROUPS = {
    'bag': 'Various rosbag related sub-commands',
    'daemon': 'Tell about the daemon (this command has none)',
    'interface': 'Show information about ROS interfaces',
    'launch': 'Run a launch file',
    'lifecycle': 'Various lifecycle related sub-commands',
    'node': 'Various node related sub-commands',
    'param': 'Various param related sub-commands',
    'pkg': 'Various package related sub-commands',
    'run': 'Run a package specific executable',
    'service': 'Various service related sub-commands',
    'topic': 'Various topic related sub-commands',
}
ELSEWHERE = ('action', 'component', 'control', 'doctor', 'multicast', 'security')
"""Commands of a full installation that are not here, to be told from typing mistakes."""
SHUT_DOWN = ('the given context is not valid', "rcl node's context is invalid")
"""Parts of rcl's errors after Ctrl-C or SIGTERM, which alone shut down early."""


def build_parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """
    Return the parser; only the group that the arguments name is complete.

    :param arguments: the arguments after ``ros2``
    """
    parser = argparse.ArgumentParser(
        prog='ros2',
        description=ABOUT,
        epilog='Call `ros2 <command> -h` for more detailed usage.',
    )
    # Options of the real ros2 that have no effect here.
    parser.add_argument('--use-python-default-buffering', action='store_true', help='no effect')
    groups = parser.add_subparsers(title='Commands', metavar='<command>', dest='command')
    chosen = next((word for word in arguments if not word.startswith('-')), '')
    for name, words in GROUPS.items():
        group = groups.add_parser(name, help=words, description=words)
        group.set_defaults(verb=None, help_of=group)
        if name == chosen:
            import_module(f'roslab.ros2.{name}').add_arguments(group)
    return parser


def verbs_of(group: argparse.ArgumentParser) -> AddVerb:
    """
    Return a function that adds a verb to a group of commands.

    :param group: the parser of the group, such as that of ``ros2 topic``
    """
    name = group.prog.split()[-1]
    verbs = group.add_subparsers(title='Verbs', metavar='<verb>')
    group.epilog = f'Call `ros2 {name} <verb> -h` for more detailed usage.'

    def add(verb: str, function: Verb, words: str) -> argparse.ArgumentParser:
        parser: argparse.ArgumentParser = verbs.add_parser(verb, help=words, description=words)
        parser.set_defaults(verb=function)
        return parser

    return add


def main(arguments: Sequence[str]) -> Outcome:
    """Parse the arguments, run the verb and return its result."""
    if arguments and arguments[0] in ELSEWHERE:
        return (
            f"ros2 {arguments[0]} belongs to a full installation of ROS 2. The course's own ros2 "
            f'has: {", ".join(GROUPS)}'
        )
    parser = build_parser(arguments)
    parsed = parser.parse_args(arguments)
    if parsed.command is None or parsed.verb is None:
        (parser if parsed.command is None else parsed.help_of).print_help()
        return 0
    verb: Verb = parsed.verb
    if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return verb(parsed)
    except KeyboardInterrupt:
        return int(signal.SIGINT)
    except Exception as problem:
        # After Ctrl-C has shut the context down, an exception from rclpy is not the user's error.
        if type(problem).__name__ == 'ExternalShutdownException' or any(
            part in str(problem) for part in SHUT_DOWN
        ):
            return int(signal.SIGINT)
        if isinstance(problem, RuntimeError):
            return str(problem)
        raise


def run_command(arguments: Sequence[str]) -> NoReturn:
    """Run the command and exit as ``ros2`` does, without a traceback."""
    try:
        try:
            outcome = main(arguments)
            if isinstance(outcome, str):
                print(outcome, file=sys.stderr)
        finally:
            sys.stdout.flush()
    except BrokenPipeError:
        # The reader, such as head, has closed the pipe.  Keep Python from reporting that again at
        # exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        outcome = None
    except KeyboardInterrupt:
        outcome = int(signal.SIGINT)
    sys.exit(1 if isinstance(outcome, str) else outcome)

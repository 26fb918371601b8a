"""
Parse the command line of ``ros2``, run the verb and report its result.

:func:`verb` adds a function and its options to the table of verbs.  The function gets the parsed
arguments and prints its result; its RuntimeError becomes one line on stderr and exit code 1.
``ros2 daemon`` only reports that this command has none.
"""

import argparse
from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
import os
import signal
import sys
from typing import Any, NamedTuple, NoReturn

Outcome = int | str | None
"""Exit code of ``ros2``; a string is an error for stderr, with exit code 1."""
Run = Callable[[argparse.Namespace], None]


class Option(NamedTuple):
    """Arguments of ``add_argument``, and whether the option excludes the other exclusive ones."""

    names: tuple[str, ...]
    how: dict[str, Any]
    exclusive: bool = False


ABOUT = (
    "The course's own small ros2 command: the same verbs, options and output as ROS 2 Jazzy's. "
    'If ROS 2 is fully installed, its own ros2 command is used instead.'
)
GROUPS = {
    'bag': 'Various rosbag related sub-commands',
    'daemon': 'Report on the daemon (this command has none)',
    'interface': 'Show information about ROS interfaces',
    'launch': 'Run a launch file',
    'lifecycle': 'Various lifecycle related sub-commands',
    'node': 'Various node related sub-commands',
    'param': 'Various param related sub-commands',
    'pkg': 'Various package related sub-commands',
    'run': 'Run a package specific executable',
    'topic': 'Various topic related sub-commands',
}
MODULES: dict[str, tuple[str, ...]] = {
    'daemon': (),
    'node': ('topic',),
    'run': ('pkg',),
    'topic': ('topic', 'topic_echo', 'topic_pub'),
}
"""Modules of the groups whose verbs are not in a single module with the group's name."""
ELSEWHERE = ('action', 'component', 'control', 'doctor', 'multicast', 'security', 'service')
"""Commands that only a full installation has, to distinguish them from typing mistakes."""
SHUT_DOWN = ('the given context is not valid', "rcl node's context is invalid")
"""Parts of rcl's errors after Ctrl-C or SIGTERM; nothing else shuts a context down early."""

_NO_DAEMON = 'this ros2 has none; each command discovers the graph itself'

_verbs: dict[str, tuple[Run, Sequence[Option]]] = {}
"""The verbs of the imported modules by name, such as ``topic list``."""


def verb(name: str, *options: Option) -> Callable[[Run], Run]:
    """
    Return a decorator that adds a verb to the table; the function's docstring is the help.

    :param name: group and verb, such as ``topic list``, or the name of a command without verbs
    """

    def add(run: Run) -> Run:
        _verbs[name] = run, options
        return run

    return add


def option(*names: str, exclusive: bool = False, **how: Any) -> Option:
    """Return an argument; ``how`` contains keyword arguments of argparse's ``add_argument``."""
    return Option(names, how, exclusive)


def flag(*names_and_words: str, exclusive: bool = False) -> Option:
    """Return an option without a value; the last argument is its help text."""
    *names, words = names_and_words
    return option(*names, exclusive=exclusive, action='store_true', help=words)


@verb('daemon status')
def daemon_status(_: argparse.Namespace) -> None:
    """Output the status of the daemon."""
    print(f'The daemon is not running: {_NO_DAEMON}')


@verb('daemon stop')
def daemon_stop(args: argparse.Namespace) -> None:
    """Stop the daemon if it is running."""
    daemon_status(args)


@verb('daemon start')
def daemon_start(_: argparse.Namespace) -> None:
    """Start the daemon if it is not running."""
    raise RuntimeError(f'The daemon cannot be started: {_NO_DAEMON}')


def positive_float(text: str) -> float:
    """Parse a number greater than zero; for argparse."""
    if not (number := float(text)) > 0:
        raise ValueError
    return number


def positive_int(text: str) -> int:
    """Parse an integer greater than zero; for argparse."""
    if (number := int(text)) <= 0:
        raise argparse.ArgumentTypeError('value must be a positive integer')
    return number


def natural(text: str) -> int:
    """Parse an integer of zero or more; for argparse."""
    if (number := int(text)) < 0:
        raise ValueError
    return number


def build_parser(arguments: Sequence[str]) -> argparse.ArgumentParser:
    """Return the parser; only the group that the arguments name is complete."""
    epilog = 'Call `ros2 <command> -h` for more detailed usage.'
    parser = argparse.ArgumentParser(prog='ros2', description=ABOUT, epilog=epilog)
    # Options of the real ros2 that have no effect here.
    parser.add_argument('--use-python-default-buffering', action='store_true', help='no effect')
    groups = parser.add_subparsers(title='Commands', metavar='<command>', dest='command')
    chosen = next((word for word in arguments if not word.startswith('-')), '')
    for name, words in GROUPS.items():
        group = groups.add_parser(name, help=words, description=words)
        group.set_defaults(verb=None, help_of=group)
        if name == chosen:
            for module in MODULES.get(name, (name,)):
                import_module(f'roslab.ros2.{module}')
            _complete(group, name)
    return parser


def _complete(group: argparse.ArgumentParser, name: str) -> None:
    """Add the verbs of a group, or the options of a command without verbs."""
    if name in _verbs:
        _add_options(group, *_verbs[name])
        return
    if name == 'topic':
        group.add_argument(
            '--include-hidden-topics', action='store_true', help='include hidden topics'
        )
    group.epilog = f'Call `ros2 {name} <verb> -h` for more detailed usage.'
    verbs = group.add_subparsers(title='Verbs', metavar='<verb>')
    for full, (run, options) in sorted(_verbs.items()):
        if full.startswith(f'{name} '):
            words = (run.__doc__ or '').rstrip('.')
            parser = verbs.add_parser(full.split()[1], help=words, description=words)
            _add_options(parser, run, options)


def _add_options(parser: argparse.ArgumentParser, run: Run, options: Iterable[Option]) -> None:
    parser.set_defaults(verb=run)
    exclusive = None
    for names, how, excludes in options:
        if excludes:
            exclusive = exclusive or parser.add_mutually_exclusive_group()
        (exclusive if excludes and exclusive else parser).add_argument(*names, **how)


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
    if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        parsed.verb(parsed)
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
    return None


def run_command(arguments: Sequence[str]) -> NoReturn:
    """Run the command and exit as ``ros2`` does, without a traceback."""
    outcome: Outcome = None
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

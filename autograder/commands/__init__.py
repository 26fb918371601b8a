"""Commands of ``autograder``; this module defines exit codes and shared options."""

import argparse
from collections.abc import Callable
import json
from pathlib import Path
from typing import Any, TypeVar

OK = 0
"""The command succeeded; after ``grade``, every submission has a verdict."""
FOR_REVIEW = 1
"""The command finished, but some work is for review, was left out or failed a self-check."""
USAGE = 2
"""The command failed: wrong arguments, or a fault of the grader."""
STOPPED = 130
"""The user stopped the command with Ctrl-C: 128 plus the number of SIGINT."""
UNREAD = 141
"""The reader closed the output early, as in ``... | head``: 128 plus the number of SIGPIPE."""

Command = TypeVar('Command', bound=Callable[..., Any])
Option = Callable[[argparse.ArgumentParser], object]
"""Function that adds one or more arguments to the parser of a command."""


def option(name: str, text: str, **facts: Any) -> Option:
    """Return a function that adds an argument, with the ``facts`` of ``add_argument``."""
    return lambda parser: parser.add_argument(name, help=text, **facts)


def flag(name: str, text: str) -> Option:
    """Return an option without a value; it is True if given, else False."""
    return option(name, text, action='store_true')


def takes(*options: Option) -> Callable[[Command], Command]:
    """Attach options to the function of a command; :func:`describe` reads them."""

    def declare(run: Command) -> Command:
        vars(run)['options'] = options
        return run

    return declare


def describe(parser: argparse.ArgumentParser, run: Callable[..., Any], *more: Option) -> None:
    """Add a command's options and ``more`` to its parser."""
    for add in (*vars(run)['options'], *more):
        add(parser)


def show(as_json: bool, data: Any, text: str) -> None:
    """Print the result of a command, as JSON or as text."""
    print(json.dumps(data) if as_json else text)


STUDENT = option('student', 'id or name of the student', metavar='STUDENT')
ASSIGNMENT = option('assignment', 'assignment', metavar='ASSIGNMENT')
ASSIGNMENT_OR_ALL = option(
    'assignment', 'assignment (default: all graded assignments)', nargs='?', metavar='ASSIGNMENT'
)
SUBMITTED = option('--submitted', 'folder of submissions (see grade)', type=Path, metavar='DIR')
TO_SUBMITTED = option(
    '--to', 'folder to write to (default: autograder/_work/submitted)', type=Path, metavar='DIR'
)
VISIBLE = flag('--visible', 'run only the visible checks')
FRESH = flag('--fresh', 'run every program again, even if its recording is stored')
JSON = flag('--json', 'print the result as JSON')
YES = flag(
    '--yes', 'lower or clear marks in the gradebook; without --yes, such marks are only listed'
)

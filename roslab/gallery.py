"""
Explain errors: find the entry in the gallery of lesson 08 that matches an error message.

The entries are data in ``gallery.yaml``.  Build errors are also looked up in the table that
``build_messages`` uses.
"""

import builtins
from collections.abc import Sequence
from functools import cache
from pathlib import Path
import pkgutil
import re
import sys
import textwrap
import traceback
from typing import NamedTuple

import yaml

from autograder.judging.causes.builds import diagnose, texts_of
from roslab.error_hints import advice_shown
from roslab.errors import RoslabError
from roslab.package_files import learner_package

LESSON = '08_what_went_wrong'
FILE = Path(__file__).with_name('gallery.yaml')
_MOST = 3
_NO_MODULE = re.compile(r"No module named '(\w{4,60})'")
"""Shorter names differ by one letter from too many other names."""
_MANUAL = 'docs.python.org/3/library/exceptions.html'
_OF_ROS = re.compile(r'\b(?:rcl|rmw|rosidl)')
_WIDTH = 96
_FURTHER = (
    'Read the last line of the message, then the lowest line that is your own.',
    'Search the issues of github.com/ros2/rclpy and robotics.stackexchange.com for the words '
    'between your own names, in quotes.',
    f'How to ask others well: lesson {LESSON}, "Asking others".',
)


class Entry(NamedTuple):
    """
    One error of the gallery.

    :param key: name of the entry and id of the cell in lesson 08 that makes the mistake
    :param patterns: regular expressions that match an error message or a description of a symptom
    """

    key: str
    heading: str
    patterns: Sequence[str]
    cause: str
    repair: str

    def matched(self, text: str) -> int:
        """Return the length of the match in a text with single spaces, 0 if there is no match."""
        found = (re.search(pattern, text, re.IGNORECASE) for pattern in self.patterns)
        return max((len(match.group()) for match in found if match), default=0)


@cache
def entries() -> tuple[Entry, ...]:
    """Return the entries of the gallery in the order in which lesson 08 shows them."""
    rows = yaml.safe_load(FILE.read_text(encoding='utf-8'))
    return tuple(Entry(*(row[field] for field in Entry._fields)) for row in rows)


def nearest(text: str) -> list[Entry]:
    """Return the entries that match a message, best match first."""
    line = ' '.join(text.split())
    found = [(entry.matched(line), entry) for entry in entries()]
    found = sorted((pair for pair in found if pair[0]), key=lambda pair: -pair[0])
    return [entry for _, entry in found[:_MOST]]


def explain(error: str | BaseException | None = None) -> None:
    """
    Print what an error means, how to fix it, and where lesson 08 shows it.

    :param error: an error message or an exception; by default the last error of this notebook
    :raises RoslabError: if there was no error, or the argument is empty or has the wrong type
    """
    if error is None:
        error = getattr(sys, 'last_value', None)
    text = _text(error)
    advice = advice_shown(error) if isinstance(error, BaseException) else ''
    if advice:
        print(_wrapped('The notebook said:', advice))
    if meant := _misspelt_module(text):
        happened = f'Python finds no module with that name, but {meant} exists.'
        print(_paragraph(happened, f'If you mean {meant}, correct the spelling in the import.'))
        return
    found = nearest(text)
    if found:
        print('\n\n'.join(_paragraph(one.cause, one.repair, one.heading) for one in found))
    if found or advice:
        return
    diagnosis = diagnose(text, texts_of(learner_package().folder))
    if diagnosis.cause_id:
        print(_paragraph(diagnosis.text, diagnosis.try_this, 'Part 6: Building'))
        return
    unknown = 'Not in the gallery: '
    print(unknown + textwrap.shorten(text, _WIDTH - len(unknown), placeholder=' ...'))
    print('\n'.join(_wrapped('*', way) for way in _further_help(text, error)))


def _misspelt_module(text: str) -> str:
    """Return the known module whose name differs by one typing mistake from the missing one."""
    found = _NO_MODULE.search(text)
    if found is None:
        return ''
    modules = {one.name for one in pkgutil.iter_modules()} | sys.stdlib_module_names
    public = sorted(name for name in modules if not name.startswith('_'))
    return next((name for name in public if _is_one_typo(found[1], name)), '')


def _is_one_typo(written: str, right: str) -> bool:
    """Return whether one letter is missing, added or wrong, or two adjacent ones are swapped."""
    pairs = enumerate(zip(written, right, strict=False))
    at = next((at for at, pair in pairs if len(set(pair)) == 2), min(len(written), len(right)))
    first, second = written[at:], right[at:]
    swapped = first[1::-1] == second[:2] and first[2:] == second[2:]
    one_letter = second == first[1:] or second[1:] in (first, first[1:])
    return written != right and (one_letter or swapped)


def _further_help(text: str, error: str | BaseException | None) -> tuple[str, ...]:
    """Return other places to look for help: Python's manual, or the issue trackers of ROS."""
    name = text.partition(':')[0].strip()
    kind = getattr(builtins, name, None)
    pythons_own = isinstance(kind, type) and issubclass(kind, BaseException)
    if not pythons_own or _OF_ROS.search(text) or _raised_by_ros(error):
        return _FURTHER
    meaning = (kind.__doc__ or '').splitlines()[0]
    manual = f'{name} is an error of Python itself: {meaning} See {_MANUAL}#{name}'
    return manual, _FURTHER[0], _FURTHER[-1]


def _raised_by_ros(error: str | BaseException | None) -> bool:
    """Return whether the innermost frame of an exception is in rclpy or rosidl."""
    trace = error.__traceback__ if isinstance(error, BaseException) else None
    innermost = list(traceback.walk_tb(trace))[-1:]
    return any(_OF_ROS.match(str(frame.f_globals.get('__name__'))) for frame, _ in innermost)


def _text(error: str | BaseException | None) -> str:
    if error is None:
        raise RoslabError(
            "explain() without an argument explains this notebook's last error, but there was no "
            "error. Try: explain('No executable found')."
        )
    if isinstance(error, BaseException):
        return f'{type(error).__name__}: {error}'.removesuffix(': ')
    if not isinstance(error, str) or not error.strip():
        raise RoslabError(
            f'explain() expected an error message or an exception, got {error!r}. Try: '
            "explain('No executable found')."
        )
    return error


def _paragraph(happened: str, repair: str, section: str = '') -> str:
    """Return an explanation; ``section`` is a heading in lesson 08."""
    lines = [_wrapped('What happened:', happened), _wrapped('Repair:', repair)]
    lines += [_wrapped('More:', f'lesson {LESSON}, "{section}"')] if section else []
    return '\n'.join(lines)


def _wrapped(label: str, text: str) -> str:
    indent = ' ' * (len(label) + 1)
    return textwrap.fill(f'{label} {text}', _WIDTH, subsequent_indent=indent)

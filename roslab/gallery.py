"""
What an error means: the gallery of lesson 08, searched by the text of a message.

The entries are data, in ``gallery.yaml``.  Errors of a build are looked up in the table that
``build_messages`` uses, too.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
import re
import sys
import textwrap

import yaml

from autograder.judging.build_advice import diagnose, texts_of
from roslab.errors import RoslabError
from roslab.package_files import learner_package

LESSON = '08_what_went_wrong'
FILE = Path(__file__).with_name('gallery.yaml')
_MOST = 3
_WIDTH = 96
_FURTHER = (
    'Read the last line of the message, then the lowest line that is your own.',
    'Search the issues of github.com/ros2/rclpy and robotics.stackexchange.com for the words '
    'between your own names, in quotes.',
    f'How to ask others well: lesson {LESSON}, "Asking others".',
)


@dataclass(frozen=True)
class Entry:
    """
    One error of the gallery.

    :param key: its name, and the id of the cell of lesson 08 that makes the mistake
    :param heading: of that exhibit
    :param patterns: regular expressions of the message, or of how people describe silence
    :param cause: what happened
    :param repair: what to do
    """

    key: str
    heading: str
    patterns: tuple[str, ...]
    cause: str
    repair: str

    def matched(self, text: str) -> int:
        """
        Return how much of a text is this entry's message, 0 if it is not.

        :param text: a message in which all white space is one space
        """
        found = (re.search(pattern, text, re.IGNORECASE) for pattern in self.patterns)
        return max((len(match.group()) for match in found if match), default=0)


@cache
def entries() -> tuple[Entry, ...]:
    """Return the entries of the gallery, in the order of the lesson."""
    rows = yaml.safe_load(FILE.read_text(encoding='utf-8'))
    return tuple(
        Entry(
            row['key'],
            row['heading'],
            tuple(row['patterns']),
            row['cause'],
            row['repair'],
        )
        for row in rows
    )


def nearest(text: str) -> list[Entry]:
    """
    Return the entries that a message is about, the best first.

    :param text: an error message, or the end of a log
    """
    line = ' '.join(text.split())
    found = [(entry.matched(line), entry) for entry in entries()]
    found = sorted((pair for pair in found if pair[0]), key=lambda pair: -pair[0])
    return [entry for _, entry in found[:_MOST]]


def explain(error: str | BaseException | None = None) -> None:
    """
    Print what an error means, how to repair it, and where lesson 08 shows it.

    :param error: its text, or an exception; by default the last red error of this notebook
    :raises RoslabError: if there was none, or something else is given
    """
    text = _text(error)
    found = nearest(text)
    if found:
        print('\n\n'.join(_paragraph(entry) for entry in found))
        return
    diagnosis = diagnose(text, texts_of(learner_package().folder))
    if diagnosis.cause:
        place = f'{diagnosis.where}: ' if diagnosis.where else ''
        print(
            _wrapped('What happened:', place + diagnosis.error),
            _wrapped('Repair:', diagnosis.advice),
            _wrapped('More:', f'lesson {LESSON}, "Part 6: Building"'),
            sep='\n',
        )
        return
    print(f'Not in the gallery: {_shortened(text)}')
    print('\n'.join(_wrapped('*', way) for way in _FURTHER))


def _text(error: str | BaseException | None) -> str:
    if error is None:
        error = getattr(sys, 'last_value', None)
        if error is None:
            raise RoslabError(
                'explain() looks at the last red error of this notebook, and there was none. Give '
                "it the text: explain('No executable found')."
            )
    if isinstance(error, BaseException):
        return f'{type(error).__name__}: {error}'
    if not isinstance(error, str) or not error.strip():
        raise RoslabError(
            f'explain() expected the text of an error or an exception, got {error!r}. Try: '
            "explain('No executable found')."
        )
    return error


def _paragraph(entry: Entry) -> str:
    return '\n'.join(
        (
            _wrapped('What happened:', entry.cause),
            _wrapped('Repair:', entry.repair),
            _wrapped('More:', f'lesson {LESSON}, "{entry.heading}"'),
        )
    )


def _wrapped(label: str, text: str) -> str:
    indent = ' ' * (len(label) + 1)
    return textwrap.fill(f'{label} {text}', _WIDTH, subsequent_indent=indent)


def _shortened(text: str) -> str:
    return textwrap.shorten(text, _WIDTH - len('Not in the gallery: '), placeholder=' ...')

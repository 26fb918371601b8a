"""
nbgrader's exchange: folders ``USER+ASSIGNMENT+TIME[+RANDOM]``, all in the folder ``inbound``.

Source: nbgrader 0.9, nbgrader/exchange/default/submit.py.
"""

from __future__ import annotations

from collections.abc import Iterator
import re

from autograder.collect.source.deliveries import Handed, in_folder, Level
from autograder.collect.source.times import read_time

EXPECTED = 'folders named USER+ASSIGNMENT+TIME, as in inbound/'
INBOUND = 'inbound'
FOLDERS = frozenset({INBOUND, 'outbound', 'feedback'})
"""Folders that an exchange has for each course."""
_FOLDER = re.compile(
    r'(?P<user>.+?)\+(?P<assignment>[^+]+)\+'
    r'(?P<when>\d{4}-\d\d-\d\d \d\d:\d\d:\d\d(?:\.\d+)?(?: (?:[+-][\d:]+|[^\s+]+))?)(?:\+.*)?'
)


def claims(level: Level) -> int:
    """Return how many entries have names in nbgrader's form."""
    return sum(bool(_FOLDER.fullmatch(name)) for name in level.folders)


def read(level: Level) -> Iterator[Handed]:
    """Yield each delivery, with the time that nbgrader put into its name."""
    for folder, files in level.folders.items():
        match = _FOLDER.fullmatch(folder)
        if match is None:
            continue
        when, note = read_time(match['when'])
        yield Handed(
            match['user'],
            in_folder(folder, files),
            folder,
            when=when,
            assignment=match['assignment'],
            notes=(note,) if note else (),
            owners=level.owners.get(folder, frozenset()),
        )

"""
Read nbgrader's exchange: folders ``USER+ASSIGNMENT+TIME[+RANDOM]`` in the folder ``inbound``.

Source: nbgrader 0.9, nbgrader/exchange/default/submit.py.
"""

from __future__ import annotations

from collections.abc import Iterator
import re

from autograder.collect.source.deliveries import Entry, Handed, Level, System
from autograder.collect.source.times import read_time

INBOUND = 'inbound'
FOLDERS = frozenset({INBOUND, 'outbound', 'feedback'})
"""Folders that an exchange has for each course."""
_FOLDER = re.compile(
    r'(?P<user>.+?)\+(?P<assignment>[^+]+)\+'
    r'(?P<when>\d{4}-\d\d-\d\d \d\d:\d\d:\d\d(?:\.\d+)?(?: (?:[+-][\d:]+|[^\s+]+))?)(?:\+.*)?'
)


def matches(entry: Entry) -> bool:
    """Return whether an entry is a folder with a name in nbgrader's form."""
    return entry.folder and bool(_FOLDER.fullmatch(entry.name))


def read(level: Level) -> Iterator[Handed]:
    """Yield each delivery, with the time in the name of its folder."""
    for name, entry in level.items():
        match = _FOLDER.fullmatch(name) if entry.folder else None
        if match is None:
            continue
        when, note = read_time(match['when'])
        yield Handed(
            match['user'],
            entry.pieces(),
            name,
            when=when,
            assignment=match['assignment'],
            notes=(note,) if note else (),
            owners=entry.owners,
        )


SYSTEM = System('folders named USER+ASSIGNMENT+TIME, as in inbound/', matches, read)

"""
Read Moodle exports: folders named ``NAME_NUMBER_assignsubmission_file[_]``, or files.

The number differs in each assignment, so the student id is the name; ``namesakes`` detects two
people with the same name.  With "Download submissions in folders" off, files are named
``NAME_NUMBER_assignsubmission_file_FILE``.  For text typed into Moodle, the names contain
``onlinetext`` instead of ``file``.

Source: moodle, mod/assign/classes/downloader.php, which removes underscores from names.
"""

from __future__ import annotations

from collections.abc import Iterator
import re

from autograder.collect.source.deliveries import Entry, Handed, Level, Piece, System

_WHO = r'(?P<name>.+?)_(?P<number>\d+)_assignsubmission_(?P<kind>[a-z0-9]+)'
_FOLDER = re.compile(rf'{_WHO}_?')
# The student chose the rest of the name, so the name and number are matched as early as possible.
_FILE = re.compile(rf'{_WHO}_(?P<file>.+)')
_TYPED = {'onlinetext': 'an online text, which is not collected'}


def _match(entry: Entry) -> re.Match[str] | None:
    return (_FOLDER if entry.folder else _FILE).fullmatch(entry.name)


def matches(entry: Entry) -> bool:
    """Return whether an entry has a name in Moodle's form."""
    return _match(entry) is not None


def read(level: Level) -> Iterator[Handed]:
    """Yield the deliveries of each participant."""
    handed: dict[tuple[str, str, str], list[Piece]] = {}
    places: dict[tuple[str, str, str], str] = {}
    for place, entry in level.items():
        match = _match(entry)
        if match is not None:
            key = match['name'], match['number'], match['kind']
            places.setdefault(key, place)
            pieces = entry.pieces() if entry.folder else (entry.piece(match['file']),)
            handed.setdefault(key, []).extend(pieces)
    for (name, number, kind), found in handed.items():
        what = '' if kind == 'file' else _TYPED.get(kind, f'Moodle type {kind}, not a file')
        place = places[name, number, kind]
        theirs = () if what else tuple(found)
        yield Handed(name, theirs, place, name, instead=what, number=number)


SYSTEM = System('folders or files named NAME_NUMBER_assignsubmission_file_', matches, read)

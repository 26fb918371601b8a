"""
Moodle: folders named ``NAME_NUMBER_assignsubmission_file[_]``, or files with such a beginning.

The number differs in each assignment, so the student id is the name; ``namesakes`` handles two
people with the same name.  With "Download submissions in folders" off, files are named
``NAME_NUMBER_assignsubmission_file_FILE``.  Text typed into Moodle is an ``onlinetext`` instead of
a ``file``.

Source: moodle, mod/assign/classes/downloader.php, which takes underscores out of names.
"""

from __future__ import annotations

from collections.abc import Iterator
import re

from autograder.collect.source.deliveries import Handed, in_folder, Level, Piece
from autograder.submission.tree import File

EXPECTED = 'folders or files named NAME_NUMBER_assignsubmission_file_'
_WHO = r'(?P<name>.+?)_(?P<number>\d+)_assignsubmission_(?P<kind>[a-z0-9]+)'
_FOLDER = re.compile(rf'{_WHO}_?')
# The first match counts, because the student chose the rest of the name.
_FILE = re.compile(rf'{_WHO}_(?P<file>.+)')
_TYPED = {'onlinetext': 'an online text, which is not collected'}


def claims(level: Level) -> int:
    """Return how many entries have names in Moodle's form."""
    return sum(bool(_FOLDER.fullmatch(name)) for name in level.folders) + sum(
        bool(_FILE.fullmatch(name)) for name in level.files
    )


def read(level: Level) -> Iterator[Handed]:
    """Yield the deliveries of each participant."""
    handed: dict[tuple[str, str, str], list[Piece]] = {}
    places: dict[tuple[str, str, str], str] = {}
    for place in level.entries:
        pattern = _FILE if place in level.files else _FOLDER
        match = pattern.fullmatch(place)
        if match is None:
            continue
        key = match['name'], match['number'], match['kind']
        places.setdefault(key, place)
        if place in level.files:
            pieces: tuple[Piece, ...] = (
                Piece(File((match['file'],), level.files[place].read), place),
            )
        else:
            pieces = in_folder(place, level.folders[place])
        handed.setdefault(key, []).extend(pieces)
    for (name, number, kind), found in handed.items():
        what = '' if kind == 'file' else _TYPED.get(kind, f'{kind} of Moodle, not a file')
        place = places[name, number, kind]
        theirs = () if what else tuple(found)
        yield Handed(name, theirs, place, name, instead=what, number=number)

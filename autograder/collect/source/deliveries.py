"""
The data types that all kinds of sources share: who delivered what.

Platforms name the entries of one :class:`Level` of a source.  Students named everything below, so
those names decide nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime

from autograder.collect.source.tree import REPOSITORY
from autograder.submission.tree import File, Tree


@dataclass(frozen=True)
class Piece:
    """
    One delivered file.

    :param file: with its path and name as the student had it
    :param place: the entry of the source that it is in
    :param turn: if two files have one name, the newer file has the larger number
    """

    file: File
    place: str
    turn: int = 0


@dataclass(frozen=True)
class Handed:
    """
    What one student delivered at one time.

    :param student: as the source names them; not yet fit for a folder
    :param called: the whole name in the source, if ``student`` is a part of it
    :param number: the student's number in Moodle, which differs in each assignment
    :param pieces: the files of it
    :param place: the entry of the source, if there are no files
    :param person: the student's name, if the id is not a name
    :param when: time of delivery in UTC, None if it is unknown
    :param stamped: whether a ``timestamp.txt`` next to a notebook has the time
    :param late: the platform that marks the delivery as late
    :param assignment: if the source names it
    :param instead: a delivery that is not a file, such as typed text
    :param doubt: why the owner is unclear
    :param owners: numbers of the users who own the folder and what is in it, if known
    :param notes: remarks for the table
    """

    student: str
    pieces: tuple[Piece, ...]
    place: str
    person: str = ''
    when: datetime | None = None
    stamped: bool = False
    late: str = ''
    assignment: str = ''
    instead: str = ''
    doubt: str = ''
    notes: tuple[str, ...] = ()
    called: str = ''
    number: str = ''
    owners: frozenset[int] = frozenset()

    @property
    def places(self) -> tuple[str, ...]:
        """Return the entries of the source that belong to the delivery, in order."""
        return tuple(dict.fromkeys(piece.place for piece in self.pieces)) or (self.place,)


@dataclass(frozen=True)
class Left:
    """An entry whose owner cannot be determined."""

    place: str
    why: str


@dataclass(frozen=True)
class Level:
    """
    One folder of a source.

    :param files: those directly in it, by name
    :param folders: those directly in it, by name, with all files below, by their path from there
    :param repositories: folders that git has created, recognised by a name in them that begins
        with ``.git``
    :param owners: for each entry, the users who own it or anything below it; a zip has none
    """

    files: Mapping[str, File]
    folders: Mapping[str, tuple[File, ...]]
    repositories: frozenset[str] = frozenset()
    owners: Mapping[str, frozenset[int]] = field(default_factory=dict)

    @property
    def entries(self) -> tuple[str, ...]:
        """Return all names."""
        return (*self.files, *self.folders)


def level(tree: Tree, *base: str) -> Level:
    """
    Return a folder of a source.

    :param base: the names on the way to it; none for the source itself
    """
    depth = len(base)
    files: dict[str, File] = {}
    folders: dict[str, list[File]] = {}
    for file in tree.files:
        if file.parts[:depth] != base:
            continue
        if len(file.parts) == depth + 1:
            files[file.name] = File(file.parts[depth:], file.read)
        elif len(file.parts) > depth + 1:
            below = File(file.parts[depth + 1 :], file.read)
            folders.setdefault(file.parts[depth], []).append(below)
    for parts in tree.empty:
        if parts[:depth] == base and len(parts) > depth:
            folders.setdefault(parts[depth], [])
    repositories = {parts[depth] for parts in tree.repositories if parts[:-1] == base}
    repositories |= {
        name
        for name, inside in folders.items()
        if any(file.parts[0].startswith(REPOSITORY) for file in inside)
    }
    owners: dict[str, set[int]] = {}
    for parts, uid in tree.owners.items():
        if parts[:depth] == base and len(parts) > depth:
            owners.setdefault(parts[depth], set()).add(uid)
    ordered = {name: tuple(folders[name]) for name in sorted(folders)}
    of_each = {name: frozenset(uids) for name, uids in owners.items()}
    return Level(files, ordered, frozenset(repositories), of_each)


def in_folder(folder: str, files: tuple[File, ...]) -> tuple[Piece, ...]:
    """Return the files of a delivery that is a folder."""
    return tuple(Piece(file, folder) for file in files)

"""
The data types that all kinds of sources share: who delivered what.

Platforms name the entries of one :data:`Level` of a source.  Students named everything below, so
those names decide nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property

from autograder.collect.source.tree import REPOSITORY
from autograder.collect.table import Row
from autograder.submission.ids import student_id
from autograder.submission.tree import File, Parts, Tree


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

    @cached_property
    def id(self) -> str:
        """Return the student id, empty if the name has no letter or digit."""
        return student_id(self.student)

    @property
    def places(self) -> tuple[str, ...]:
        """Return the entries of the source that belong to the delivery, in order."""
        return tuple(dict.fromkeys(piece.place for piece in self.pieces)) or (self.place,)


@dataclass(frozen=True)
class Entry:
    """
    One entry of a level: a file, or a folder with all files below.

    :param files: by their paths from the folder; for a file, itself
    :param repository: whether git created the folder, recognised by a name in it that begins with
        ``.git``
    :param owners: the users who own it or anything below it; a zip has none
    """

    name: str
    files: tuple[File, ...]
    folder: bool
    repository: bool = False
    owners: frozenset[int] = frozenset()

    def pieces(self) -> tuple[Piece, ...]:
        """Return the files of a delivery that is this entry."""
        return tuple(Piece(file, self.name) for file in self.files)

    def piece(self, name: str, turn: int = 0) -> Piece:
        """Return the file of this entry under the name that the student gave."""
        return Piece(File((name,), self.files[0].read), self.name, turn)


Level = Mapping[str, Entry]
"""One folder of a source: its entries by name, in order."""


@dataclass(frozen=True)
class System:
    """
    A platform that has its own form of names.

    :param expected: a description of the form
    :param matches: returns whether the name of an entry has the form
    :param read: yields the deliveries in a level, and a row for each entry without an owner
    :param needs: the name of a file that every download has
    """

    expected: str
    matches: Callable[[Entry], bool]
    read: Callable[[Level], Iterator[Handed | Row]]
    needs: str = ''

    def claims(self, place: Level) -> int:
        """Return how many names have the form; 0 without the file that it needs."""
        found = [name for name, entry in place.items() if self.matches(entry)]
        return len(found) if not self.needs or self.needs in found else 0


def level(tree: Tree, *base: str) -> Level:
    """
    Return a folder of a source.

    :param base: the names on the way to it; none for the source itself
    """
    depth = len(base)

    def name_in(parts: Parts) -> str:
        """Return the name of the entry that a path belongs to, empty if it is elsewhere."""
        return parts[depth] if parts[:depth] == base and len(parts) > depth else ''

    files: dict[str, list[File]] = {}
    owners: dict[str, set[int]] = {}
    folders = {name_in(parts) for parts in tree.empty} - {''}
    repositories = {parts[depth] for parts in tree.repositories if parts[:-1] == base}
    for file in tree.files:
        if name := name_in(file.parts):
            below = file.parts[depth + 1 :]
            files.setdefault(name, []).append(File(below or (name,), file.read))
            folders |= {name} if below else set()
            repositories |= {name} if below and below[0].startswith(REPOSITORY) else set()
    for parts, uid in tree.owners.items():
        owners.setdefault(name_in(parts), set()).add(uid)
    return {
        name: Entry(
            name,
            tuple(files.get(name, ())),
            name in folders,
            name in repositories,
            frozenset(owners.get(name, ())),
        )
        for name in sorted({*files, *folders})
    }


def only_folder(place: Level) -> str:
    """Return the name of the folder around everything, or an empty string."""
    names = list(place)
    return names[0] if len(names) == 1 and place[names[0]].folder else ''

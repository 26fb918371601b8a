"""
List the entries of a source; define entries, deliveries and rows of the table.

The platform chose the names of the entries at one :data:`Level` of a source.  Students chose all
names below that level, so these names never show who handed in a file.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import partial
import re
from typing import NamedTuple

from autograder.submission.inbox import student_id
from autograder.submission.notebook import MAX_BYTES
from autograder.submission.reading import (
    Bounds,
    File,
    files_in_zip,
    Parts,
    refuse,
    Tree,
    UnreadableError,
)

REPOSITORY = '.git'
NOISE = {'__MACOSX', '.DS_Store', '.ipynb_checkpoints', REPOSITORY, '.venv', '__pycache__'}
"""
Files and folders that macOS, Jupyter, git and Python generate.

macOS also generates ``._NAME`` files, even for notebooks.
"""
BUILT = {'build', 'install', 'log'}
"""
Folders that colcon generates.

Students may use these names too, so such a folder is skipped only if it contains colcon's marker
file or is directly in the workspace of the lessons.
"""
_WORKSPACE = 'ros_ws'
TAKEN, REPLACED, UNCHANGED, LEFT = 'taken', 'replaced', 'unchanged', 'not taken'


NOTEBOOK = re.compile(r'\.ipynb(\.txt|\.json)?$', re.IGNORECASE)
"""The ending of a notebook's name; some browsers add ``.txt`` or ``.json``."""
ZIP = '.zip'
MAX_ZIPS = 10
"""Maximum number of zip files that are opened in one folder or zip file of a student."""


def _is_noise(parts: Parts, marked: Collection[Parts]) -> bool:
    *above, name = parts
    built = name in BUILT and above and (above[-1] == _WORKSPACE or parts in marked)
    return name in NOISE or name.startswith('._') or bool(built)


BOUNDS = Bounds(
    'the submissions of a class',
    'collect a folder with submissions only, one assignment, or part of the class',
    _is_noise,
    entries=50_000,
    listed=500_000,
    file_bytes=MAX_BYTES,
    whole_bytes=2 << 30,  # a class hands in a few hundred megabytes
    name_chars=400,
)
"""
Limits of a source.

Files that programs generate next to the work are neither listed nor counted.  Otherwise the built
workspace of one student could exceed the limits for the whole class.
"""
IN_ZIP = BOUNDS._replace(entries=2_000, listed=20_000)
"""Limits of a zip file that a student handed in."""


class DeliveredFile(NamedTuple):
    """
    One delivered file, with the path and name that the student chose.

    :param place: name of the entry of the source that contains the file
    :param turn: number of the attempt; of two files with the same name, the newer has the larger
        number
    """

    file: File
    place: str
    turn: int = 0


@dataclass(frozen=True)
class Row:
    """
    One row of the table.

    :param student: student id, empty if it is not known
    :param place: the entry of the source
    :param done: :data:`TAKEN`, :data:`REPLACED`, :data:`UNCHANGED` or :data:`LEFT`
    :param person: the student's name, if the id is not a name
    :param handed_in: time of delivery in UTC to the minute, empty if it is not known
    """

    student: str
    assignment: str
    place: str
    done: str
    notes: tuple[str, ...] = ()
    person: str = ''
    handed_in: str = ''


def unclaimed(place: str, why: str) -> Row:
    """Return the row of an entry that belongs to no known student."""
    return Row('', '', place, LEFT, (why,))


@dataclass(eq=False)
class Delivery:
    """
    A delivery: everything that one student handed in at one time.

    :param student: the student as named in the source; :attr:`id` is the student id
    :param called: the whole name in the source, if ``student`` is a part of it
    :param number: the student's number in Moodle, which differs in each activity
    :param known: the student id, if it was found by the number and not by the name
    :param place: name of the entry of the source, if there are no files
    :param person: the student's name, if the id is not a name
    :param when: time of delivery in UTC, None if it is unknown
    :param stamped: whether a ``timestamp.txt`` next to a notebook contains the time
    :param late: name of the platform that marks the delivery as late, else empty
    :param assignment: the assignment, if the source names it, else empty
    :param refused: why the delivery is not collected: its owner is unclear, or it has no files,
        only typed text; else empty
    :param owners: ids of the system users who own the folder and its contents, if known
    """

    student: str
    files: tuple[DeliveredFile, ...]
    place: str
    person: str = ''
    when: datetime | None = None
    stamped: bool = False
    late: str = ''
    assignment: str = ''
    refused: str = ''
    notes: tuple[str, ...] = ()
    called: str = ''
    number: str = ''
    known: str = ''
    owners: frozenset[int] = frozenset()

    @property
    def id(self) -> str:
        """Return the student id, empty if the name has no letter or digit."""
        return self.known or student_id(self.student)

    @property
    def places(self) -> tuple[str, ...]:
        """Return the entries of the source that belong to the delivery, in order."""
        return tuple(dict.fromkeys(one.place for one in self.files)) or (self.place,)


def notebooks_in(
    files: Sequence[DeliveredFile], zips: bool = False, levels: int = 2
) -> list[DeliveredFile]:
    """
    Return the notebooks among the files of one entry.

    If there are none, zip files are opened, and if these have none either, all JSON files are
    returned.  A zip file that cannot be opened is returned too: reading it raises the reason.

    :param zips: whether to open zip files even if there are notebooks
    :param levels: how many zip files may be inside each other
    """
    found = [one for one in files if NOTEBOOK.search(one.file.name)]
    if found and not zips:
        return found
    packed = [one for one in files if one.file.name.lower().endswith(ZIP)]
    for count, one in enumerate(packed if levels else ()):
        try:
            if count >= MAX_ZIPS:
                raise UnreadableError(
                    f'not opened: only the first {MAX_ZIPS} zip files are opened'
                )
            inside = [one._replace(file=file) for file in files_in_zip(one.file, IN_ZIP)]
            found += notebooks_in(inside, levels=levels - 1)
        except UnreadableError as error:
            found.append(one._replace(file=one.file._replace(read=partial(refuse, str(error)))))
    return found or [one for one in files if one.file.name.lower().endswith('.json')]


class Entry(NamedTuple):
    """
    One entry of a level: a file, or a folder with all files below it.

    :param files: all files, with paths relative to the folder; for a file, the file itself
    :param repository: whether the folder is a git repository, recognised by a name in it that
        begins with ``.git``
    :param owners: ids of the system users who own the entry or anything below it; empty for a zip
    """

    name: str
    files: tuple[File, ...]
    folder: bool
    repository: bool
    owners: frozenset[int]

    @property
    def path(self) -> str:
        """Return the name, followed by a slash if the entry is a folder."""
        return f'{self.name}/' if self.folder else self.name

    def delivered_files(self, name: str = '', turn: int = 0) -> tuple[DeliveredFile, ...]:
        """Return the delivered files; ``name`` is the name that the student gave a single file."""
        files = (File((name,), self.files[0].read),) if name else self.files
        return tuple(DeliveredFile(file, self.name, turn) for file in files)


Level = Mapping[str, Entry]
"""One folder of a source: its entries by name, in order."""


class System(NamedTuple):
    """
    A platform, which is recognised by the form of the names in its exports.

    :param expected: a description of the form
    :param matches: function that returns a true value if :attr:`Entry.path` has the form
    :param read: function that yields the deliveries in a level, and a row for each entry that
        has the form but no known student
    :param needs: name of a file that every export contains, empty if there is none
    """

    expected: str
    matches: Callable[[str], object]
    read: Callable[[Level], Iterator[Delivery | Row]]
    needs: str = ''

    def claims(self, place: Level) -> set[str]:
        """Return the names that have the form; none if the needed file is missing."""
        found = {name for name, entry in place.items() if self.matches(entry.path)}
        return found if not self.needs or self.needs in found else set()


def level(tree: Tree, *base: str) -> Level:
    """Return the entries of the folder ``base`` in a source; empty for the source itself."""
    depth = len(base)

    def name_in(parts: Parts) -> str:
        """Return the name of the entry that contains a path, empty if the path is elsewhere."""
        return parts[depth] if parts[:depth] == base and len(parts) > depth else ''

    files: dict[str, list[File]] = {}
    owners: dict[str, set[int]] = {}
    folders = {name_in(parts) for parts in tree.folders} - {''}
    repositories = {parts[depth] for parts in tree.repositories if parts[:-1] == base}
    for file in tree.files:
        if name := name_in(file.parts):
            below = file.parts[depth + 1 :]
            files.setdefault(name, []).append(File(below or (name,), file.read))
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
    """Return the name of the single outer folder of a level, or an empty string."""
    names = list(place)
    return names[0] if len(names) == 1 and place[names[0]].folder else ''

"""
A source of submissions as a list of files: a folder, or a zip that is never unpacked.

Other people named everything in it.  Only regular files are listed, what a zip says about itself
is not believed, and nothing that leads elsewhere is followed.  Every file is read again each time,
up to the size of the largest notebook, and all of them together up to :data:`MOST_BYTES`.  What
programs leave next to people's work is not listed and does not count as files of the class: see
:data:`NOISE` and :data:`BUILT`.  A student's workspace must not make a class too large.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import partial
import os
from pathlib import Path
import stat
import zipfile
import zlib

from autograder.errors import GraderError
from autograder.submission.notebook import MAX_BYTES
from autograder.submission.reading import read_file

MOST_ENTRIES = 50_000
"""Of the class; what programs leave is not counted here."""
MOST_LISTED = 10 * MOST_ENTRIES
"""Bound on all names that are looked at, whatever they are."""
MOST_BYTES = 2 << 30
"""Bound on all that is read of one source, unpacked: a class has some hundred megabytes."""
DEEPEST = 12
LONGEST_NAME = 400
REPOSITORY = '.git'
NOISE = frozenset(
    {'__MACOSX', '.DS_Store', '.ipynb_checkpoints', REPOSITORY, '.venv', '__pycache__'}
)
"""
Made by macOS, Jupyter, git and Python; ``._NAME`` is macOS's too, and may end in ``.ipynb``.
"""
BUILT = frozenset({'build', 'install', 'log'})
"""
Made by colcon, if its mark is in it or it lies in the workspace of the lessons: the names alone
may be somebody's own.  Notebooks elsewhere in a workspace are listed as everywhere.
"""
_MARK = 'COLCON_IGNORE'
_WORKSPACE = 'ros_ws'
_CHUNK = 1 << 20
_NOT_LISTED = 'made by a program'
_UTF_8 = 0x800
"""Set where a zip says that a name is UTF-8."""
_TAKEN = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


class NotCollectedError(GraderError):
    """The source as a whole cannot be used."""


@dataclass(frozen=True)
class File:
    """
    One regular file of a source.

    :param parts: its path, name by name; never empty, absolute or leading elsewhere
    :param read: returns its bytes, or raises :class:`UnreadableError`
    """

    parts: tuple[str, ...]
    read: Callable[[], bytes]

    @property
    def path(self) -> str:
        """Return the path as people write it."""
        return '/'.join(self.parts)

    @property
    def name(self) -> str:
        """Return the last part."""
        return self.parts[-1]


class UnreadableError(Exception):
    """A single file cannot be taken; the others can."""


@dataclass(frozen=True)
class Tree:
    """
    A source.

    :param files: in the order of their paths
    :param refused: path and reason of what was left where it was
    :param empty: folders with none of both, the two upper levels
    :param repositories: folders with a ``.git`` in them
    :param owners: numbers of the users who own folders and files; a zip does not tell them
    """

    name: str
    files: tuple[File, ...]
    refused: tuple[tuple[str, str], ...]
    empty: tuple[tuple[str, ...], ...] = ()
    repositories: frozenset[tuple[str, ...]] = frozenset()
    owners: Mapping[tuple[str, ...], int] = field(default_factory=dict)


class Budget:
    """
    What may still be read of a source; a file that was read can be read again.

    :param source: how to name it in messages
    """

    def __init__(self, source: str) -> None:
        """Begin with everything."""
        self._source, self._left = source, MOST_BYTES
        self._known: set[str] = set()

    def spend(self, where: str, count: int) -> None:
        """
        Note that so many bytes of a file were read.

        :raises NotCollectedError: if that is too much
        """
        if where in self._known:
            return
        self._known.add(where)
        self._left -= count
        if self._left < 0:
            raise NotCollectedError(
                f'{self._source}: expected at most {MOST_BYTES / 2**30:.3g} GiB of notebooks, '
                'got more.',
                'Try: one assignment at a time, or a part of the class',
            )


@contextmanager
def opened(source: Path) -> Iterator[Tree]:
    """
    Yield a source; its files can be read until the end of the context.

    :param source: a folder or a zip file
    :raises NotCollectedError: if it is neither, broken, or far too much
    """
    try:
        kind = source.stat().st_mode
    except OSError as error:
        what = f'{source}: expected a folder or a zip file, got: {str(error.strerror).lower()}.'
        raise NotCollectedError(what) from error
    if stat.S_ISDIR(kind):
        yield _of_folder(source, Budget(str(source)))
        return
    if not stat.S_ISREG(kind) or not zipfile.is_zipfile(source):
        raise NotCollectedError(
            f'{source}: expected a folder or a zip file, got something else.',
            'Try: the zip as it was downloaded, or the folder it was unpacked to',
        )
    try:
        with zipfile.ZipFile(source) as archive:
            yield _of_zip(source.name, archive, Budget(str(source)))
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError) as error:
        raise NotCollectedError(
            f'{source}: expected a zip file that can be read, got: {error}.',
            'Try: download it again',
        ) from error


@dataclass
class _Listing:
    """
    What was found so far.

    :param where: the source, for messages
    :param names: how many were looked at, and how many of them count
    """

    where: str
    files: dict[tuple[str, ...], File] = field(default_factory=dict)
    refused: list[tuple[str, str]] = field(default_factory=list)
    folders: set[tuple[str, ...]] = field(default_factory=set)
    repositories: set[tuple[str, ...]] = field(default_factory=set)
    owners: dict[tuple[str, ...], int] = field(default_factory=dict)
    names: tuple[int, int] = (0, 0)

    def count(self, noise: bool) -> None:
        """
        Count one name.

        :raises NotCollectedError: if there are far too many
        """
        listed, counted = self.names
        self.names = listed + 1, counted + (not noise)
        for found, most in zip(self.names, (MOST_LISTED, MOST_ENTRIES)):
            if found > most:
                raise NotCollectedError(
                    f'{self.where}: expected the submissions of a class, got more than {most} '
                    'files.',
                    'Try: the folder with the submissions alone',
                )

    def note_noise(self, parts: tuple[str, ...]) -> None:
        """Note what is not listed: the folder it is in is there, and may be a repository."""
        above = parts[:-1]
        if above and (above in self.folders or not _trouble(above)):
            self.folders.add(above)
            if parts[-1] == REPOSITORY:
                self.repositories.add(above)

    def tree(self, name: str) -> Tree:
        """Return it as a tree, with those folders as empty in which nothing was found."""
        found = [*self.files, *(tuple(where.split('/')) for where, _ in self.refused)]
        used = {parts[:count] for parts in found for count in (1, 2)}
        empty = sorted({parts[:2] for parts in self.folders} - used)
        files = tuple(self.files[parts] for parts in sorted(self.files))
        repositories = frozenset(self.repositories)
        return Tree(name, files, tuple(self.refused), tuple(empty), repositories, self.owners)


def _of_folder(folder: Path, budget: Budget) -> Tree:
    found = _Listing(str(folder))
    for parts, path, trouble in _walk(folder, ()):
        noise = trouble == _NOT_LISTED
        found.count(noise)
        if noise:
            found.note_noise(parts)
            continue
        where = '/'.join(parts)
        trouble = trouble or _trouble(parts)
        facts = path.lstat()
        kind, found.owners[parts] = facts.st_mode, facts.st_uid
        if trouble:
            found.refused.append((where, trouble))
        elif stat.S_ISDIR(kind):
            found.folders.add(parts)
        elif not stat.S_ISREG(kind):
            found.refused.append((where, 'a link or a special file'))
        else:
            found.files[parts] = File(
                parts, partial(_read_path, path, where, budget, facts.st_uid)
            )
    return found.tree(folder.resolve().name)


def _walk(folder: Path, above: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Path, str]]:
    """Yield everything in order, with what is wrong with it; no link is followed."""
    with os.scandir(folder) as entries:
        inside = sorted(entries, key=lambda entry: entry.name)
    for entry in inside:
        parts, path = (*above, entry.name), Path(entry.path)
        folder_here = entry.is_dir(follow_symlinks=False)
        built = folder_here and entry.name in BUILT and os.path.lexists(path / _MARK)
        if _is_noise(parts, (parts,) if built else ()):
            yield parts, path, _NOT_LISTED
        elif not folder_here:
            yield parts, path, ''
        elif len(parts) >= DEEPEST:
            yield parts, path, 'a path that is far too long'
        else:
            try:
                yield parts, path, ''
                yield from _walk(path, parts)
            except PermissionError:  # one student's folder, as exchanges have them
                yield parts, path, 'a folder that cannot be read: permission denied'


def _is_noise(parts: tuple[str, ...], marked: Collection[tuple[str, ...]]) -> bool:
    """
    Return whether a program has left it.

    :param parts: a path; what is above it is none
    :param marked: folders with the mark of colcon
    """
    *above, name = parts
    built = name in BUILT and above and (above[-1] == _WORKSPACE or parts in marked)
    return name in NOISE or name.startswith('._') or bool(built)


def _read_path(path: Path, where: str, budget: Budget, owner: int) -> bytes:
    data, problems = read_file(path, where, owner)
    if data is None:
        raise UnreadableError(problems[0].got if problems else 'nothing')
    budget.spend(where, len(data))
    return data


def _of_zip(name: str, archive: zipfile.ZipFile, budget: Budget) -> Tree:
    found, inside = _Listing(name), archive.infolist()
    names = [_name_of(entry) for entry in inside]
    # What is deeper than allowed stays in one piece: a name may have thousands of slashes.
    paths = [tuple(one.removesuffix('/').split('/', DEEPEST + 1)) for one in names]
    marked = {parts[:-1] for parts in paths if parts[-1] == _MARK}
    for entry, where, parts in zip(inside, names, paths):
        upto = range(1, len(parts) + 1)
        noise = next((parts[:count] for count in upto if _is_noise(parts[:count], marked)), None)
        found.count(noise is not None)
        if noise is not None:
            found.note_noise(noise)
            continue
        trouble = _trouble(parts)
        if entry.is_dir():
            found.folders |= set() if trouble else {parts}
            continue
        trouble = trouble or _trouble_with_entry(entry)
        if not trouble and parts in found.files:
            trouble = 'a name that is there twice'
        if trouble:
            found.refused.append((where[:LONGEST_NAME], trouble))
        else:
            found.files[parts] = File(parts, partial(_read_entry, archive, entry, budget))
    return found.tree(name.removesuffix('.zip'))


def _name_of(entry: zipfile.ZipInfo) -> str:
    """
    Return the name of an entry.

    The Finder and ``zip`` write UTF-8 without saying so, and Python reads that as code page 437.
    """
    if not entry.flag_bits & _UTF_8:
        with suppress(UnicodeError):
            return entry.orig_filename.encode('cp437').decode('utf-8')
    return entry.orig_filename


def _read_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, budget: Budget) -> bytes:
    data = bytearray()
    try:
        with archive.open(entry) as file:  # what it says of its size is not asked
            while len(data) <= MAX_BYTES and (more := file.read(_CHUNK)):
                data += more
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise UnreadableError(f'a damaged entry ({error})') from error
    finally:
        budget.spend(entry.orig_filename, len(data))
    if len(data) > MAX_BYTES:
        raise UnreadableError(f'more than {MAX_BYTES >> 20} MiB')
    return bytes(data)


def _trouble(parts: tuple[str, ...]) -> str:
    """Return why a path is not taken, or nothing."""
    path = '/'.join(parts)
    readable = path.encode('utf-8', 'surrogateescape').decode('utf-8', 'replace') == path
    if {'', '.', '..'} & set(parts):
        return 'a path that leads elsewhere'
    if not readable or not path.isprintable() or '\\' in path:
        return 'a name with characters that no system shows'
    if len(path) > LONGEST_NAME or len(parts) > DEEPEST:
        return 'a path that is far too long'
    if len(parts[0]) == 2 and parts[0][1] == ':':
        return 'an absolute path'
    return ''


def _trouble_with_entry(entry: zipfile.ZipInfo) -> str:
    if stat.S_IFMT(entry.external_attr >> 16) not in (0, stat.S_IFREG):
        return 'a link or a special file'
    if entry.flag_bits & 0x1:
        return 'an encrypted file'
    if entry.compress_type not in _TAKEN:
        return 'an unusual compression'
    return ''

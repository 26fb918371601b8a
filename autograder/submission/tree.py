"""
A folder, or a zip that is never unpacked, as a list of files that can be read.

Other people named everything in it.  Only regular files are listed, what a zip says about itself
is not believed, and nothing that leads elsewhere is followed.  Every file is read again each time,
and :class:`Bounds` limit each file and all of them together.  What programs leave next to people's
work is not listed.
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
from autograder.submission.reading import read_file

Parts = tuple[str, ...]
"""A path, name by name."""
DEEPEST = 12
SPECIAL = 'a link or a special file'
COLCON_MARK = 'COLCON_IGNORE'
_CHUNK = 1 << 20
_NOT_LISTED = 'made by a program'
_UTF_8 = 0x800
"""Set where a zip says that a name is UTF-8."""
_COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_DAMAGED = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError)


class NotTakenInError(GraderError):
    """What was handed in cannot be used as it is."""


class UnreadableError(Exception):
    """A single file cannot be taken; the others can."""


@dataclass(frozen=True)
class Bounds:
    """
    What is read of a source, and how much.

    :param what: what it should be, in words
    :param fix: what to try if it is not
    :param is_noise: returns whether a program has left a path, of which nothing above is noise;
        called with the path and with the folders that have the mark of colcon
    :param entries: how many names may count
    :param listed: how many names are looked at, whatever they are
    """

    what: str
    fix: str
    is_noise: Callable[[Parts, Collection[Parts]], bool]
    entries: int
    listed: int
    file_bytes: int
    whole_bytes: int
    name_chars: int

    def refusal(self, source: str, got: str) -> NotTakenInError:
        """Return the error that a source, or a file of it, is not what it should be."""
        return NotTakenInError(f'{source}: expected {self.what}, got {got}.', f'Try: {self.fix}')

    def trouble(self, parts: Parts) -> str:
        """Return why a path is not taken, or nothing."""
        path = '/'.join(parts)
        readable = path.encode('utf-8', 'surrogateescape').decode('utf-8', 'replace') == path
        if path.startswith('/') or (len(parts[0]) == 2 and parts[0][1] == ':'):
            return 'an absolute path'
        if {'', '.', '..'} & set(parts):
            return 'a path that leads elsewhere'
        if not readable or not path.isprintable() or '\\' in path:
            return 'a name with characters that no system shows'
        if len(path) > self.name_chars:
            return 'a path that is far too long'
        return f'folders more than {DEEPEST} deep' if len(parts) > DEEPEST else ''


@dataclass(frozen=True)
class File:
    """
    One regular file of a source.

    :param parts: its path, name by name; never empty, absolute or leading elsewhere
    :param read: returns its bytes, or raises :class:`UnreadableError`
    """

    parts: Parts
    read: Callable[[], bytes]

    @property
    def path(self) -> str:
        """Return the path as people write it."""
        return '/'.join(self.parts)

    @property
    def name(self) -> str:
        """Return the last part."""
        return self.parts[-1]


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
    empty: tuple[Parts, ...] = ()
    repositories: frozenset[Parts] = frozenset()
    owners: Mapping[Parts, int] = field(default_factory=dict)


@contextmanager
def opened(source: Path, bounds: Bounds) -> Iterator[Tree]:
    """
    Yield a source; its files can be read until the end of the context.

    :param source: a folder or a zip file
    :raises NotTakenInError: if it is neither, broken, or too much
    """
    try:
        kind = source.stat().st_mode
    except OSError as error:
        what = f'{source}: expected a folder or a zip file, got: {str(error.strerror).lower()}.'
        raise NotTakenInError(what) from error
    if stat.S_ISDIR(kind):
        yield _of_folder(source, _Listing(str(source), bounds))
        return
    try:
        if not stat.S_ISREG(kind):
            raise zipfile.BadZipFile('something else')
        with zipfile.ZipFile(source) as archive:
            yield _of_zip(archive, _Listing(str(source), bounds), source.stem)
    except _DAMAGED as error:
        raise NotTakenInError(
            f'{source}: expected a folder or a zip file that can be read, got: {error}.',
            'Try: download or pack it again, or the folder that was packed',
        ) from error


@dataclass
class _Listing:
    """
    What was found so far.

    :param where: the source, for messages
    :param names: how many were looked at, and how many of them count
    :param known: what was read; it can be read again
    :param read_bytes: all of it together
    """

    where: str
    bounds: Bounds
    files: dict[Parts, File] = field(default_factory=dict)
    refused: list[tuple[str, str]] = field(default_factory=list)
    folders: set[Parts] = field(default_factory=set)
    repositories: set[Parts] = field(default_factory=set)
    owners: dict[Parts, int] = field(default_factory=dict)
    names: tuple[int, int] = (0, 0)
    known: set[Parts] = field(default_factory=set)
    read_bytes: int = 0

    def count(self, noise: bool) -> None:
        """
        Count one name.

        :raises NotTakenInError: if there are far too many
        """
        listed, counted = self.names
        self.names = listed + 1, counted + (not noise)
        for found, most in zip(self.names, (self.bounds.listed, self.bounds.entries)):
            if found > most:
                raise self.bounds.refusal(self.where, f'more than {most} files')

    def spend(self, parts: Parts, count: int) -> None:
        """
        Note that so many bytes of a file were read.

        :raises NotTakenInError: if that is too much
        """
        self.read_bytes += 0 if parts in self.known else count
        self.known.add(parts)
        if self.read_bytes > self.bounds.whole_bytes:
            raise self.bounds.refusal(self.where, _more_than(self.bounds.whole_bytes))

    def note_noise(self, parts: Parts) -> None:
        """Note what is not listed: the folder it is in is there, and may be a repository."""
        above = parts[:-1]
        if above and (above in self.folders or not self.bounds.trouble(above)):
            self.folders.add(above)
            if parts[-1] == '.git':
                self.repositories.add(above)

    def tree(self, name: str) -> Tree:
        """Return it as a tree, with those folders as empty in which nothing was found."""
        found = [*self.files, *(tuple(where.split('/')) for where, _ in self.refused)]
        used = {parts[:count] for parts in found for count in (1, 2)}
        empty = sorted({parts[:2] for parts in self.folders} - used)
        files = tuple(self.files[parts] for parts in sorted(self.files))
        repositories = frozenset(self.repositories)
        return Tree(name, files, tuple(self.refused), tuple(empty), repositories, self.owners)


def _of_folder(folder: Path, found: _Listing) -> Tree:
    for parts, path, trouble in _walk(folder, (), found.bounds):
        noise = trouble == _NOT_LISTED
        found.count(noise)
        if noise:
            found.note_noise(parts)
            continue
        trouble = trouble or found.bounds.trouble(parts)
        facts = path.lstat()
        kind, found.owners[parts] = facts.st_mode, facts.st_uid
        if trouble:
            found.refused.append(('/'.join(parts), trouble))
        elif stat.S_ISDIR(kind):
            found.folders.add(parts)
        elif not stat.S_ISREG(kind):
            found.refused.append(('/'.join(parts), SPECIAL))
        else:
            found.files[parts] = File(parts, partial(_read_path, path, parts, found, facts.st_uid))
    return found.tree(folder.resolve().name)


def _walk(folder: Path, above: Parts, bounds: Bounds) -> Iterator[tuple[Parts, Path, str]]:
    """Yield everything in order, with what is wrong with it; no link is followed."""
    with os.scandir(folder) as entries:
        inside = sorted(entries, key=lambda entry: entry.name)
    for entry in inside:
        parts, path = (*above, entry.name), Path(entry.path)
        folder_here = entry.is_dir(follow_symlinks=False)
        built = folder_here and os.path.lexists(path / COLCON_MARK)
        if bounds.is_noise(parts, (parts,) if built else ()):
            yield parts, path, _NOT_LISTED
        elif not folder_here:
            yield parts, path, ''
        elif len(parts) >= DEEPEST:
            yield parts, path, 'a path that is far too long'
        else:
            try:
                yield parts, path, ''
                yield from _walk(path, parts, bounds)
            except PermissionError:  # one student's folder, as exchanges have them
                yield parts, path, 'a folder that cannot be read: permission denied'


def _read_path(path: Path, parts: Parts, found: _Listing, owner: int) -> bytes:
    data, problems = read_file(path, '/'.join(parts), owner)
    if data is None:
        raise UnreadableError(problems[0].got)
    return _within(data, parts, found)


def _within(data: bytes, parts: Parts, found: _Listing) -> bytes:
    """Return what was read of a file, unless it or all that was read is too much."""
    found.spend(parts, len(data))
    if len(data) > found.bounds.file_bytes:
        raise UnreadableError(_more_than(found.bounds.file_bytes))
    return data


def _more_than(count: int) -> str:
    return f'more than {count >> 20} MiB'


def _of_zip(archive: zipfile.ZipFile, found: _Listing, name: str) -> Tree:
    inside = archive.infolist()
    names = [_name_of(entry) for entry in inside]
    # What is deeper than allowed stays in one piece: a name may have thousands of slashes.
    paths = [tuple(one.removesuffix('/').split('/', DEEPEST + 1)) for one in names]
    marked = {parts[:-1] for parts in paths if parts[-1] == COLCON_MARK}
    for entry, where, parts in zip(inside, names, paths):
        heads = (parts[:count] for count in range(1, len(parts) + 1))
        noise = next((one for one in heads if found.bounds.is_noise(one, marked)), None)
        found.count(noise is not None)
        if noise is not None:
            found.note_noise(noise)
            continue
        trouble = found.bounds.trouble(parts)
        if entry.is_dir() and not trouble:
            found.folders.add(parts)
            continue
        trouble = trouble or _trouble_with_entry(entry)
        if not trouble and parts in found.files:
            trouble = 'a name that is there twice'
        if trouble:
            found.refused.append((where[: found.bounds.name_chars], trouble))
        else:
            found.files[parts] = File(parts, partial(_read_entry, archive, entry, parts, found))
    return found.tree(name)


def _name_of(entry: zipfile.ZipInfo) -> str:
    """
    Return the name of an entry.

    The Finder and ``zip`` write UTF-8 without saying so, and Python reads that as code page 437.
    """
    if not entry.flag_bits & _UTF_8:
        with suppress(UnicodeError):
            return entry.orig_filename.encode('cp437').decode('utf-8')
    return entry.orig_filename


def _read_entry(
    archive: zipfile.ZipFile, entry: zipfile.ZipInfo, parts: Parts, found: _Listing
) -> bytes:
    data = bytearray()
    try:
        with archive.open(entry) as file:  # what it says of its size is not asked
            while len(data) <= found.bounds.file_bytes and (more := file.read(_CHUNK)):
                data += more
    except (*_DAMAGED, RuntimeError) as error:
        found.spend(parts, len(data))
        raise UnreadableError(f'a damaged entry ({error})') from error
    return _within(bytes(data), parts, found)


def _trouble_with_entry(entry: zipfile.ZipInfo) -> str:
    if stat.S_IFMT(entry.external_attr >> 16) not in (0, stat.S_IFREG):
        return SPECIAL
    if entry.flag_bits & 0x1:
        return 'an encrypted file'
    return '' if entry.compress_type in _COMPRESSIONS else 'an unusual compression'

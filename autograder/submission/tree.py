"""
List the files of a folder, or of a zip without unpacking it, and read them safely.

All names and contents come from students.  Only regular files are listed, no link is followed, and
the sizes in a zip's directory are not trusted.  A file's content is not cached.  :class:`Bounds`
limits the size of each file and of all files together.  Generated files are not listed.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import partial
import os
from pathlib import Path
import stat
from typing import NamedTuple
import zipfile
import zlib

from autograder.errors import GraderError
from autograder.submission.reading import read_file

Parts = tuple[str, ...]
"""The components of a path."""
DEEPEST = 12
SPECIAL = 'a link or a special file'
COLCON_MARK = 'COLCON_IGNORE'
_CHUNK = 1 << 20
_NOISE = 'made by a program'
_UTF_8 = 0x800
"""Flag of a zip entry whose name is encoded in UTF-8."""
_COMPRESSIONS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_DAMAGED = (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError)


class NotTakenInError(GraderError):
    """Report that a submission cannot be used."""


class UnreadableError(Exception):
    """Report that one file cannot be read; other files of the source may be readable."""


class Bounds(NamedTuple):
    """
    Limits for reading a source.

    :param what: a description of the expected source
    :param fix: what to try if the source is a different one
    :param is_noise: returns whether a path is generated; called with a path whose parents are not
        generated, and with the folders that contain ``COLCON_IGNORE``
    :param entries: maximum number of files and folders without generated ones
    :param listed: maximum number of all files and folders
    :param file_bytes: maximum size of one file
    :param whole_bytes: maximum size of all files together
    :param name_chars: maximum length of a path
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
        """Return the error for a source, or one of its files, that cannot be used."""
        return NotTakenInError(f'{source}: expected {self.what}, got {got}.', f'Try: {self.fix}')

    def trouble(self, parts: Parts) -> str:
        """Return why a path is not accepted; empty if it is accepted."""
        path = '/'.join(parts)
        readable = path.encode('utf-8', 'surrogateescape').decode('utf-8', 'replace') == path
        if path.startswith('/') or (len(parts[0]) == 2 and parts[0][1] == ':'):
            return 'an absolute path'
        if {'', '.', '..'} & set(parts):
            return 'a path that leads out of the folder'
        if not readable or not path.isprintable() or '\\' in path:
            return 'a name with unprintable characters'
        if len(path) > self.name_chars:
            return 'a path that is far too long'
        return f'folders more than {DEEPEST} deep' if len(parts) > DEEPEST else ''


class File(NamedTuple):
    """
    One regular file of a source.

    :param parts: the components of its path, which is never empty or absolute and has no ``..``
    :param read: returns its bytes, or raises :class:`UnreadableError`
    :param trouble: why it is skipped, empty if it is not
    :param owner: uid of its owner, None if it is not known
    """

    parts: Parts
    read: Callable[[], bytes]
    trouble: str = ''
    owner: int | None = None

    @property
    def path(self) -> str:
        """Return the path with slashes."""
        return '/'.join(self.parts)

    @property
    def name(self) -> str:
        """Return the last component of the path."""
        return self.parts[-1]


class Tree(NamedTuple):
    """
    A source with its files.

    :param files: sorted by path
    :param refused: path and reason of each skipped entry
    :param empty: folders of the two upper levels without files that can be read
    :param repositories: folders that contain ``.git``
    :param owners: uid of each file and folder; empty for a zip
    """

    name: str
    files: tuple[File, ...]
    refused: list[tuple[str, str]]
    empty: list[Parts]
    repositories: set[Parts]
    owners: Mapping[Parts, int]


@contextmanager
def opened(source: Path, bounds: Bounds) -> Iterator[Tree]:
    """
    Yield a source; its files can be read inside the context.

    :param source: a folder or a zip file
    :raises NotTakenInError: if the source is neither of these, damaged, or too large
    """
    try:
        kind = source.stat().st_mode
    except OSError as error:
        what = f'{source}: cannot be read: {str(error.strerror).lower()}.'
        raise NotTakenInError(what) from error
    meter = _Meter(str(source), bounds)
    if stat.S_ISDIR(kind):
        yield _tree(source.resolve().name, _in_folder(source, (), meter), meter)
        return
    try:
        if not stat.S_ISREG(kind):
            raise zipfile.BadZipFile('something else')
        with zipfile.ZipFile(source) as archive:
            yield _tree(source.stem, _in_zip(archive, meter), meter)
    except _DAMAGED as error:
        raise NotTakenInError(
            f'{source}: the zip file cannot be read: {error}.',
            'Try: download or pack it again, or give the unpacked folder',
        ) from error


class _Meter:
    """Count the bytes that are read from a source; a file that is read again counts once."""

    def __init__(self, where: str, bounds: Bounds) -> None:
        self.where, self.bounds = where, bounds
        self.known: set[Parts] = set()
        self.count = 0

    def within(self, parts: Parts, data: bytes) -> bytes:
        """
        Count the bytes of a file, and return them.

        :raises NotTakenInError: if all files together are too large
        :raises UnreadableError: if this file is too large
        """
        self.count += 0 if parts in self.known else len(data)
        self.known.add(parts)
        if self.count > self.bounds.whole_bytes:
            raise self.bounds.refusal(self.where, f'more than {self.bounds.whole_bytes >> 20} MiB')
        if len(data) > self.bounds.file_bytes:
            raise UnreadableError(f'more than {self.bounds.file_bytes >> 20} MiB')
        return data


def _is_folder() -> bytes:
    """Mark a folder, which has no content."""
    raise UnreadableError('a folder')


def _tree(name: str, names: Iterable[File], meter: _Meter) -> Tree:
    """
    Return the tree of a source from its files and folders.

    :raises NotTakenInError: if there are too many
    """
    files: dict[Parts, File] = {}
    refused: list[tuple[str, str]] = []
    folders: set[Parts] = set()
    repositories: set[Parts] = set()
    owners: dict[Parts, int] = {}
    bounds, noise = meter.bounds, 0
    for count, one in enumerate(names, 1):
        noise += one.trouble == _NOISE
        for found, most in ((count, bounds.listed), (count - noise, bounds.entries)):
            if found > most:
                raise bounds.refusal(meter.where, f'more than {most} files')
        above = one.parts[:-1]
        if one.trouble == _NOISE:
            if above and (above in folders or not bounds.trouble(above)):
                folders.add(above)
                repositories |= {above} if one.parts[-1] == '.git' else set()
            continue
        if one.owner is not None:
            owners[one.parts] = one.owner
        twice = 'a name that occurs twice' if one.parts in files else ''
        unsafe = bounds.trouble(one.parts)
        if trouble := unsafe or one.trouble or twice:
            refused.append(('/'.join(one.parts)[: bounds.name_chars], trouble))
            folders |= set() if unsafe else {above}
        elif one.read is _is_folder:
            folders.add(one.parts)
        else:
            files[one.parts] = one
    used = {parts[:depth] for parts in files for depth in (1, 2)}
    empty = sorted({parts[:2] for parts in folders} - {(), *used})
    ordered = tuple(files[parts] for parts in sorted(files))
    return Tree(name, ordered, refused, empty, repositories, owners)


def _in_folder(folder: Path, above: Parts, meter: _Meter) -> Iterator[File]:
    """Yield all files and folders in order, without following links."""
    with os.scandir(folder) as entries:
        inside = sorted(entries, key=lambda entry: entry.name)
    for entry in inside:
        parts, path = (*above, entry.name), Path(entry.path)
        facts = entry.stat(follow_symlinks=False)
        here, owner = stat.S_ISDIR(facts.st_mode), facts.st_uid
        marked = (parts,) if here and os.path.lexists(path / COLCON_MARK) else ()
        if meter.bounds.is_noise(parts, marked):
            yield File(parts, _is_folder, _NOISE)
        elif not here:
            trouble = '' if stat.S_ISREG(facts.st_mode) else SPECIAL
            yield File(parts, partial(_read_path, path, parts, owner, meter), trouble, owner)
        elif len(parts) >= DEEPEST:
            yield File(parts, _is_folder, 'a path that is far too long', owner)
        else:
            try:
                yield File(parts, _is_folder, '', owner)
                yield from _in_folder(path, parts, meter)
            except PermissionError:  # in nbgrader's exchange, a student's folder may be unreadable
                trouble = 'a folder that cannot be read: permission denied'
                yield File(parts, _is_folder, trouble, owner)


def _read_path(path: Path, parts: Parts, owner: int, meter: _Meter) -> bytes:
    data, problems = read_file(path, '/'.join(parts), owner)
    if data is None:
        raise UnreadableError(problems[0].got)
    return meter.within(parts, data)


def _in_zip(archive: zipfile.ZipFile, meter: _Meter) -> Iterator[File]:
    inside = archive.infolist()
    # Do not split further than the allowed depth: a name may have thousands of slashes.
    paths = [tuple(_name_of(one).removesuffix('/').split('/', DEEPEST + 1)) for one in inside]
    marked = {parts[:-1] for parts in paths if parts[-1] == COLCON_MARK}
    for entry, parts in zip(inside, paths):
        heads = (parts[:count] for count in range(1, len(parts) + 1))
        noise = next((one for one in heads if meter.bounds.is_noise(one, marked)), None)
        if noise is not None:
            yield File(noise, _is_folder, _NOISE)
        elif entry.is_dir():
            yield File(parts, _is_folder)
        else:
            read = partial(_read_entry, archive, entry, parts, meter)
            yield File(parts, read, _trouble_with_entry(entry))


def _name_of(entry: zipfile.ZipInfo) -> str:
    """
    Return the name of an entry, decoded as UTF-8 if possible.

    macOS's Finder and ``zip`` write UTF-8 without its flag, and then Python decodes code page 437.
    """
    if not entry.flag_bits & _UTF_8:
        with suppress(UnicodeError):
            return entry.orig_filename.encode('cp437').decode('utf-8')
    return entry.orig_filename


def _read_entry(
    archive: zipfile.ZipFile, entry: zipfile.ZipInfo, parts: Parts, meter: _Meter
) -> bytes:
    data = bytearray()
    try:
        with archive.open(entry) as file:  # do not trust the size that the zip claims
            while len(data) <= meter.bounds.file_bytes and (more := file.read(_CHUNK)):
                data += more
    except (*_DAMAGED, RuntimeError) as error:
        meter.within(parts, bytes(data))
        raise UnreadableError(f'a damaged entry ({error})') from error
    return meter.within(parts, bytes(data))


def _trouble_with_entry(entry: zipfile.ZipInfo) -> str:
    if stat.S_IFMT(entry.external_attr >> 16) not in (0, stat.S_IFREG):
        return SPECIAL
    if entry.flag_bits & 0x1:
        return 'an encrypted file'
    return '' if entry.compress_type in _COMPRESSIONS else 'an unusual compression'

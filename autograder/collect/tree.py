"""
A source of submissions as a list of files: a folder, or a zip that is never unpacked.

Everything in it was named by somebody else.  Only regular files are listed, whatever a zip says of
itself is not believed, nothing is followed that leads elsewhere, and every file is read anew and
no further than the largest notebook.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
import os
from pathlib import Path
import stat
import zipfile
import zlib

from autograder.errors import GraderError
from autograder.handed_in.submission import MAX_BYTES
from autograder.whole_class.inbox import read_file

MOST_ENTRIES = 50_000
DEEPEST = 12
LONGEST_NAME = 400
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
    """

    name: str
    files: tuple[File, ...]
    refused: tuple[tuple[str, str], ...]


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
        yield _of_folder(source)
        return
    if not stat.S_ISREG(kind) or not zipfile.is_zipfile(source):
        raise NotCollectedError(
            f'{source}: expected a folder or a zip file, got something else.',
            'Try: the zip as it was downloaded, or the folder it was unpacked to',
        )
    try:
        with zipfile.ZipFile(source) as archive:
            yield _of_zip(source.name, archive)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError) as error:
        raise NotCollectedError(
            f'{source}: expected a zip file that can be read, got: {error}.',
            'Try: download it again',
        ) from error


def _of_folder(folder: Path) -> Tree:
    files: list[File] = []
    refused: list[tuple[str, str]] = []
    for count, (parts, path) in enumerate(_walk(folder, ()), 1):
        if count > MOST_ENTRIES:
            raise _too_much(str(folder))
        where = '/'.join(parts)
        if trouble := _trouble(parts):
            refused.append((where, trouble))
        elif not stat.S_ISREG(path.lstat().st_mode):
            refused.append((where, 'a link or a special file'))
        else:
            files.append(File(parts, partial(_read_path, path, where)))
    return Tree(folder.name, tuple(files), tuple(refused))


def _walk(folder: Path, above: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Path]]:
    """Yield everything but folders, in order; no link is followed."""
    with os.scandir(folder) as entries:
        inside = sorted(entries, key=lambda entry: entry.name)
    for entry in inside:
        parts = (*above, entry.name)
        if not entry.is_dir(follow_symlinks=False):
            yield parts, Path(entry.path)
        elif entry.name != '.git' and len(parts) < DEEPEST:
            yield from _walk(Path(entry.path), parts)


def _read_path(path: Path, where: str) -> bytes:
    data, problems = read_file(path, where)
    if data is None:
        raise UnreadableError(problems[0].got if problems else 'nothing')
    return data


def _of_zip(name: str, archive: zipfile.ZipFile) -> Tree:
    entries = archive.infolist()
    if len(entries) > MOST_ENTRIES:
        raise _too_much(name)
    files: dict[tuple[str, ...], File] = {}
    refused: list[tuple[str, str]] = []
    for entry in entries:
        if entry.is_dir():
            continue
        parts = tuple(entry.orig_filename.split('/'))
        trouble = _trouble(parts) or _trouble_with_entry(entry)
        if not trouble and parts in files:
            trouble = 'a name that is there twice'
        if trouble:
            refused.append((entry.orig_filename[:LONGEST_NAME], trouble))
        else:
            files[parts] = File(parts, partial(_read_entry, archive, entry))
    ordered = sorted(files.values(), key=lambda file: file.parts)
    return Tree(name.removesuffix('.zip'), tuple(ordered), tuple(refused))


def _read_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    try:
        with archive.open(entry) as file:
            data = file.read(MAX_BYTES + 1)  # what it says of its size is not asked
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise UnreadableError(f'a damaged entry ({error})') from error
    if len(data) > MAX_BYTES:
        raise UnreadableError(f'more than {MAX_BYTES >> 20} MiB')
    return data


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


def _too_much(where: str) -> NotCollectedError:
    return NotCollectedError(
        f'{where}: expected the submissions of a class, got more than {MOST_ENTRIES} files.',
        'Try: the folder with the submissions alone',
    )

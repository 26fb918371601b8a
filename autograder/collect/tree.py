"""
A source of submissions as a list of files: a folder, or a zip that is never unpacked.

Everything in it was named by somebody else.  Only regular files are listed, whatever a zip says of
itself is not believed, nothing is followed that leads elsewhere, and every file is read anew, no
further than the largest notebook, and all of them no further than :data:`MOST_BYTES`.  What
programs leave beside people's work is in no list: see :data:`NOISE`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
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
MOST_BYTES = 2 << 30
"""Bound on all that is read of one source, unpacked: a class has some hundred megabytes."""
DEEPEST = 12
LONGEST_NAME = 400
NOISE = frozenset({'__MACOSX', '.DS_Store', '.ipynb_checkpoints', '.git'})
"""Made by macOS, Jupyter and git; ``._NAME`` is macOS's too, and may end in ``.ipynb``."""
_CHUNK = 1 << 20
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
    """

    name: str
    files: tuple[File, ...]
    refused: tuple[tuple[str, str], ...]
    empty: tuple[tuple[str, ...], ...] = ()


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


def _of_folder(folder: Path, budget: Budget) -> Tree:
    files: list[File] = []
    refused: list[tuple[str, str]] = []
    folders: list[tuple[str, ...]] = []
    for count, (parts, path, trouble) in enumerate(_walk(folder, ()), 1):
        if count > MOST_ENTRIES:
            raise _too_much(str(folder))
        where = '/'.join(parts)
        trouble = trouble or _trouble(parts)
        kind = path.lstat().st_mode
        if trouble:
            refused.append((where, trouble))
        elif stat.S_ISDIR(kind):
            folders.append(parts)
        elif not stat.S_ISREG(kind):
            refused.append((where, 'a link or a special file'))
        else:
            files.append(File(parts, partial(_read_path, path, where, budget)))
    return _tree(folder.resolve().name, files, refused, folders)


def _walk(folder: Path, above: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Path, str]]:
    """Yield everything in order, with what is wrong with it; no link is followed."""
    with os.scandir(folder) as entries:
        inside = sorted(entries, key=lambda entry: entry.name)
    for entry in inside:
        parts, path = (*above, entry.name), Path(entry.path)
        if _is_noise(parts):
            continue
        if not entry.is_dir(follow_symlinks=False):
            yield parts, path, ''
        elif len(parts) >= DEEPEST:
            yield parts, path, 'a path that is far too long'
        else:
            try:
                yield parts, path, ''
                yield from _walk(path, parts)
            except PermissionError:  # one student's folder, as exchanges have them
                yield parts, path, 'a folder that cannot be read: permission denied'


def _tree(
    name: str,
    files: Sequence[File],
    refused: Sequence[tuple[str, str]],
    folders: Iterable[tuple[str, ...]],
) -> Tree:
    """Return a tree, with those folders as empty in which nothing was found."""
    found = [file.parts for file in files] + [tuple(where.split('/')) for where, _ in refused]
    used = {parts[:count] for parts in found for count in (1, 2)}
    empty = sorted({parts[:2] for parts in folders} - used)
    ordered = sorted(files, key=lambda file: file.parts)
    return Tree(name, tuple(ordered), tuple(refused), tuple(empty))


def _is_noise(parts: Sequence[str]) -> bool:
    return any(part in NOISE or part.startswith('._') for part in parts)


def _read_path(path: Path, where: str, budget: Budget) -> bytes:
    data, problems = read_file(path, where)
    if data is None:
        raise UnreadableError(problems[0].got if problems else 'nothing')
    budget.spend(where, len(data))
    return data


def _of_zip(name: str, archive: zipfile.ZipFile, budget: Budget) -> Tree:
    entries = archive.infolist()
    if len(entries) > MOST_ENTRIES:
        raise _too_much(name)
    files: dict[tuple[str, ...], File] = {}
    refused: list[tuple[str, str]] = []
    folders: list[tuple[str, ...]] = []
    for entry in entries:
        parts = tuple(entry.orig_filename.removesuffix('/').split('/'))
        if _is_noise(parts):
            continue
        trouble = _trouble(parts)
        if entry.is_dir():
            folders += [] if trouble else [parts]
            continue
        trouble = trouble or _trouble_with_entry(entry)
        if not trouble and parts in files:
            trouble = 'a name that is there twice'
        if trouble:
            refused.append((entry.orig_filename[:LONGEST_NAME], trouble))
        else:
            files[parts] = File(parts, partial(_read_entry, archive, entry, budget))
    return _tree(name.removesuffix('.zip'), list(files.values()), refused, folders)


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


def _too_much(where: str) -> NotCollectedError:
    return NotCollectedError(
        f'{where}: expected the submissions of a class, got more than {MOST_ENTRIES} files.',
        'Try: the folder with the submissions alone',
    )

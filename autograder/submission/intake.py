"""
What is handed in besides a notebook: a Python script, a ROS package folder, or a zip of one.

All of it becomes texts by relative path and is never unpacked on the grader's own disk.  A zip is
read entry by entry and counted as it is read, whatever its table of contents says: regular files
only, no links, no absolute path, nothing above its own folder, bounded in number and in size.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
import os
from pathlib import Path, PurePosixPath
import re
import stat
import zipfile
import zlib

from autograder.errors import GraderError
from autograder.submission.package import KINDS
from autograder.submission.reading import read_file

MOST_ENTRIES = 2000
MOST_FILES = 200
LARGEST_ZIP = 8 << 20
LARGEST_FILE = 1 << 20
LARGEST_WHOLE = 8 << 20
DEEPEST = 12
LONGEST_NAME = 200
LEFT_OUT = {'build', 'install', 'log', '__pycache__', '__MACOSX', 'node_modules'}
"""Folders that tools make; their content is not a student's work."""

MANIFEST = 'package.xml'
NO_MODULES = {'test', 'tests', 'launch', 'config', 'msg', 'srv', 'action', 'resource', 'answers'}
_ENTRY_POINT = re.compile(r'\b(?P<name>\w+)\s*=\s*(?P<module>[\w.]+)\s*:\s*(?P<call>\w+)')
_TAKEN = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


class NotTakenInError(GraderError):
    """What was handed in cannot be used as it is, and nothing of it was run."""


def read_handed_in(path: Path) -> dict[str, str]:
    """
    Return the texts of a script, a package folder or a zip file by relative path.

    :param path: a ``.py`` file, a folder or a ``.zip`` file; of several folders inside, the one
        with the package counts
    :raises NotTakenInError: if it is none of them, or not safe to take in
    """
    if path.is_dir():
        return in_package(read_folder(path), str(path))
    if path.suffix == '.py':
        return {path.name: _text(_bytes_of(path))}
    if path.suffix == '.zip':
        return in_package(read_zip(path), str(path))
    kind = 'another file' if path.exists() else 'nothing of that name'
    raise NotTakenInError(
        f'{path}: expected a Python script, a package folder, a zip file or a notebook, '
        f'got {kind}.'
    )


def read_folder(folder: Path) -> dict[str, str]:
    """
    Return the texts of a folder by relative path; links are not followed.

    :raises NotTakenInError: if it holds too much for a package
    """
    found: dict[str, str] = {}
    size = 0
    for entries, (name, path) in enumerate(_walk(folder), 1):
        if entries > MOST_ENTRIES:
            raise _too_much(str(folder), f'more than {MOST_ENTRIES} files')
        if PurePosixPath(name).suffix in KINDS and not path.is_symlink() and path.is_file():
            if not _is_plain(name):
                raise NotTakenInError(
                    f'{folder}, {name[:80]!a}: expected the files of a package, got a name with '
                    'characters that no package needs.',
                    'Try: rename that file.',
                )
            data = _bytes_of(path)
            size += len(data)
            _bound(str(folder), len(found) + 1, size)
            found[name] = _text(data)
    return found


def _walk(folder: Path) -> Iterator[tuple[str, Path]]:
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(one for one in folders if not _is_left_out(one))
        for name in sorted(files):
            if not name.startswith('.'):
                path = Path(place, name)
                yield path.relative_to(folder).as_posix(), path


def _is_left_out(part: str) -> bool:
    return part in LEFT_OUT or part.startswith('.')


def _bytes_of(path: Path) -> bytes:
    data, problems = read_file(path, str(path))
    if data is None or problems:
        raise NotTakenInError(problems[0].line() if problems else f'{path}: cannot be read.')
    if len(data) > LARGEST_FILE:
        raise _too_much(str(path), f'{len(data)} bytes')
    return data


def read_zip(path: Path) -> dict[str, str]:
    """
    Return the texts of a zip file by relative path.

    :raises NotTakenInError: if it is broken, or holds anything but a package's regular files
    """
    size = path.lstat().st_size
    if not stat.S_ISREG(path.lstat().st_mode):
        raise NotTakenInError(f'{path}: expected a regular file, got a link or something else.')
    if size > LARGEST_ZIP:
        raise _too_much(str(path), f'{size} bytes')
    try:
        with zipfile.ZipFile(path) as archive:
            return _entries(archive, path.name)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise NotTakenInError(
            f'{path}: expected a zip file that can be read, got: {error}.',
            'Try: pack the package folder again.',
        ) from error


def _entries(archive: zipfile.ZipFile, where: str) -> dict[str, str]:
    entries = archive.infolist()
    if len(entries) > MOST_ENTRIES:
        raise _too_much(where, f'{len(entries)} entries')
    found: dict[str, str] = {}
    size = 0
    for entry in entries:
        name = _safe_name(entry, where)
        parts = PurePosixPath(name).parts
        if entry.is_dir() or any(_is_left_out(part) for part in parts):
            continue
        if PurePosixPath(name).suffix not in KINDS:
            continue
        if name in found:
            raise NotTakenInError(f'{where}: {name!r} is in it twice.', 'Try: pack it again.')
        with archive.open(entry) as file:
            data = file.read(LARGEST_FILE + 1)  # what it says of its size is not asked
        size += len(data)
        if len(data) > LARGEST_FILE:
            raise _too_much(f'{where}, {name}', f'more than {LARGEST_FILE >> 20} MiB')
        _bound(where, len(found) + 1, size)
        found[name] = _text(data)
    _no_file_is_a_folder(found, where)
    return found


def _is_plain(name: str) -> bool:
    """Return whether a name can be printed, and means the same on every system."""
    return name.isprintable() and '\\' not in name and len(name) <= LONGEST_NAME


def _safe_name(entry: zipfile.ZipInfo, where: str) -> str:
    """Return an entry's path if it stays inside and is a regular file or a folder."""
    name = entry.orig_filename
    parts = name.rstrip('/').split('/')
    trouble = ''
    kind = stat.S_IFMT(entry.external_attr >> 16)
    if not _is_plain(name):
        trouble = 'a name with characters that no package needs'
    elif name.startswith('/') or re.match(r'^[A-Za-z]:', name):
        trouble = 'an absolute path'
    elif {'', '.', '..'} & set(parts):
        trouble = 'a path that leads elsewhere'
    elif len(parts) > DEEPEST:
        trouble = f'folders more than {DEEPEST} deep'
    elif kind not in (0, stat.S_IFREG, stat.S_IFDIR):
        trouble = 'a link or a special file'
    elif entry.flag_bits & 0x1:
        trouble = 'an encrypted file'
    elif entry.compress_type not in _TAKEN:
        trouble = 'an unusual compression'
    if trouble:
        raise NotTakenInError(
            f'{where}, {name[:80]!r}: expected the regular files of a package, got {trouble}.',
            'Try: pack the package folder again, without links.',
        )
    return name.rstrip('/')


def _no_file_is_a_folder(found: Mapping[str, str], where: str) -> None:
    for name in found:
        for above in PurePosixPath(name).parents:
            if above.as_posix() in found:
                raise NotTakenInError(f'{where}: {above} is both a file and a folder.')


def _bound(where: str, files: int, size: int) -> None:
    if files > MOST_FILES:
        raise _too_much(where, f'more than {MOST_FILES} files of a package')
    if size > LARGEST_WHOLE:
        raise _too_much(where, f'more than {LARGEST_WHOLE >> 20} MiB')


def _too_much(where: str, got: str) -> NotTakenInError:
    return NotTakenInError(
        f'{where}: expected the files of one package, got {got}.',
        'Try: hand in the package folder alone.',
    )


def _text(data: bytes) -> str:
    return data.decode('utf-8', 'replace')


# -- a package among the files ----------------------------------------------------------------


def in_package(files: Mapping[str, str], where: str) -> dict[str, str]:
    """
    Return the files of the one package as seen from its own folder.

    :param files: of a package, or of a folder somewhere in which a package lies
    :raises NotTakenInError: if there are several packages
    """
    roots = sorted(
        PurePosixPath(name).parent for name in files if PurePosixPath(name).name == MANIFEST
    )
    if len(roots) > 1:
        names = ', '.join(str(root) for root in roots[:5])
        raise NotTakenInError(
            f'{where}: expected one package, got {len(roots)}: {names}.',
            'Try: name the folder of one of them.',
        )
    tops = {PurePosixPath(name).parts[0] for name in files}
    if roots:
        root = roots[0]
    elif len(tops) == 1 and tops.isdisjoint(files):
        root = PurePosixPath(tops.pop())
    else:
        root = PurePosixPath('.')
    return {
        PurePosixPath(name).relative_to(root).as_posix(): text
        for name, text in files.items()
        if PurePosixPath(name).is_relative_to(root)
    }


def with_node_files(files: Mapping[str, str], wanted: Iterable[str]) -> dict[str, str]:
    """
    Return the files with each wanted node at the top, where exams look for it.

    What counts is the file of that name in the package's own folders; else the module that
    ``setup.py`` or ``setup.cfg`` makes the executable of that name from.

    :param wanted: node files such as ``talker.py``
    """
    found = dict(files)
    for name in wanted:
        if name in found or not name.endswith('.py'):
            continue
        if any(path.startswith(f'{name}/') for path in files):
            continue  # a folder of the node's name: no file can be put there
        text = _node_text(files, name)
        if text is not None:
            found[name] = text
    return found


def _node_text(files: Mapping[str, str], name: str) -> str | None:
    stem = name.removesuffix('.py')
    for setup in ('setup.py', 'setup.cfg'):
        for match in _ENTRY_POINT.finditer(files.get(setup, '')):
            path = match['module'].replace('.', '/') + '.py'
            if match['name'] == stem and path in files:
                if match['call'] == 'main':
                    return files[path]
                module, call = match['module'], match['call']
                return f'import sys\n\nfrom {module} import {call}\n\nsys.exit({call}())\n'
    places = [
        path
        for path in files
        if path.endswith(f'/{name}') and not NO_MODULES & set(PurePosixPath(path).parts)
    ]
    return files[min(places, key=lambda path: (path.count('/'), path))] if places else None

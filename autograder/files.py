"""Write files atomically, replace existing files only on request, list files and zip them."""

from collections.abc import Iterable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from datetime import date
import fcntl
import hashlib
import io
import json
import os
from pathlib import Path
import stat
from typing import Any
from urllib.parse import quote
import uuid
import zipfile

from autograder.errors import GraderError

LONGEST_NAME = 150
"""Longest name from :func:`safe_name` [bytes]; file systems allow 255, including the suffix."""
DIGEST_CHARS = 16


def refuse_existing(paths: Iterable[Path], force: bool) -> None:
    """Raise a GraderError if a path is a folder, or exists and may not be replaced."""
    for path in paths:
        if path.is_dir():
            raise GraderError(f'{path}: cannot write a file here, because this is a folder.')
        if os.path.lexists(path) and not force:
            raise GraderError(
                f'{path}: this file already exists.',
                'Try: --force to replace it, or --to with a different name',
            )


def json_bytes(data: Any) -> bytes:
    """Return a JSON document in UTF-8, in which question marks replace lone surrogates."""
    text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False)
    return f'{text}\n'.encode('utf-8', 'replace')


def safe_name(student: str) -> str:
    """
    Return a safe file name for any student id; different ids have different names.

    The name has six characters or more for each letter outside ASCII.  If the name is too long,
    its end is replaced by ``~~`` and a digest of the whole id; no other name contains ``~~``.
    """
    name = quote(student, safe='').replace('~', '~7E').replace('%', '~') or '~'
    if name.startswith('.'):
        name = name.replace('.', '~2E', 1)
    if len(name) <= LONGEST_NAME:
        return name
    end = f'~~{hashlib.sha256(student.encode()).hexdigest()[:DIGEST_CHARS]}'
    return name[: LONGEST_NAME - len(end)] + end


def write_atomically(path: Path, data: bytes, mode: int = 0o666, lasting: bool = True) -> None:
    """
    Write a file atomically.

    A lasting file is renamed only after its content is on the disk; otherwise a power failure
    could leave an empty file.

    :param path: the file; a missing folder is created
    :param mode: permissions before the process's umask is applied
    :param lasting: whether to wait for the disk; not needed for a file that can be created again
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f'.{path.name}.{uuid.uuid4().hex}')
    try:
        descriptor = os.open(unfinished, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode)
        with os.fdopen(descriptor, 'wb') as file:
            # The lock prevents another command's clean-up from removing the file.
            fcntl.flock(file, fcntl.LOCK_EX)
            file.write(data)
            file.flush()
            if lasting:
                os.fsync(descriptor)
            unfinished.replace(path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise
    if not lasting:
        return
    folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def files_below(root: Path, part: str, left_out: AbstractSet[str]) -> Iterator[tuple[str, Path]]:
    """Yield a file or all files of a folder with their paths in ``root``, but no inner links."""
    start = root / part
    for path in start.rglob('*') if start.is_dir() else [start]:
        inside = path.relative_to(root)
        linked = path.is_symlink() and path != start
        if path.is_file() and not linked and left_out.isdisjoint(inside.parts):
            yield inside.as_posix(), path


def zip_content(path: Path) -> tuple[bytes, int]:
    """Return a file's content and its permissions in a zip: 0o755 if executable, else 0o644."""
    return path.read_bytes(), 0o755 if path.stat().st_mode & stat.S_IXUSR else 0o644


def zip_bytes(files: Mapping[str, tuple[bytes, int]]) -> bytes:
    """Return a zip of contents and permissions by name; on the same day, the same bytes."""
    made, today = io.BytesIO(), date.today()
    with zipfile.ZipFile(made, 'w', zipfile.ZIP_DEFLATED) as archive:
        for name, (data, mode) in sorted(files.items()):
            entry = zipfile.ZipInfo(name, date_time=(today.year, today.month, today.day, 0, 0, 0))
            entry.create_system = 3  # Unix, where the upper half of external_attr is st_mode.
            entry.external_attr = (stat.S_IFREG | mode) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)
    return made.getvalue()

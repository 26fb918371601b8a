"""Keep the temporary files of a grading run in one folder; the next run removes leftovers."""

from collections.abc import Iterator
from contextlib import contextmanager
import fcntl
import os
from pathlib import Path
import shutil
import tempfile

FOLDERS = 'grading-'
"""Prefix of the folders' names."""


@contextmanager
def grading_folder() -> Iterator[Path]:
    """
    Yield a folder for all temporary files of this process, and remove it afterwards.

    First remove the folders that killed grading runs have left behind.
    """
    above = Path(tempfile.gettempdir())
    for left in above.glob(f'{FOLDERS}*'):
        _remove_if_left(left)
    folder, lock = _made(above)
    before, tempfile.tempdir = tempfile.tempdir, str(folder)
    try:
        yield folder
    finally:
        tempfile.tempdir = before
        os.close(lock)
        shutil.rmtree(folder, ignore_errors=True)


def _made(above: Path) -> tuple[Path, int]:
    """Create a folder and lock it; the kernel releases the lock when the process ends."""
    while True:
        folder = Path(tempfile.mkdtemp(prefix=FOLDERS, dir=above))
        folder.chmod(0o711)  # the temporary users of the sandboxes need access to subfolders
        lock = os.open(folder / 'lock', os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        fcntl.flock(lock, fcntl.LOCK_EX)
        if os.fstat(lock).st_nlink:
            return folder, lock
        os.close(lock)  # another grading run removed the folder before it was locked


def _remove_if_left(folder: Path) -> None:
    try:
        if folder.lstat().st_uid != os.geteuid() or folder.is_symlink():
            return
        lock = os.open(folder / 'lock', os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC)
    except OSError:
        return  # another grading run is creating or removing the folder
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        shutil.rmtree(folder, ignore_errors=True)
    except BlockingIOError:
        pass  # the grading run that owns the folder has not ended
    finally:
        os.close(lock)

"""
Locate nbgrader's exchange, and set the modes that protect the work in it.

All students on a machine share it. The sticky bit lets them remove and rename only their own
files.
"""

from collections.abc import Mapping
from contextlib import suppress
import glob
import os
from pathlib import Path
import stat

from environment.places import stated

SETTING = 'COURSE_EXCHANGE'
"""Environment variable with a folder that replaces the course's own exchange."""
ROOT_MODE = 0o1777
"""Every user may write; nbgrader itself uses 0777, without the sticky bit."""


def exchange_root(project: Path, environ: Mapping[str, str]) -> Path:
    """Return the root folder of the exchange; a relative path refers to the course folder."""
    chosen = environ.get(SETTING)
    if chosen:
        return project / Path(chosen).expanduser()
    return project / stated(project, 'work') / 'exchange'


def unprotected(root: Path) -> list[tuple[Path, int]]:
    """Return the folders, if any, in which users can remove others' work, with correct modes."""
    # glob, unlike Path.glob, skips folders that this user may not read.
    inbound = sorted(glob.glob(f'{glob.escape(str(root))}/*/inbound'))
    found = []
    for path, needed in ((str(root), ROOT_MODE), *((one, stat.S_ISVTX) for one in inbound)):
        with suppress(OSError):
            mode = stat.S_IMODE(os.stat(path).st_mode)
            if mode & needed != needed:
                found.append((Path(path), mode | needed))
    return found


def protect(root: Path) -> None:
    """Set the correct modes of an exchange's folders, as far as this user's permissions allow."""
    for path, mode in unprotected(root):
        with suppress(PermissionError):  # `make doctor` lists what the owner has to change
            path.chmod(mode)

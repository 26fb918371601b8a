"""
Manage the learner's package: where and when cells are saved, and which files the grader reads.

Everything is next to the notebook, in a colcon workspace with the usual folders::

    ros_ws/src/my_robot_pkg/package.xml, CMakeLists.txt
                            msg/Speed.msg
                            my_robot_pkg/wheels.py

``check`` judges files, not the screen: if a cell was edited but not run, the file still has the
old contents.  A kernel does not see what a browser shows, so :func:`edited_since` reads the
notebook file, which JupyterLab saves every few seconds.
"""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
import os
from pathlib import Path
import re
from typing import NamedTuple

from autograder.layout import Layout
from autograder.submission.cells import CellFile
from roslab.error_hints import read_cells
from roslab.errors import NameRefusedError
from roslab.output import shell

WORKSPACE = 'ros_ws'
_PACKAGE_NAME = re.compile(r'^[a-z][a-z0-9]*(_[a-z0-9]+)*$')
_MOST_BYTES = 1_000_000
_MOST_NAMED = 3


@dataclass(frozen=True)
class LearnerPackage:
    """A package in the workspace next to the notebook."""

    name: str
    root: Path

    @property
    def workspace(self) -> Path:
        """The colcon workspace."""
        return self.root / WORKSPACE

    @property
    def folder(self) -> Path:
        """The source folder of the package."""
        return self.workspace / 'src' / self.name

    def path_of(self, cell: CellFile) -> Path:
        """Return the path of a cell's file; NameRefusedError if it is outside the package."""
        inside = f'{self.name}/{cell.path}' if cell.kind == 'node' else cell.path
        path = self.folder / inside
        if not path.resolve().is_relative_to(self.folder.resolve()):
            raise NameRefusedError(
                f'%%{cell.kind} {cell.name}: expected a file below {self.shown(self.folder)}, got '
                f'{path.resolve()}. A link leads out of the package; remove it.'
            )
        return path

    def find(self, name: str) -> Path:
        """Return the path of a file of the package, given by a key of :meth:`files`."""
        inner = self.folder / self.name / name
        return inner if name.endswith('.py') and inner.is_file() else self.folder / name

    def save(self, cell: CellFile) -> Path:
        """Write a cell's file atomically."""
        path = self.path_of(cell)
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_name(f'.{path.name}.{os.getpid()}.part')
        try:
            part.write_text(cell.body, encoding='utf-8')
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
        return path

    def shown(self, path: Path) -> str:
        """Return a path relative to the notebook's folder, as the learner sees it."""
        return str(path.relative_to(self.root)) if path.is_relative_to(self.root) else str(path)

    def files(self) -> dict[str, str]:
        """Return the contents of the package's files, by the paths that the grader uses."""
        found = {}
        for path in sorted(self.folder.rglob('*')):
            inside = path.relative_to(self.folder).as_posix()
            name = inside.removeprefix(f'{self.name}/') if path.suffix == '.py' else inside
            hidden = any(part.startswith(('.', '__pycache__')) for part in inside.split('/'))
            if path.is_file() and not hidden and path.stat().st_size <= _MOST_BYTES:
                found[name] = path.read_text(encoding='utf-8', errors='replace')
        return found


_name = ''  # empty until a package is chosen; until then, the course's own package is used


def package(name: str | None = None) -> str:
    """
    Choose the package in which cells are saved, and return its name.

    :param name: lower case, digits and single underscores, as ROS 2 requires; None keeps the
        current package
    :raises NameRefusedError: for any other name
    """
    global _name
    if name is not None:
        if not isinstance(name, str) or not _PACKAGE_NAME.match(name):
            raise NameRefusedError(
                f'package({name!r}): expected lower-case letters, digits and single underscores, '
                "as in package('my_robot_pkg')."
            )
        _name = name
    return _name or Layout.here().facts.package


def learner_package() -> LearnerPackage:
    """Return the current package, next to the running notebook."""
    return LearnerPackage(package(), Path.cwd())


_saves: dict[Path, tuple[int, int]] = {}
"""Execution number that saved each file, and the file's modification time afterwards [ns]."""


class SavedFile(NamedTuple):
    """
    A file of an exercise.

    :param execution: the n of the ``In [n]`` that saved the file, None if no cell of this kernel
        saved it
    :param modified_s: time of the last change [s since 1970]
    """

    path: Path
    execution: int | None
    modified_s: float

    def __str__(self) -> str:
        """Return the time of the save and the cell that saved the file, as text."""
        then, name = datetime.fromtimestamp(self.modified_s), self.path.name
        today = then.date() == datetime.now().date()
        clock = f'{then:%H:%M}' if today else f'{then:%d %b %H:%M}'
        unknown = self.execution is None
        by = 'another kernel or program' if unknown else f'In [{self.execution}]'
        return f'{name}, saved {clock} by {by}'


def note_save(path: Path) -> None:
    """Record that the running cell has saved a file."""
    history = getattr(getattr(shell(), 'history_manager', None), 'input_hist_raw', ())
    # The history ends with the running cell; the shell's own counter may already be higher.
    _saves[path] = max(0, len(history) - 1), path.stat().st_mtime_ns


def look_up(paths: Iterable[Path]) -> list[SavedFile]:
    """Return when and by which cells files were saved, in the order of saving."""
    found = []
    for path in paths:
        status = path.stat()
        number, saved_ns = _saves.get(path, (None, 0))
        # A different time means that another program has since written the file.
        execution = number if saved_ns == status.st_mtime_ns else None
        found.append(SavedFile(path, execution, status.st_mtime))
    return sorted(found, key=lambda file: file.modified_s)


def describe(files: Sequence[SavedFile]) -> str:
    """Return one line of text that names the judged files."""
    if len(files) <= _MOST_NAMED:
        return '; '.join(map(str, files))
    return f'{len(files)} files; the last one is {files[-1]}'


def edited_since(files: Collection[SavedFile]) -> list[str]:
    """
    Return the names of the files whose cell was edited after it had saved the file.

    The number of the cell in the saved notebook must be that of the run that saved the file.  If
    the notebook was saved before that run ended, its text may be older than the file.
    """
    bodies: dict[tuple[str, int | None], set[str]] = {}
    for cell in read_cells():
        if cell.file is not None:
            key = Path(cell.file.path).name, cell.execution
            bodies.setdefault(key, set()).add(cell.file.body)
    return [
        saved.path.name
        for saved in files
        if saved.execution is not None
        and (shown := bodies.get((saved.path.name, saved.execution)))
        and saved.path.read_text('utf-8', 'replace') not in shown
    ]

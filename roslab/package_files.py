"""
Manage the learner's package: where cells are saved, and which files the grader reads.

Everything is next to the notebook, in a colcon workspace with the usual folders::

    ros_ws/src/my_robot_pkg/package.xml, CMakeLists.txt
                            msg/Speed.msg
                            my_robot_pkg/wheels.py
"""

from dataclasses import dataclass
import os
from pathlib import Path
import re

from autograder.layout import Layout
from autograder.submission.cells import CellFile
from roslab.errors import NameRefusedError

WORKSPACE = 'ros_ws'
_PACKAGE_NAME = re.compile(r'^[a-z][a-z0-9]*(_[a-z0-9]+)*$')
_MOST_BYTES = 1_000_000


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
        """
        Return the path of a cell's file; Python files of nodes are in the inner folder.

        :raises NameRefusedError: if the path is outside the package
        """
        inside = f'{self.name}/{cell.path}' if cell.kind == 'node' else cell.path
        path = self.folder / inside
        if not path.resolve().is_relative_to(self.folder.resolve()):
            raise NameRefusedError(
                f'%%{cell.kind} {cell.name}: expected a file below {self.shown(self.folder)}, got '
                f'{path.resolve()}. A link leads out of the package; remove it.'
            )
        return path

    def find(self, name: str) -> Path:
        """
        Return the path of a file of the package.

        :param name: relative path, a key of :meth:`files`
        """
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

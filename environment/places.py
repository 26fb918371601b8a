"""Name the folders and files that the set-up creates, in the venv and next to it."""

from __future__ import annotations

from dataclasses import dataclass
import os
from pathlib import Path
import re
import tempfile

PROJECT = Path(__file__).resolve().parent.parent
LOCK_FILE = PROJECT / 'environment' / 'requirements.lock'
SHARED_MEMORY = Path('/dev/shm')
MESSAGES_FILE = PROJECT / 'environment' / 'messages.txt'
CLOCK_SOURCES = PROJECT / 'autograder' / 'clock'
FILE = 'course.toml'
UNSTATED = {'package': '', 'work': 'autograder/_work'}
"""Defaults for settings that ``course.toml`` does not contain."""
NO_PACKAGE = '-'
"""Replaces the package's name in the prefix if the course has none; no package can have it."""


def stated(project: Path, name: str) -> str:
    """
    Return a setting of ``course.toml``: the string in the line ``name = '...'``.

    :param name: one of :data:`UNSTATED`
    :raises ValueError: if the line has an unexpected form
    """
    file = project / FILE
    text = file.read_text(encoding='utf-8') if file.is_file() else ''
    # Python 3.10 has no tomllib.
    line = re.search(rf'^{name}\s*=(.*)$', text, re.MULTILINE)
    if not line:
        return UNSTATED[name]
    found = re.fullmatch(r"""\s*(['"])([\w./-]*)\1\s*(#.*)?""", line[1])
    if not found:
        raise ValueError(f"{file}: expected a line {name} = 'NAME', got {line[0]}")
    return found[2]


class Below:
    """A property that returns a path below the path in another attribute of the same object."""

    def __init__(self, base: str, *names: str) -> None:
        self.base, self.names = base, names

    def __get__(self, owner: object, _: type) -> Path:
        """Return the path; for a class, return the property itself, as ``property`` does."""
        if owner is None:
            return self  # type: ignore[return-value]
        return Path(getattr(owner, self.base), *self.names)


@dataclass(frozen=True)
class Places:
    """The paths of one prepared environment, from its absolute venv and the folder of a course."""

    venv: Path
    project: Path = PROJECT

    python = Below('venv', 'bin', 'python')
    """The interpreter of the venv."""
    notes = Below('venv', 'ros2_course')
    """The folder of stamps and logs, which the set-up keeps between runs."""
    ready = Below('notes', 'ready.json')
    """Written last: the digest of all inputs of the prepared environment."""
    cmake = Below('notes', 'cmake')
    """Copy of the CMake files inside the venv, visible in a sandbox that binds the venv."""
    terminal = Below('notes', 'terminal')
    """The shell that JupyterLab terminals start."""
    clock = Below('notes', 'clock')
    """The compiled virtual clock for the grader's runs."""
    workspace = Below('venv', 'workspace')
    """The colcon workspace with build, install and log."""

    @classmethod
    def of(cls, venv: str, project: Path = PROJECT) -> Places:
        """Return the places of a venv given as in `VENV=...`, relative to the project."""
        return cls(venv=Path(os.path.normpath(project / venv)), project=project)

    @property
    def lock(self) -> Path:
        """The lock file of the set-up; it is next to the venv, because the venv may be removed."""
        return self.venv.with_name(self.venv.name + '.lock')

    @property
    def package_name(self) -> str:
        """Name of the course's own ROS package; empty if it has none."""
        return stated(self.project, 'package')

    @property
    def prefix(self) -> Path:
        """Install prefix of the course's own ROS package."""
        return self.workspace / 'install' / (self.package_name or NO_PACKAGE)

    @property
    def package(self) -> Path:
        """Sources of the course's own ROS package."""
        return self.project / self.package_name

    @property
    def for_students(self) -> bool:
        """True if this copy of the course lacks the hidden exams, as students' copies do."""
        return not (self.project / 'exams' / 'hidden').is_dir()

    def site_packages(self) -> Path:
        """Return the folder of the installed packages, for any version of the venv's Python."""
        found = sorted(self.venv.glob('lib/python3.*/site-packages'))
        return found[0] if found else self.venv / 'lib' / 'site-packages'


def write_atomically(path: Path, text: str) -> None:
    """Write a file atomically: readers see the old or the new text, even after a kill."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f'.{path.name}.')
    with os.fdopen(handle, 'w', encoding='utf-8') as file:
        file.write(text)
    os.chmod(name, 0o644)
    os.replace(name, path)

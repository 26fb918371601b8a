"""
Read ``course.toml``, and find the folders and files of a course.

The grader works with any course.  It uses the course that ``--course`` names; without this option,
the course that contains the current folder; if there is none, the course in the project itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from functools import cached_property, lru_cache
import os
from pathlib import Path
import sys
from typing import Any

from autograder.errors import GraderError
from environment.places import Below, FILE, PROJECT, UNSTATED

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

CHOSEN = 'COURSE_DIR'
"""The environment variable that names the folder of the course; ``--course`` sets it."""

TABLES = ('messages', 'sections')


@dataclass(frozen=True)
class Facts:
    """
    The content of a ``course.toml``.

    :param name: name of the course in nbgrader
    :param package: the course's own ROS package, a folder in the root; ``''`` if there is none.
        Student programs can import only its messages, because its nodes are solutions
    :param work: folder for everything that grading writes, relative to the root
    :param messages: the course's own message types, each with the field that feedback suggests
        if a student uses a whole message instead of a value
    :param sections: sections of lessons that explain errors, named as in the ``read`` of a check,
        each with the ids of the causes that it explains
    """

    name: str = 'course'
    package: str = UNSTATED['package']
    work: str = UNSTATED['work']
    messages: Mapping[str, str] = field(default_factory=dict)
    sections: Mapping[str, Sequence[str]] = field(default_factory=dict)

    def section_about(self, cause_id: str) -> str:
        """Return the section that explains a cause, empty if none of :attr:`sections` does."""
        return next((name for name, ids in self.sections.items() if cause_id in ids), '')


def read_toml(path: Path) -> dict[str, Any]:
    """Return the content of a TOML file; OSError or ValueError if it cannot be read."""
    return tomllib.loads(path.read_text(encoding='utf-8'))


def read_facts(path: Path) -> Facts:
    """
    Return the content of a ``course.toml``, with the defaults of :class:`Facts`.

    :param path: the file; if it is missing, every field has its default
    :raises GraderError: if the file is not valid TOML, or contains an unknown name or a wrong type
    """
    try:
        found = read_toml(path) if path.is_file() else {}
    except (OSError, ValueError) as error:
        raise GraderError(
            f'{path}: cannot be read as TOML: {error}.', 'Try: correct the file'
        ) from error
    known = {one.name: one for one in fields(Facts)}
    for name, value in found.items():
        if name == 'exams':  # a setting of earlier versions
            raise GraderError(
                f'{path}: unknown name {name!r}.',
                'The exams are always in the folder exams. Try: delete this line',
            )
        if name not in known:
            raise GraderError(f'{path}: unknown name {name!r}.', f'Known: {", ".join(known)}.')
        if not isinstance(value, dict if name in TABLES else str):
            kind = 'a table' if name in TABLES else 'a string'
            raise GraderError(
                f'{path}: expected {kind} for {name}, got {value!r}.', 'Try: correct the file'
            )
    return Facts(**found)


def lesson_files(folder: Path) -> list[Path]:
    """Return the notebooks of all lessons in ``solutions/`` or ``notebooks/``, in lesson order."""
    # Skip hidden folders: JupyterLab keeps copies of notebooks in .ipynb_checkpoints/.
    return sorted(folder.glob('[!.]*/*.ipynb'))


@dataclass(frozen=True)
class Layout:
    """One course: its facts and its folders below ``root``, the folder with ``course.toml``."""

    root: Path

    exams = Below('root', 'exams')
    """The Python package with the subpackages ``visible`` and ``hidden``."""
    solutions = Below('root', 'solutions')
    """The folder with the source of every lesson."""
    notebooks = Below('root', 'notebooks')
    """The folder with the release of every lesson."""
    submitted = Below('work', 'submitted')
    """The folder with ``<student>/<assignment>/<notebook>.ipynb``."""
    secret = Below('work', 'course_secret')
    """The file with the course secret, from which hidden inputs are drawn."""
    collected = Below('work', 'collected.json')
    """The file with the work that ``collect`` has seen, collected or not."""
    class_list = Below('work', 'class_list.csv')
    """The file with the students of the class, written by instructors."""
    extensions = Below('work', 'extensions.csv')
    """The file with the extra time of individual students, written by instructors."""
    recordings = Below('work', 'recordings')
    """The folder of the recordings, named by digests of files, scenario and environment."""
    reports = Below('work', 'reports')
    """The folder of the HTML reports."""
    sample_class = Below('root', 'tests', 'submissions')
    """The folder of the bundled example submissions."""

    @classmethod
    def here(cls) -> Layout:
        """
        Return the current course.

        :raises GraderError: if ``COURSE_DIR`` names a folder without a course, or none is found
        """
        chosen, started = os.environ.get(CHOSEN), Path.cwd()
        folders = [Path(chosen).resolve()] if chosen else [started, *started.parents, PROJECT]
        for folder in folders:
            if (folder / FILE).is_file():
                return _course(folder, (folder / FILE).stat().st_mtime_ns)
        raise GraderError(
            f'{folders[0]}: this is not a course folder; it has no {FILE}.',
            'Try: cd to a course, or create one with new-course',
        )

    @cached_property
    def facts(self) -> Facts:
        """Return the content of ``course.toml``."""
        return read_facts(self.root / FILE)

    @property
    def work(self) -> Path:
        """Return the folder for everything that grading writes; git ignores it."""
        return self.root / self.facts.work

    def assignments(self) -> tuple[str, ...]:
        """Return the sorted names of all released assignments."""
        if not self.notebooks.is_dir():
            return ()
        return tuple(sorted({path.parent.name for path in lesson_files(self.notebooks)}))

    def assignment_named(self, name: str) -> str:
        """
        Return the full name of an assignment.

        :param name: with or without the number, or the number alone: ``07_temperature_monitor``,
            ``temperature_monitor``, ``07`` or ``7``
        :raises GraderError: if there is no such assignment; the error suggests a similar name
        """
        known = self.assignments()
        for one in known:
            if name == one or one.endswith(f'_{name}'):
                return one
        numbers = [one.partition('_')[0].lstrip('0') for one in known]
        if name.isdecimal() and numbers.count(name.lstrip('0')) == 1:
            return known[numbers.index(name.lstrip('0'))]
        close = get_close_matches(name, known, n=1, cutoff=0.3)
        raise GraderError(
            f'{name}: there is no such assignment.',
            f'Did you mean {close[0]}?' if close else f'Known: {", ".join(known) or "none"}.',
        )

    def release(self, assignment: str) -> Path:
        """Return the released notebook of an assignment; FileNotFoundError if there is none."""
        found = sorted((self.notebooks / assignment).glob('*.ipynb'))
        if not found:
            raise FileNotFoundError(
                f'notebooks/{assignment}/: there is no released notebook. '
                'Try: .venv/bin/autograder release'
            )
        return found[0]


@lru_cache(maxsize=8)
def _course(root: Path, written_ns: int) -> Layout:
    """Return the course in a folder; a new ``written_ns`` [ns] means that its file has changed."""
    return Layout(root)

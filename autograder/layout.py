"""
Read ``course.toml``, and find the folders and files of a course.

The grader serves any course.  It uses the one that ``--course`` names, else the one around the
current folder, else the course that the grader came with.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from functools import cached_property
import os
from pathlib import Path
import sys

from autograder.errors import GraderError
from environment.places import FILE, PROJECT, UNSTATED

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

CHOSEN = 'COURSE_DIR'
"""The environment variable that names the folder of the course; ``--course`` sets it."""


@dataclass(frozen=True)
class Facts:
    """
    The content of a ``course.toml``.

    :param name: what nbgrader calls the course
    :param exams: the Python package with ``visible`` and ``hidden`` exams, found from the root
    :param package: the course's own ROS package, a folder of the root; ``''`` if there is none.
        Programs see only its messages, as its nodes would be answers
    :param work: folder of everything that grading writes, from the root
    :param messages: the course's own message types -> the field that advice suggests if a learner
        uses a whole message instead of a value
    """

    name: str = 'course'
    exams: str = UNSTATED['exams']
    package: str = UNSTATED['package']
    work: str = UNSTATED['work']
    messages: Mapping[str, str] = field(default_factory=dict)


def read_facts(path: Path) -> Facts:
    """
    Return the content of a ``course.toml``, with the defaults of :class:`Facts`.

    :raises GraderError: if it is not valid TOML, or a name or a type in it is wrong
    """
    try:
        found = tomllib.loads(path.read_text(encoding='utf-8')) if path.is_file() else {}
    except (OSError, ValueError) as error:
        raise GraderError(
            f'{path}: this is not valid TOML: {error}.', 'Try: correct the file'
        ) from error
    known = {one.name: one for one in fields(Facts)}
    for name, value in found.items():
        if name not in known:
            raise GraderError(f'{path}: unknown name {name!r}.', f'Try: one of {", ".join(known)}')
        if not isinstance(value, dict if name == 'messages' else str):
            kind = 'a table' if name == 'messages' else 'a string'
            raise GraderError(
                f'{path}: expected {kind} for {name}, got {value!r}.', 'Try: correct the file'
            )
    return Facts(**found)


def lesson_files(folder: Path) -> list[Path]:
    """
    Return the notebooks of the lessons in their order.

    :param folder: ``solutions/`` or ``notebooks/`` of a course
    """
    # Not *: JupyterLab keeps a copy of START_HERE.ipynb in .ipynb_checkpoints/.
    return sorted(folder.glob('[!.]*/*.ipynb'))


@dataclass(frozen=True)
class Layout:
    """
    One course: its facts and its folders.

    :param root: the folder with ``course.toml``, ``solutions/``, ``notebooks/`` and
        ``nbgrader_config.py``
    """

    root: Path

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
                return cls(folder)
        raise GraderError(
            f'{folders[0]}: this is not the folder of a course; it has no {FILE}.',
            'Try: cd to a course, or create one with new-course',
        )

    @cached_property
    def facts(self) -> Facts:
        """Return the content of ``course.toml``."""
        return read_facts(self.root / FILE)

    @property
    def solutions(self) -> Path:
        """Return the folder with the source of every notebook."""
        return self.root / 'solutions'

    @property
    def notebooks(self) -> Path:
        """Return the folder of the generated notebooks that students receive."""
        return self.root / 'notebooks'

    @property
    def exams(self) -> Path:
        """Return the folder of the package of the exams."""
        return self.root.joinpath(*self.facts.exams.split('.'))

    @property
    def work(self) -> Path:
        """Return the folder for everything that grading writes; git ignores it."""
        return self.root / self.facts.work

    @property
    def submitted(self) -> Path:
        """Return the folder with ``<student>/<assignment>/<notebook>.ipynb``."""
        return self.work / 'submitted'

    @property
    def secret(self) -> Path:
        """Return the file with the secret from which hidden inputs are drawn."""
        return self.work / 'course_secret'

    @property
    def people(self) -> Path:
        """Return the file with the display names of students, by student id."""
        return self.work / 'people.json'

    @property
    def namesakes(self) -> Path:
        """Return the file with names that two people have, and with Moodle's numbers."""
        return self.work / 'namesakes.json'

    @property
    def not_collected(self) -> Path:
        """Return the file with the deliveries that could not be collected."""
        return self.work / 'not_collected.json'

    @property
    def class_list(self) -> Path:
        """Return the file with the students of the class, which instructors write."""
        return self.work / 'class_list.csv'

    @property
    def extensions(self) -> Path:
        """Return the file with the extra time of single students, which instructors write."""
        return self.work / 'extensions.csv'

    @property
    def delivered(self) -> Path:
        """Return the file with the names that platforms gave to collected files."""
        return self.work / 'delivered.json'

    @property
    def recordings(self) -> Path:
        """Return the folder of recordings, named by the digest of what was run."""
        return self.work / 'recordings'

    @property
    def reports(self) -> Path:
        """Return the folder of the HTML reports."""
        return self.work / 'reports'

    @property
    def sample_class(self) -> Path:
        """Return the folder of the bundled example submissions."""
        return self.root / 'tests' / 'submissions'

    def assignments(self) -> tuple[str, ...]:
        """Return the names of all released assignments, sorted."""
        if not self.notebooks.is_dir():
            return ()
        return tuple(sorted({path.parent.name for path in lesson_files(self.notebooks)}))

    def assignment_named(self, name: str) -> str:
        """
        Return the assignment with this name, with or without its number.

        :param name: with or without its number, ``07_temperature_monitor`` or
            ``temperature_monitor``
        :raises GraderError: if there is none of that name, with the nearest one
        """
        known = self.assignments()
        for one in known:
            if name == one or one.endswith(f'_{name}'):
                return one
        close = get_close_matches(name, known, n=1, cutoff=0.3)
        raise GraderError(
            f'{name}: there is no such assignment.',
            f'Did you mean {close[0]}?' if close else f'Known: {", ".join(known) or "none"}.',
        )

    def release(self, assignment: str) -> Path:
        """
        Return the released notebook of an assignment.

        :raises FileNotFoundError: if the assignment has no notebook, with the fix
        """
        found = sorted((self.notebooks / assignment).glob('*.ipynb'))
        if not found:
            raise FileNotFoundError(
                f'notebooks/{assignment}/: there is no released notebook. Try: make release'
            )
        return found[0]

"""
List the graded exercises of the course and the files of their reference solutions.

An exercise is an exam with the answers that it judges; everything here is derived from
``solutions/`` and from the exams, so a new exercise needs no change here.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
import hashlib
import inspect
from pathlib import Path
import sys

from autograder.exam import catalog
from autograder.exam.exam import Exam
from autograder.layout import Layout
from autograder.submission.notebook import read_release
from autograder.submission.submission import answer_files

LAYOUT = Layout.here()
GRADER = LAYOUT.root / 'autograder'
SHARED = (
    *sorted((GRADER / 'exam').glob('*.py')),
    *sorted((GRADER / 'exam').glob('*.txt')),
    *sorted((GRADER / 'judging').rglob('*.py')),
    *sorted((GRADER / 'judging').rglob('*.txt')),
    *sorted((GRADER / 'submission' / 'code').glob('*.py')),
)
"""The files that decide verdicts and causes, in addition to an exam's own modules."""


@dataclass(frozen=True)
class Exercise:
    """
    One graded exercise.

    :param files: the reference's files that its exam judges, relative path to text
    """

    exam: Exam
    files: Mapping[str, str]

    @property
    def name(self) -> str:
        """Return the exam's name."""
        return self.exam.name


@cache
def exercises() -> tuple[Exercise, ...]:
    """Return all graded exercises in the order of the course."""
    return tuple(
        Exercise(exam, dict(_files_of(exam)))
        for assignment in LAYOUT.assignments()
        for exam in catalog.for_assignment(assignment)
    )


def _files_of(exam: Exam) -> Iterator[tuple[str, str]]:
    """Yield the answers of the reference solution that an exam judges."""
    for grade_id, file in _reference(exam.assignment).items():
        if grade_id in exam.cells:
            yield file


@cache
def _reference(assignment: str) -> dict[str, tuple[str, str]]:
    """Return path and text of each answer of the reference solution, by grade id."""
    path = LAYOUT.solutions / assignment / LAYOUT.release(assignment).name
    found = answer_files(read_release(path))
    return {grade_id: (file.path, file.body) for grade_id, file in found.items()}


def digest(exercise: Exercise, *more: str) -> str:
    """
    Return a digest of all inputs to a verdict, except those that the hidden exam draws.

    :param more: further strings that determine the verdict
    :returns: 16 hexadecimal digits
    """
    state = hashlib.sha256()
    for path in sorted(_sources(exercise.exam)):
        state.update(path.read_bytes())
    for text in (*(f'{name}\0{text}' for name, text in sorted(exercise.files.items())), *more):
        state.update(b'\0' + text.encode())
    return state.hexdigest()[:16]


def _sources(exam: Exam) -> set[Path]:
    """Return the files that define an exam's scenario and checks."""
    found = set(SHARED)
    modules = [f'exams.{kind}.{exam.name}' for kind in ('visible', 'hidden')]
    while modules:
        __import__(name := modules.pop())
        path = Path(inspect.getfile(sys.modules[name]))
        if path not in found:
            found.update({path, *path.parent.glob(f'{path.stem}.yaml')})
            found.update(path.parent.glob(f'{path.stem}.txt'))
            modules += _exams_used_by(sys.modules[name])
    return found


def _exams_used_by(module: object) -> list[str]:
    """Return the other exam modules from which a module takes a function."""
    homes = {getattr(value, '__module__', '') for value in vars(module).values()}
    return [home for home in homes if str(home).startswith('exams.')]

"""
The exams of the course.

``visible/`` is shipped to learners: it is what ``check(...)`` runs in their notebook.  ``hidden/``
never leaves the instructor's machine and never enters a sandbox.  Both hold one module an exam,
named like it, with a module-level ``exam``.
"""

from __future__ import annotations

from functools import cache
import importlib
from pathlib import Path
import pkgutil
from types import ModuleType

from autograder.errors import ExamInvalid, GraderError, line_in
from autograder.exam.exam import Exam


def names(hidden: bool = True) -> tuple[str, ...]:
    """
    Return the names of all exams.

    :raises ExamInvalid: if this copy of the course has none of this kind
    """
    try:
        package = importlib.import_module(f'autograder.exams.{_folder(hidden)}')
    except ModuleNotFoundError:
        raise ExamInvalid(
            'The hidden exams are not part of this copy of the course.',
            'Grading needs the full project; visible checks work without it.',
        ) from None
    return tuple(module.name for module in pkgutil.iter_modules(package.__path__))


def _folder(hidden: bool) -> str:
    return 'hidden' if hidden else 'visible'


@cache
def load(name: str, hidden: bool = True) -> Exam:
    """
    Return an exam.

    :param name: as in the grade cell ``check('<name>')``
    :param hidden: the full exam, or the visible one that learners have
    :raises ExamInvalid: if there is none, with the names that exist; or if its file is broken
    """
    folder, known = _folder(hidden), names(hidden)
    if name not in known:
        raise ExamInvalid(f'There is no exam {name!r}.', f'Known: {", ".join(known)}.')
    exam = getattr(_module(folder, name), 'exam', None)
    if not isinstance(exam, Exam) or exam.name != name or not exam.checks:
        raise ExamInvalid(f'autograder/exams/{folder}/{name}.py defines no whole exam {name!r}.')
    if hidden and not exam.hidden:
        exam.hidden = True
        exam.facts['secret'] = True
    return exam


def _module(folder: str, name: str) -> ModuleType:
    """
    Return the module of an exam.

    :raises ExamInvalid: if its file cannot be imported, with file, line and message
    """
    try:
        return importlib.import_module(f'autograder.exams.{folder}.{name}')
    except GraderError:
        raise  # it has its place
    except Exception as error:  # noqa: BLE001 - whatever somebody's exam raises
        place = line_in(Path(__file__).parent, error) or f'exams/{folder}/{name}.py'
        said = ' '.join(str(getattr(error, 'msg', '') or error).split())
        raise ExamInvalid(
            f'autograder/{place}: {type(error).__name__}: {said}.', 'Try: correct that line'
        ) from error


def for_assignment(assignment: str, hidden: bool = True) -> tuple[Exam, ...]:
    """
    Return the exams of a lesson, in the lesson's order.

    :param assignment: folder name, such as ``07_temperature_monitor``
    """
    exams = [load(name, hidden) for name in names(hidden)]
    found = [exam for exam in exams if exam.assignment == assignment]
    return tuple(sorted(found, key=lambda exam: exam.part))

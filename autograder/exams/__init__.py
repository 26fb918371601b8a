"""
The exams of the course.

``visible/`` is shipped to learners: it is what ``check(...)`` runs in their notebook.  ``hidden/``
never leaves the instructor's machine and never enters a sandbox.  Both hold one module an exam,
named like it, with a module-level ``exam``.
"""

from __future__ import annotations

from functools import cache
import importlib
import pkgutil

from autograder.errors import ExamInvalid
from autograder.judging.exam import Exam
from autograder.judging.own_time import watched_longer


def _names(folder: str) -> tuple[str, ...]:
    package = importlib.import_module(f'autograder.exams.{folder}')
    return tuple(module.name for module in pkgutil.iter_modules(package.__path__))


@cache
def load(name: str, hidden: bool = True) -> Exam:
    """
    Return an exam.

    :param name: as in the grade cell ``check('<name>')``
    :param hidden: the full exam, or the visible one that learners have
    :raises ExamInvalid: if there is none, with the names that exist
    """
    folder = 'hidden' if hidden else 'visible'
    try:
        names = _names(folder)
    except ModuleNotFoundError:
        raise ExamInvalid(
            'The hidden exams are not part of this copy of the course.',
            'Grading needs the full project; visible checks work without it.',
        ) from None
    if name not in names:
        raise ExamInvalid(f'There is no exam {name!r}.', f'Known: {", ".join(names)}.')
    exam = importlib.import_module(f'autograder.exams.{folder}.{name}').exam
    if not isinstance(exam, Exam) or exam.name != name or not exam.checks:
        raise ExamInvalid(f'autograder/exams/{folder}/{name}.py defines no whole exam {name!r}.')
    if hidden and not exam.hidden:
        exam.hidden = True
        exam.facts['secret'] = True
        exam.scenario = watched_longer(name, exam.scenario)
    return exam


def for_assignment(assignment: str, hidden: bool = True) -> tuple[Exam, ...]:
    """
    Return the exams of a lesson, in the lesson's order.

    :param assignment: folder name, such as ``07_temperature_monitor``
    """
    exams = [load(name, hidden) for name in _names('hidden' if hidden else 'visible')]
    found = [exam for exam in exams if exam.assignment == assignment]
    return tuple(sorted(found, key=lambda exam: exam.part))

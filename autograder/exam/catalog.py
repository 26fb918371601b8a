"""
Find the exams of a course: its folder ``exams`` is a package with one module per exam.

The subpackage ``visible`` is shipped to learners; ``hidden`` gives the points.
"""

from functools import cache
import importlib
import importlib.util
from pathlib import Path
import pkgutil
import sys
from types import ModuleType

from autograder.errors import ExamInvalid, GraderError, line_in
from autograder.exam.exam import Exam
from autograder.exam.inputs import another_secret
from autograder.layout import Layout


def names(hidden: bool = True) -> tuple[str, ...]:
    """
    Return the names of all hidden or all visible exams.

    :raises ExamInvalid: if this copy of the course does not contain them
    """
    _import_package()
    folder = _folder(hidden)
    try:
        package = importlib.import_module(f'exams.{folder}')
    except Exception as error:  # noqa: BLE001 - an exam can raise anything
        if getattr(error, 'name', '') != f'exams.{folder}':
            raise _broken(f'exams/{folder}/__init__.py', error) from error
        raise ExamInvalid(
            f'The {folder} exams are not part of this copy of the course.',
            'Grading needs the full project; visible checks work without it.'
            if hidden
            else 'Try: create one with new-exam',
        ) from None
    return tuple(module.name for module in pkgutil.iter_modules(package.__path__))


def _import_package() -> None:
    """Import the package of the exams from the root of the course."""
    root, start = Layout.here().root, Layout.here().exams / '__init__.py'
    # A search would find the exams of this project, because its root is always on the path.
    if not start.is_file():
        raise ExamInvalid(
            f'{root}: this course has no exams: exams/__init__.py is missing.',
            'Try: create one with new-exam',
        )
    if 'exams' not in sys.modules:
        sys.path.insert(0, str(root))
    try:
        found = importlib.import_module('exams').__file__
    except Exception as error:  # noqa: BLE001 - an exam can raise anything
        raise _broken('exams/__init__.py', error) from error
    if found is None or Path(found).resolve() != start.resolve():
        raise ExamInvalid(
            f'{root}: expected the package exams of this course, got {found}.',
            'Try: start a new process, which imports no other package exams',
        )


def _folder(hidden: bool) -> str:
    return 'hidden' if hidden else 'visible'


@cache
def load(name: str, hidden: bool = True) -> Exam:
    """
    Return an exam.

    :param name: as in the grade cell ``check('<name>')``
    :param hidden: whether to load the hidden exam instead of the visible one
    :raises ExamInvalid: if the exam does not exist or its file is broken; for an unknown name, the
        error lists the known names
    """
    folder, known = _folder(hidden), names(hidden)
    if name not in known:
        raise ExamInvalid(f'There is no exam {name!r}.', f'Known: {", ".join(known)}.')
    exam = getattr(_module(folder, name), 'exam', None)
    if not isinstance(exam, Exam) or exam.name != name or not exam.checks:
        raise ExamInvalid(
            f'{_file_of(folder, name)} does not define a complete exam called {name!r}.'
        )
    if hidden and not exam.hidden:
        exam.hidden = True
        exam.facts['secret'] = True
    return exam


def load_with_secret(name: str, secret: str) -> Exam:
    """Return a hidden exam with inputs drawn from a given secret instead of the course secret."""
    found = importlib.util.find_spec(f'exams.{_folder(True)}.{name}')
    assert found
    assert found.loader
    module = importlib.util.module_from_spec(found)  # a copy, not the module in use
    with another_secret(secret):
        found.loader.exec_module(module)
    exam: Exam = module.exam
    return exam


def _module(folder: str, name: str) -> ModuleType:
    """Return the module of an exam; an error has file, line and message."""
    try:
        return importlib.import_module(f'exams.{folder}.{name}')
    except GraderError:
        raise  # the error already names its place
    except Exception as error:  # noqa: BLE001 - an exam can raise anything
        raise _broken(_file_of(folder, name), error) from error


def _broken(file: str, error: Exception) -> ExamInvalid:
    """Return the error for a file that cannot be imported, with the exam's line if known."""
    where = line_in(Layout.here().exams, error) or file
    said = ' '.join(str(getattr(error, 'msg', '') or error).split())
    return ExamInvalid(f'{where}: {type(error).__name__}: {said}.', 'Try: correct that line')


def _file_of(folder: str, name: str) -> str:
    return f'exams/{folder}/{name}.py'


def for_assignment(assignment: str, hidden: bool = True) -> tuple[Exam, ...]:
    """Return the exams of a lesson, given its folder name, ordered by their position in it."""
    exams = [load(name, hidden) for name in names(hidden)]
    found = [exam for exam in exams if exam.assignment == assignment]
    return tuple(sorted(found, key=lambda exam: exam.part))

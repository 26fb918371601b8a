"""A failed import of an exam, or an exception in a check, is reported with file and line."""

import re
import sys
from types import ModuleType

from collect_sources import laid
import pytest

from autograder import __main__ as autograder
from autograder.authoring.new_course import new_exam
from autograder.errors import ExamInvalid, GraderError
from autograder.exam import catalog
from autograder.exam.exam import Exam, Run
from autograder.exam.scenario import Scenario
from autograder.judging.judge import judge
from autograder.layout import Layout
from autograder.recording import Recording
from roslab import checking

BROKEN = {
    'x = (': "SyntaxError: '\\(' was never closed",
    'import nunpy': "ModuleNotFoundError: No module named 'nunpy'",
    'from autograder.judging.chekcs import x': 'ModuleNotFoundError: .*chekcs',
    'exam = Exams()': "NameError: name 'Exams' is not defined",
    'open("nowhere")': 'FileNotFoundError',
    'raise ValueError("one\\ntwo")': 'ValueError: one two',
}


@pytest.fixture
def empty_course(tmp_path, monkeypatch):
    """Return the folder of a course without exams."""
    (tmp_path / 'course.toml').touch()
    monkeypatch.setenv('COURSE_DIR', str(tmp_path))
    monkeypatch.setattr(sys, 'path', list(sys.path))
    before = forget()
    yield tmp_path
    forget()
    sys.modules.update(before)


@pytest.fixture
def broken_exam(empty_course):
    """Return a function that writes the only visible exam of a course."""
    laid(empty_course / 'exams', {'__init__.py': b'', 'visible/sample.py': b''})
    return (empty_course / 'exams' / 'visible' / 'sample.py').write_text


def forget() -> dict[str, ModuleType]:
    """Forget the imported exams, and return their modules."""
    catalog.load.cache_clear()
    names = [name for name in sys.modules if name.partition('.')[0] == 'exams']
    return {name: sys.modules.pop(name) for name in names}


@pytest.mark.parametrize('line', BROKEN)
def test_exam_file_that_cannot_be_imported_is_one_line(broken_exam, tmp_path, capsys, line):
    broken_exam(f'"""A docstring."""\n\n{line}\n')

    command = ['check', 'sample', '--files', str(tmp_path), '--visible']
    assert autograder.main(command) == autograder.USAGE
    (said,) = capsys.readouterr().err.splitlines()
    place = r'autograder: exams/visible/sample\.py, line 3: '
    assert re.match(place + BROKEN[line], said)

    shown = checking.check('sample').problem.line()
    assert 'not your code' in shown
    assert 'sample.py, line 3' in shown


@pytest.mark.parametrize('folder', ['.', 'exams/visible'])
def test_course_without_exams_does_not_use_those_of_the_project(empty_course, capsys, folder):
    """Python's search path contains the project, whose folder ``exams`` is a package."""
    (empty_course / folder).mkdir(parents=True, exist_ok=True)

    assert autograder.main(['check', 'talker', '--files', '.', '--visible']) == autograder.USAGE
    (said,) = capsys.readouterr().err.splitlines()
    assert said.startswith(f'autograder: {empty_course}: this course has no exams')


@pytest.mark.parametrize('file', ['exams/__init__.py', 'exams/visible/__init__.py'])
@pytest.mark.parametrize('line', ['import numpyy', 'x = ('])
def test_a_package_of_exams_that_cannot_be_imported_is_named(broken_exam, tmp_path, file, line):
    (tmp_path / file).write_text(line)

    with pytest.raises(ExamInvalid, match=rf'^{file}, line 1: (ModuleNotFound|Syntax)Error: '):
        catalog.names(hidden=False)


def test_first_exam_of_a_course_without_a_folder_for_exams_is_found(empty_course):
    """A course may begin as a single course.toml, written by hand."""
    new_exam(Layout(empty_course), 'points', '01_points')

    assert catalog.names(hidden=False) == catalog.names() == ('points',)


def test_exams_of_another_course_are_refused(broken_exam, monkeypatch):
    other = ModuleType('exams')
    other.__file__ = '/elsewhere/exams.py'
    monkeypatch.setitem(sys.modules, 'exams', other)

    with pytest.raises(ExamInvalid, match=r'of this course, got /elsewhere/exams\.py'):
        catalog.names(hidden=False)


def test_names_put_the_course_on_the_search_path_once(broken_exam, tmp_path):
    for _ in range(3):
        sys.path.insert(0, '/elsewhere')
        assert catalog.names(hidden=False) == ('sample',)

    assert sys.path.count(str(tmp_path)) == 1


def test_check_that_breaks_is_named_with_its_line(broken_exam):
    broken_exam('def sums(run):\n    """It sums."""\n    return 1 / 0\n\nexam = None\n')
    with pytest.raises(ExamInvalid, match='does not define a complete exam'):
        catalog.load('sample', hidden=False)
    sample = Exam(
        'sample', title='T', assignment='01_x', part=1, cells=(), requires=(), scenario=Scenario()
    )
    sample.check(points=1)(sys.modules['exams.visible.sample'].sums)

    with pytest.raises(GraderError, match=r'sums of exam sample broke in .*\.py, line 3: Zero'):
        judge(sample, Run({}, Recording({}, ())))

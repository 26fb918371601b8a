"""A failed import of an exam, or an exception in a check, is reported with file and line."""

import re
import sys
from types import ModuleType

import pytest

from autograder import __main__ as autograder
from autograder.errors import ExamInvalid, GraderError
from autograder.exam import catalog
from autograder.exam.exam import Exam, Run
from autograder.exam.scenario import Scenario
from autograder.judging.judge import judge
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
def broken_exam(tmp_path, monkeypatch):
    """Return a function that writes the only visible exam of a course."""
    folder = tmp_path / 'exams' / 'visible'
    folder.mkdir(parents=True)
    (tmp_path / 'course.toml').touch()
    (folder.parent / '__init__.py').touch()
    monkeypatch.setenv('COURSE_DIR', str(tmp_path))
    monkeypatch.setattr(sys, 'path', list(sys.path))
    before = forget()
    yield (folder / 'sample.py').write_text
    forget()
    sys.modules.update(before)


def forget() -> dict[str, ModuleType]:
    """Forget the imported exams, and return their modules."""
    catalog.load.cache_clear()
    names = [name for name in sys.modules if name.partition('.')[0] == 'exams']
    return {name: sys.modules.pop(name) for name in names}


@pytest.mark.parametrize('line', BROKEN)
def test_exam_file_that_cannot_be_imported_is_one_line(broken_exam, tmp_path, capsys, line):
    """The error shows the file, the line and the message, and sends learners to the instructor."""
    broken_exam(f'"""A docstring."""\n\n{line}\n')

    command = ['check', 'sample', '--files', str(tmp_path), '--visible']
    assert autograder.main(command) == autograder.USAGE
    (said,) = capsys.readouterr().err.splitlines()
    place = r'autograder: exams/visible/sample\.py, line 3: '
    assert re.match(place + BROKEN[line], said)

    shown = checking.check('sample').problem.line()
    assert 'not your code' in shown
    assert 'sample.py, line 3' in shown


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

"""
Find the files that each exam judges in a rebuilt notebook.

The magic line of a cell names its file (:mod:`autograder.submission.cells`).  The release defines
the expected file of each cell, so a student who edits a magic line gets a message.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from autograder.exam.exam import Exam
from autograder.results import Problem, SubmissionResult
from autograder.submission.cells import CellFile, CellSyntaxError, first_line, parse_cell
from autograder.submission.notebook import marks_of, Notebook
from autograder.submission.package import with_missing_file
from autograder.submission.submission import Opened

CHECK_PREFIX = 'check_'
"""Prefix of the grade id of a check cell; the name of the exam follows."""


@dataclass(frozen=True)
class ExamFiles:
    """
    The files that one exam judges.

    :param files: relative path to text; a missing answer has no entry
    :param problems: answer cells that are not the expected file
    """

    files: Mapping[str, str] = field(default_factory=dict)
    problems: tuple[Problem, ...] = ()


def answer_files(release: Notebook) -> dict[str, CellFile]:
    """
    Return the expected file of each answer cell, by grade id.

    :param release: the notebook that students received
    :raises CellSyntaxError: if a magic line in the release is invalid
    """
    files = {}
    for cell in release['cells']:
        marks = marks_of(cell)
        if cell['cell_type'] == 'code' and marks.get('solution'):
            found = parse_cell(cell['source'])
            if found is not None:
                files[marks['grade_id']] = found
    return files


def extract(
    opened: Opened, exams: Iterable[Exam], release: Notebook, where: str = 'notebook'
) -> dict[str, ExamFiles]:
    """
    Return the files of every exam by its name, including untouched stubs, which the exam reports.

    :param release: the notebook that students received
    :param where: name of the submitted file in messages
    """
    expected = answer_files(release)
    sources = {marks_of(cell).get('grade_id'): cell['source'] for cell in opened.notebook['cells']}
    result = {}
    for exam in exams:
        files, problems = {}, []
        for grade_id in exam.cells:
            if grade_id in opened.missing or grade_id not in expected:
                continue
            found, problem = _read(sources[grade_id], expected[grade_id], grade_id, where)
            if problem is not None:
                problems.append(problem)
            if found is not None:
                files[found.path] = found.body
        result[exam.name] = ExamFiles(files, tuple(problems))
    return result


def with_reasons(result: SubmissionResult, exams: Iterable[Exam]) -> SubmissionResult:
    """
    Return a result in which a missing file refers to the problem that explains its absence.

    :param result: a result that includes the problems of the submission
    """
    cells = {exam.name: set(exam.cells) for exam in exams}
    explained = []
    for exam in result.exams:
        reasons = [one for one in result.problems if cells[exam.exam] & set(one.cells)]
        if reasons:
            fix = f'{reasons[0].try_this[:1].upper()}{reasons[0].try_this[1:]}.'
            why = 'The answer was not found in the submitted file; the note says why.'
            exam = with_missing_file(exam, cause=why, try_this=fix)
        explained.append(exam)
    return replace(result, exams=tuple(explained))


def _read(
    source: str, wanted: CellFile, grade_id: str, where: str
) -> tuple[CellFile | None, Problem | None]:
    """Return the file of an answer cell, or the problem if it is not the expected file."""
    line, first = f'%%{wanted.kind} {wanted.name}', first_line(source)[0].strip()
    try:
        found = parse_cell(source)
    except CellSyntaxError:
        found = None
    if found is not None and found.path == wanted.path:
        return found, None
    problem = Problem(
        f'{where}, cell {grade_id}',
        f'the first line {line}',
        repr(first[:60]) if first else 'an empty cell',
        f'write {line} as the first line again',
        (grade_id,),
    )
    return None, problem

"""
Find the files that each exam judges in a rebuilt notebook.

The magic line of a cell names its file (:mod:`autograder.submission.cells`).  The release defines
the expected file of each cell, so a student who edits a magic line gets a message.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from autograder.exam.exam import Exam
from autograder.results import Problem, SubmissionResult
from autograder.submission.cells import CellFile, CellSyntaxError, first_line, parse_cell
from autograder.submission.notebook import answer_cells, marks_of, Notebook
from autograder.submission.package import with_missing_file
from autograder.submission.reading import read_file
from autograder.submission.submission import open_submission, Opened

CHECK_PREFIX = 'check_'
"""Prefix of the grade id of a check cell; the name of the exam follows."""


@dataclass(frozen=True)
class ExamFiles:
    """
    The files that one exam judges, and a problem per answer cell that is not the expected file.

    :param files: relative path to text; a missing answer has no entry
    """

    files: Mapping[str, str] = field(default_factory=dict)
    problems: tuple[Problem, ...] = ()


def answer_files(release: Notebook) -> dict[str, CellFile]:
    """Return the expected file of each answer cell, by grade id, or raise a CellSyntaxError."""
    return {
        grade_id: found
        for grade_id, cell in answer_cells(release).items()
        if cell['cell_type'] == 'code' and (found := parse_cell(cell['source']))
    }


def extract(
    opened: Opened, exams: Iterable[Exam], release: Notebook, where: str = 'notebook'
) -> dict[str, ExamFiles]:
    """Return the files of every exam by its name, with untouched stubs, which exams report."""
    expected = answer_files(release)
    sources = {marks_of(cell).get('grade_id'): cell['source'] for cell in opened.notebook['cells']}
    result = {}
    for exam in exams:
        files: dict[str, str] = {}
        problems: list[Problem] = []
        for grade_id in exam.cells:
            if grade_id not in opened.missing and (wanted := expected.get(grade_id)):
                problems += _add(sources[grade_id], wanted, files, where, grade_id)
        result[exam.name] = ExamFiles(files, tuple(problems))
    return result


def files_in_notebook(
    path: Path, release: Notebook, exams: Sequence[Exam]
) -> Iterator[tuple[Exam, ExamFiles]]:
    """Yield each exam with its files in a notebook; the problems include the notebook's."""
    data, problems = read_file(path, path.name)
    opened = open_submission(data, release, path.name, problems)
    for exam, found in zip(exams, extract(opened, exams, release, path.name).values()):
        yield exam, replace(found, problems=(*opened.problems, *found.problems))


def with_reasons(result: SubmissionResult, exams: Iterable[Exam]) -> SubmissionResult:
    """Return a result in which each missing file refers to the problem that explains it."""
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


def _add(
    source: str, wanted: CellFile, files: dict[str, str], where: str, grade_id: str
) -> Iterator[Problem]:
    """Add the file of an answer cell; yield a problem if it is not the expected file."""
    try:
        found = parse_cell(source)
    except CellSyntaxError:
        found = None
    if found is not None and found.path == wanted.path:
        files[found.path] = found.body
        return
    line, first = f'%%{wanted.kind} {wanted.name}', first_line(source)[0].strip()
    got = repr(first[:60]) if first else 'an empty cell'
    fix = f'write {line} as the first line again'
    yield Problem(f'{where}, cell {grade_id}', f'the first line {line}', got, fix, (grade_id,))

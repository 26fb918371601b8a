"""
Store the results from which the tables are generated, as JSON next to the code.

``make check`` only compares a table, without a run.  So each result contains the digest of its
inputs; if they have changed, the table is out of date.
"""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
import json
from pathlib import Path
from typing import Any

from autograder.exam.exam import Exam
from autograder.grading.examine import Engine
from autograder.results import ExamResult
from autograder.sandboxes.choose import strongest
from tests.judgement.references import Exercise, exercises, LAYOUT

FOLDER = Path(__file__).parent
DOCS = LAYOUT.root / 'docs'
JOBS = 2


def run_all(work: Sequence[tuple[Exam, Mapping[str, str]]]) -> list[ExamResult]:
    """
    Judge files with exams in the real sandbox, two at a time.

    Programs with a current recording are not run again.

    :param work: exams, each with the files that it judges
    :returns: the results, in the order of ``work``
    :raises GraderError: if the grader itself fails
    """
    box = strongest()

    def one(exam: Exam, files: Mapping[str, str]) -> ExamResult:
        return Engine(box, LAYOUT.recordings).run(exam, files)

    # Report failures of the grader at the end, so that completed runs are kept.
    with ThreadPoolExecutor(max_workers=JOBS) as pool:
        tasks = [pool.submit(one, *given) for given in work]
    return [task.result() for task in tasks]


def load(name: str) -> dict[str, Any]:
    """Return the stored results, empty if there are none."""
    path = FOLDER / f'{name}.json'
    return dict(json.loads(path.read_text(encoding='utf-8'))) if path.is_file() else {}


def renew(name: str, chosen: Sequence[str], made: Callable[[Exercise], dict[str, Any]]) -> None:
    """
    Compute results of exercises, and store each as soon as it is available.

    :param chosen: names of exams
    :param made: returns the result of an exercise, with the digest of its inputs
    """
    for exercise in exercises():
        if exercise.name in chosen:
            result = made(exercise)
            kept = {**load(name), exercise.name: result}
            data = {one.name: kept[one.name] for one in exercises() if one.name in kept}
            text = json.dumps(data, indent=1, ensure_ascii=False)
            (FOLDER / f'{name}.json').write_text(f'{text}\n', encoding='utf-8')


def late(name: str, digest_of: Callable[[Exercise], str]) -> list[str]:
    """Return the exams whose results are older than the current files."""
    kept = load(name)
    return [
        one.name
        for one in exercises()
        # Without a stored result, compute no digest: this could fail in another course.
        if one.name not in kept or kept[one.name]['digest'] != digest_of(one)
    ]


def write_or_compare(name: str, page: str, late: Sequence[str], arguments: Sequence[str]) -> int:
    """
    Write a page, or with ``--check`` report whether it is up to date.

    :param name: the name of the page in ``docs/`` and of the module that generates it
    :param late: the results that are out of date, as text
    :returns: the exit code
    """
    path = DOCS / f'{name}.md'
    if '--check' not in arguments:
        path.write_text(page, encoding='utf-8')
        return 0
    if not late and path.is_file() and path.read_text(encoding='utf-8') == page:
        return 0
    about = f' ({", ".join(late)})' if late else ''
    print(f'docs/{name}.md is out of date{about}. Try: python -m tests.judgement.{name}')
    return 1


def cell(text: str) -> str:
    """Return a string that is valid in a cell of a Markdown table."""
    return ' '.join(text.split()).replace('|', '&#124;')


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a Markdown table."""
    lines = [f'| {" | ".join(head)} |', f'|{"---|" * len(head)}']
    return [*lines, *(f'| {" | ".join(map(cell, row))} |' for row in rows)]

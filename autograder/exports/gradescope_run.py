"""
Grade one submission in Gradescope's container.

The script ``run_autograder`` in the zip file starts ``python -m
autograder.exports.gradescope_run``.  For a submission for review, it writes no ``results.json``:
then Gradescope reports a failed autograder instead of giving a zero.
"""

from __future__ import annotations

from collections.abc import Sequence
import json
from pathlib import Path
import sys

from autograder.errors import GraderError
from autograder.exports.gradescope import RESULTS, results_of, SETTINGS
from autograder.files import json_bytes, keep
from autograder.grading.pipeline import grade_opened, grading_engine, load_lesson, open_one
from autograder.layout import Layout
from autograder.results import SubmissionResult
from autograder.submission.inbox import open_folder

OK, NO_VERDICT = 0, 1


def main(arguments: Sequence[str]) -> int:
    """
    Grade ``ROOT/submission`` and write ``ROOT/results/results.json``.

    :param arguments: one argument, the folder ROOT: ``/autograder`` in the container
    :returns: the exit code
    """
    root = Path(arguments[0])
    results = root / 'results' / RESULTS
    results.unlink(missing_ok=True)
    try:
        layout = Layout.here()
        settings = json.loads((layout.root / SETTINGS).read_text(encoding='utf-8'))
        result = grade(layout, settings['assignment'], root / 'submission', settings['allow_weak'])
        keep(results, json_bytes(results_of(result, settings['visibility'])))
    except GraderError as error:
        print(f'No verdict, so no score: {error}', flush=True)
        return NO_VERDICT
    for flag in result.flags:
        print(f'flag: {flag}')
    return OK


def grade(layout: Layout, assignment: str, folder: Path, allow_weak: str) -> SubmissionResult:
    """
    Grade the notebook in a folder with the full exams.

    :param folder: folder with the student's upload
    :raises GraderError: if no isolation mode that may run hidden exams works here
    """
    engine = grading_engine(layout, allow_weak=allow_weak)
    if not getattr(engine, 'hidden', True):
        raise GraderError('Only visible checks can run here, so there is no grade.')
    lesson = load_lesson(layout, assignment, engine)
    opened = open_one(open_folder(folder, 'submission', lesson.notebook), lesson)
    return grade_opened(opened, 'submission', lesson, engine)


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))

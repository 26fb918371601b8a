"""
Measure how long ``check(...)`` takes: every visible check, with the solution and the stub.

Each check is a child process, as in a notebook, on a folder like a learner's; the result is
the median of three.  A check that builds messages is measured with three sets of files: the
solution, already built (as when a learner repeats the check); files that were never built; and the
stub.
"""

import argparse
from collections.abc import Mapping
import json
import os
from pathlib import Path
import subprocess
import sys
import tempfile
import time
from typing import Any

from autograder.exam import catalog
from autograder.exam.exam import Exam
from autograder.layout import Layout
from autograder.submission.notebook import read_release
from autograder.submission.submission import extract, open_submission
from benchmarks import report

RUNS = 3
LIMIT_S = 5.0
Files = Mapping[str, str]


def files_of(layout: Layout, exam: Exam, solved: bool) -> Files:
    """
    Return the files that the cells of a lesson save.

    :param solved: use the solution instead of the release
    """
    release = read_release(layout.release(exam.assignment))
    name = layout.release(exam.assignment).name
    folder = layout.solutions if solved else layout.notebooks
    data = (folder / exam.assignment / name).read_bytes()
    opened = open_submission(data, release, name, ())
    return extract(opened, [exam], release, name)[exam.name].files


def lay_out(files: Files, folder: Path, comment: str = '') -> None:
    """
    Write files as the cells of a notebook do.

    :param comment: appended to message files, so that they differ from those of earlier builds
    """
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        more = f'# {comment}\n' if comment and name.endswith('.msg') else ''
        path.write_text(f'{text}\n{more}', encoding='utf-8')


def waited_s(exam: Exam, folder: Path, solved: bool) -> float:
    """
    Return the time of one check, started as in a notebook [s].

    :param solved: whether full points are expected
    :raises RuntimeError: if the verdict is unexpected, because then the time is meaningless
    """
    command = [sys.executable, '-m', 'autograder.commands.check', exam.name]
    command += ['--files', str(folder), '--visible', '--json']
    began = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    seconds = time.monotonic() - began
    if done.returncode != 0:
        raise RuntimeError(f'{exam.name}: {done.stderr.strip()[-300:]}')
    verdicts = {check['verdict'] for check in json.loads(done.stdout)['checks']}
    if (verdicts == {'PASSED'}) != solved:
        raise RuntimeError(f'{exam.name}: {sorted(verdicts)}, solved: {solved}')
    return seconds


def measured(
    exam: Exam, files: Files, runs: int, *, solved: bool, new: bool = False
) -> dict[str, float] | None:
    """
    Return the times of a check on some files, None if there are no files to check.

    :param solved: whether the files are a solution
    :param new: whether to change the files so that they were never built before
    """
    if not files:
        return None
    times = []
    for number in range(runs):
        with tempfile.TemporaryDirectory(prefix='visible-') as folder:
            lay_out(files, Path(folder), f'{os.getpid()} {number}' if new else '')
            times.append(waited_s(exam, Path(folder), solved))
    return report.spread(times)


def main() -> None:
    """Measure, then print and save the figures."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks.visible_checks')
    help_text = 'runs of each check (default: %(default)s)'
    parser.add_argument('--runs', type=int, default=RUNS, metavar='N', help=help_text)
    parser.add_argument('--exam', metavar='NAME', help='measure only this exam, and save nothing')
    chosen = parser.parse_args()
    facts = report.machine()
    layout = Layout.here()
    checks = {
        exam.name: _of_one(layout, exam, chosen.runs)
        for assignment in layout.assignments()
        for exam in catalog.for_assignment(assignment, hidden=False)
        if chosen.exam in (None, exam.name)
    }
    prepared = [found[one] for found in checks.values() for one in ('solution', 'stub')]
    slowest = max((found['median'] for found in prepared if found), default=0.0)
    figures = {'limit_s': LIMIT_S, 'slowest_of_a_prepared_one_s': slowest, 'checks': checks}
    full = chosen.runs >= RUNS and chosen.exam is None
    report.save('visible_checks', facts, figures, full=full)


def _of_one(layout: Layout, exam: Exam, runs: int) -> dict[str, Any]:
    print(f'{exam.name} ...', file=sys.stderr, flush=True)
    solution = files_of(layout, exam, solved=True)
    first = None
    if exam.scenario.program == 'build':
        first = measured(exam, solution, runs, solved=True, new=True)
        measured(exam, solution, 1, solved=True)  # builds the messages if necessary
    return {
        'solution': measured(exam, solution, runs, solved=True),
        'stub': measured(exam, files_of(layout, exam, solved=False), runs, solved=False),
        'first_build': first,
    }


if __name__ == '__main__':
    main()

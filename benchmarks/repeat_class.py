"""
Grade the sample class repeatedly, to find out whether all verdicts stay the same.

Each repeat runs everything again.  All parts of the results are compared, including texts, but not
times and pictures.  Processes that only use CPU time (``--busy``) show whether load changes a
verdict.
"""

import argparse
from collections import Counter, defaultdict
from collections.abc import Iterator
import json
import os
from pathlib import Path
import sys
import tempfile
import time
from typing import Any

from autograder.authoring.sample_class import write_sample_class
from autograder.grading.pipeline import grade_class, load_lesson, SandboxEngine
from autograder.layout import Layout
from autograder.runs.grading_folder import grading_folder
from autograder.sandboxes.choose import strongest
from autograder.submission.inbox import discover
from benchmarks import report

FULL_REPEATS = 50


def main() -> int:
    """
    Measure, then print and save the figures.

    :returns: exit code, 1 if the outcomes differ
    """
    chosen = _arguments()
    os.environ.setdefault('COURSE_SECRET', 'benchmark')
    facts = report.machine()
    seen: defaultdict[str, Counter[str]] = defaultdict(Counter)
    walls: list[float] = []
    with tempfile.TemporaryDirectory(prefix='benchmark_') as folder, report.busy(chosen.busy):
        submitted = Path(folder, 'submitted')
        write_sample_class(Layout.here(), submitted)
        try:
            for number in range(chosen.repeats):
                began = time.monotonic()
                recordings = Path(folder, str(number))
                for place, outcome in list(_outcomes(submitted, recordings, chosen.jobs)):
                    seen[place][outcome] += 1
                walls.append(time.monotonic() - began)
                print(f'repeat {number + 1}: {walls[-1]:.1f} s', flush=True)
        except KeyboardInterrupt:
            print('Stopped; these are the results so far.')
    if not walls:
        return 1
    for found in seen.values():
        if missing := len(walls) - found.total():
            found['missing'] = missing
    differing = report.differing(seen)
    figures = {
        'jobs': chosen.jobs,
        'busy': chosen.busy,
        'repeats': len(walls),
        'submissions': len({place.split('/')[0] for place in seen}),
        'checks': sum(place.count('/') == 3 for place in seen),
        'differing': differing,
        'wall_s': report.spread(walls),
    }
    name = f'repeat_class_busy_{chosen.busy}' if chosen.busy else 'repeat_class'
    report.save(name, facts, figures, full=len(walls) >= FULL_REPEATS)
    return 1 if differing else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog='python -m benchmarks.repeat_class')
    number: dict[str, Any] = {'type': int, 'metavar': 'N'}
    help_text = 'how often to grade the class (default: %(default)s)'
    parser.add_argument('--repeats', default=FULL_REPEATS, help=help_text, **number)
    help_text = 'runs at a time (default: one per processor, here %(default)s)'
    parser.add_argument('--jobs', default=os.cpu_count() or 1, help=help_text, **number)
    help_text = 'number of competing busy processes (default: %(default)s)'
    parser.add_argument('--busy', default=0, help=help_text, **number)
    return parser.parse_args()


def _outcomes(submitted: Path, recordings: Path, jobs: int) -> Iterator[tuple[str, str]]:
    """
    Grade the class with a new folder of recordings, so that every program runs again.

    Yield each check as STUDENT/LESSON/EXAM/CHECK with its result as JSON, and the other parts of
    the results of an exam and of a submission in the same way.
    """
    layout = Layout.here()
    engine = SandboxEngine(strongest(), recordings, fresh=True)
    with grading_folder():
        for assignment in layout.assignments():
            lesson = load_lesson(layout, assignment, engine)
            submissions = discover(submitted, assignment, lesson.notebook, layout.assignments())
            for one in grade_class(submissions, lesson, engine, jobs):
                data = report.compared(one.result.to_json())
                place = f'{one.result.student}/{assignment}'
                for exam in data.pop('exams'):
                    for check in exam.pop('checks'):
                        yield f'{place}/{exam["exam"]}/{check["check"]}', json.dumps(check)
                    yield f'{place}/{exam["exam"]}', json.dumps(exam)
                yield place, json.dumps(data)


if __name__ == '__main__':
    sys.exit(main())

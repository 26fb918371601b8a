"""
Judge the same files again and again, to find out whether a verdict or a message ever changes.

A task is one exam on one set of files: each exam of each submission in ``tests/submissions``, and
each program in ``tests/attacks``.  Each repeat runs all tasks in a different order and in one of
three ways.
"""

import argparse
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
import json
import os
import random
import statistics
import sys
import time
from typing import Any

from autograder.authoring.sample_class import compose, samples
from autograder.errors import GraderError
from autograder.exam import catalog
from autograder.exam.exam import Exam
from autograder.grading.examine import examine
from autograder.grading.pipeline import load_lesson, SandboxEngine
from autograder.layout import Layout
from autograder.runs.observe import BUILDS
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.sandbox import Sandbox
from autograder.submission.extract import extract
from autograder.submission.submission import open_submission
from benchmarks import report
from tests.attacks.corpus import files_of, programs

REPEATS = 12
CORES = os.cpu_count() or 1
ENDED = ('limit', 'ended', 'busy')
REVIEW, OVER = 'for review: ', ', over its bound'


@dataclass(frozen=True)
class Task:
    """
    One exam applied to one set of files.

    :param bound: maximum points for a result that is only compared with a bound, else None
    :param slow: whether it takes much longer than others
    """

    name: str
    exam: Exam
    files: tuple[tuple[str, str], ...]
    bound: float | None = None
    slow: bool = False

    @property
    def builds(self) -> bool:
        """Return whether a run builds a package first."""
        return self.exam.scenario.program in BUILDS


@dataclass(frozen=True)
class Way:
    """A mode in which the tasks of one repeat are run."""

    name: str
    jobs: int
    burners: int = 0


WAYS = (
    Way('calm', CORES),
    # Most competing processes are runs instead of busy loops: each run has equally many
    # competitors, and twice as many runs are completed.
    Way('oversubscribed', 6 * CORES, burners=2 * CORES),
    Way('parallel', 8),
)
Found = list[tuple[str, str, str, float]]
"""For each run: the task's name, the outcome and the pictures, as JSON, and the duration [s]."""


def main() -> int:
    """
    Measure, then print and save the figures.

    :returns: exit code, 1 if any outcome differs
    """
    chosen = _arguments()
    os.environ.setdefault('COURSE_SECRET', 'benchmark')
    facts = report.machine()
    tasks = [
        one for one in all_tasks() if chosen.only in one.name and (chosen.all or not one.slow)
    ]
    if chosen.list:
        print('\n'.join(task.name for task in tasks))
        return 0
    sandbox = strongest()
    outcomes: defaultdict[str, Counter[str]] = defaultdict(Counter)
    pictures: defaultdict[str, Counter[str]] = defaultdict(Counter)
    done: list[dict[str, Any]] = []
    until = time.monotonic() + 60 * chosen.minutes
    try:
        while len(done) < REPEATS and time.monotonic() < until:
            repeat, found = _repeat(tasks, sandbox, len(done), until)
            done.append(repeat)
            for name, outcome, shown, _ in found:
                outcomes[name][outcome] += 1
                pictures[name][shown] += 1
            several = len(report.differing(outcomes))
            print(len(done), repeat, f'{several} tasks with more than one outcome', flush=True)
    except KeyboardInterrupt:
        print('Stopped; these are the results so far.')
    figures = {
        'isolation': sandbox.mode,
        'without_slow_tasks': not chosen.all,
        **_figures(tasks, done, outcomes),
        'differing_pictures': sorted(report.differing(pictures)),
    }
    full = len(done) >= REPEATS and not chosen.only
    # Save the results of a shorter measurement only if outcomes differ.
    report.save('soak', facts, figures, full=full or bool(figures['differing']))
    return 1 if figures['differing'] else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog='python -m benchmarks.soak')
    help_text = 'also run builds, and attacks that run into a time limit'
    parser.add_argument('--all', action='store_true', help=help_text)
    help_text = 'start no further run after this many minutes (default: no limit)'
    parser.add_argument('--minutes', type=float, default=1e6, metavar='M', help=help_text)
    parser.add_argument('--only', default='', metavar='TEXT', help='run only tasks named *TEXT*')
    parser.add_argument('--list', action='store_true', help='print the names of the tasks only')
    return parser.parse_args()


# -- tasks ---------------------------------------------------------------------------------


def all_tasks() -> Iterator[Task]:
    """Yield each exam of each submission, then each attack."""
    layout = Layout.here()
    for assignment in layout.assignments():
        yield from _submissions(layout, assignment)
    yield from _attacks()


def _submissions(layout: Layout, assignment: str) -> Iterator[Task]:
    """Yield every exam on the files of every submission; equal files give one task."""
    lesson = load_lesson(layout, assignment, SandboxEngine(strongest()))
    known = set()
    for sample in samples(layout, assignment, everything=True):
        opened = open_submission(compose(layout, assignment, sample), lesson.release, 'it')
        found = extract(opened, lesson.exams, lesson.release, lesson.notebook)
        for exam in lesson.exams:
            files = tuple(sorted(found[exam.name].files.items()))
            if (exam.name, files) not in known:
                known.add((exam.name, files))
                name = f'{assignment}/{sample.name}/{exam.name}'
                yield Task(name, exam, files, slow=exam.scenario.program == 'build')


def _attacks() -> Iterator[Task]:
    """Yield a task for every program in ``tests/attacks``."""
    for attack in programs():
        files = tuple(sorted(files_of(attack).items()))
        bound = attack.points if attack.at_most else None
        name, exam = f'attack/{attack.kind}/{attack.name}', catalog.load(attack.kind)
        # A flag about a limit, or a bound, means that the program runs until the grader ends it.
        slow = bound is not None or any(word in str(attack.flags) for word in ENDED)
        yield Task(name, exam, files, bound, slow or exam.scenario.program == 'build')


# -- runs ----------------------------------------------------------------------------------


def _repeat(
    tasks: Sequence[Task], sandbox: Sandbox, number: int, until: float
) -> tuple[dict[str, Any], Found]:
    """Run all tasks once, in an order and a way that depend on the repeat."""
    way = WAYS[number % len(WAYS)]
    order = random.Random(number).sample(tasks, len(tasks))
    began = time.monotonic()

    def run(task: Task) -> tuple[str, str, str, float] | None:
        began = time.monotonic()
        if began > until:
            return None
        outcome, shown = _outcome(task, sandbox)
        return task.name, outcome, shown, time.monotonic() - began

    with report.busy(way.burners), ThreadPoolExecutor(way.jobs) as pool:
        try:
            found = [one for one in pool.map(run, order) if one is not None]
        except KeyboardInterrupt:
            pool.shutdown(cancel_futures=True)
            raise
    wall_s = round(time.monotonic() - began, 1)
    repeat: dict[str, Any] = {
        'way': way.name,
        'runs': len(found),
        'wall_s': wall_s,
        'load': report.load(),
    }
    built = {task.name for task in tasks if task.builds}
    each_s = [seconds for name, *_, seconds in found if name not in built]
    if len(each_s) > 1:
        p95 = round(statistics.quantiles(each_s, n=20)[-1], 4)
        repeat['run_s'] = {**report.spread(each_s), 'p95': p95}
        longest = sorted(found, key=lambda one: -one[-1])[:5]
        repeat['longest'] = {name: round(seconds, 2) for name, *_, seconds in longest}
    return repeat, found


def _outcome(task: Task, sandbox: Sandbox) -> tuple[str, str]:
    """Return a result without its timing, and its pictures, both as JSON."""
    try:
        result = examine(task.exam, dict(task.files), sandbox=sandbox)
    except GraderError as error:
        return f'{REVIEW}{type(error).__name__}', ''
    if task.bound is not None:
        within = result.points <= task.bound
        return 'within its bound' if within else f'{result.points:g} points{OVER}', ''
    data = result.to_json()
    pictures = json.dumps(data['pictures'], sort_keys=True)
    return json.dumps(report.compared(data), sort_keys=True), pictures


def _verdicts(outcome: str) -> str:
    """Return only the verdicts of an outcome, without the texts."""
    if not outcome.startswith('{'):
        return outcome
    return ' '.join(f'{one["check"]}:{one["verdict"]}' for one in json.loads(outcome)['checks'])


def _figures(
    tasks: Sequence[Task], done: Sequence[dict[str, Any]], seen: report.Seen
) -> dict[str, Any]:
    """Combine the measurements into the figures to save."""
    ways = {
        way.name: {
            **asdict(way),
            'repeats': len(mine),
            'runs': sum(repeat['runs'] for repeat in mine),
            'wall_s': round(sum(repeat['wall_s'] for repeat in mine), 1),
            'load': report.spread([repeat['load'] for repeat in mine]),
            **{key: [one[key] for one in mine if key in one] for key in ('run_s', 'longest')},
        }
        for way in WAYS
        if (mine := [repeat for repeat in done if repeat['way'] == way.name])
    }
    counts = [seen[task.name].total() for task in tasks]
    bounded = {task.name for task in tasks if task.bound is not None}
    # A task with a bound may differ from run to run, but not exceed it.
    differing = {n: one for n, one in report.differing(seen).items() if n not in bounded}
    differing |= {n: dict(seen[n]) for n in bounded if any(one.endswith(OVER) for one in seen[n])}
    review = {n: [one for one in found if one.startswith(REVIEW)] for n, found in seen.items()}
    return {
        'tasks': len(tasks),
        'attacks': sum(task.name.startswith('attack/') for task in tasks),
        'compared_with_a_bound': len(bounded),
        'repeats': len(done),
        'runs': sum(counts),
        'least_repeats_of_a_task': min(counts, default=0),
        'ways': ways,
        'distinct_outcomes': sum(map(len, seen.values())),
        'differing_verdicts': [
            n for n, found in differing.items() if len(set(map(_verdicts, found))) > 1
        ],
        'for_review': {
            n: sum(seen[n][one] for one in found) for n, found in review.items() if found
        },
        'differing': differing,
    }


if __name__ == '__main__':
    sys.exit(main())

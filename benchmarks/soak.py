"""
The same files judged again and again, calm and under load, to see whether a result changes.

The tasks are every exam of every submission in ``tests/submissions`` (references, near misses,
untouched stubs) and every program in ``tests/attacks``.  Each repeat runs all of them afresh, in
another order, in one of three ways in turn: *calm* (one run a processor), *oversubscribed* (beside
burners that want the processors many times over) and *parallel* (many runs at a time).  Compared
is all that a result says, texts and flags included, except its ``timing``.  An attack whose
docstring calls its points a bound, because luck has a part, is compared with the bound.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
import json
import os
import random
import sys
import time
from typing import Any

from autograder import exams
from autograder.errors import GraderError
from autograder.exam import Exam
from autograder.examine import examine
from autograder.extract import extract
from autograder.layout import Layout
from autograder.pipeline import load_lesson, SandboxEngine
from autograder.sample_class import compose, samples
from autograder.sandbox import Sandbox, strongest
from autograder.submission import open_submission
from benchmarks import report
from benchmarks.repeat_class import busy
from tests.attacks.corpus import files_of, programs

FULL_REPEATS = 200
CORES = os.cpu_count() or 1
ENDED = ('limit', 'ended', 'busy')
NOT_COMPARED = ('timing', 'recording')


@dataclass(frozen=True)
class Task:
    """
    One exam on one set of files.

    :param bound: the most points it may get, if it is compared with a bound; else None
    :param slow: whether it takes much longer than others
    """

    name: str
    exam: Exam
    files: tuple[tuple[str, str], ...]
    bound: float | None = None
    slow: bool = False


@dataclass(frozen=True)
class Way:
    """How the tasks of one repeat are run."""

    name: str
    jobs: int
    burners: int = 0


def main() -> int:
    """
    Measure, print and save.

    :returns: exit code, 1 if anything differs
    """
    chosen = _arguments()
    os.environ.setdefault('COURSE_SECRET', 'benchmark')
    facts = report.machine()
    sandbox = strongest()
    tasks = [*_submissions(), *(() if chosen.no_attacks else _attacks())]
    if chosen.only:
        tasks = [task for task in tasks if chosen.only in task.name]
    if chosen.quick:
        tasks = [task for task in tasks if not task.slow]
    ways = (
        Way('calm', CORES),
        Way('oversubscribed', CORES, burners=chosen.oversubscribe * CORES),
        Way('parallel', chosen.parallel),
    )
    until = time.monotonic() + 60 * chosen.minutes
    seen: dict[str, Counter[str]] = {task.name: Counter() for task in tasks}
    repeats: list[dict[str, Any]] = []
    try:
        for number in range(chosen.repeats):
            way = ways[number % len(ways)]
            repeats.append(_repeat(tasks, way, sandbox, seen, number, until))
            _say(repeats[-1], seen)
            if time.monotonic() > until:
                print('The time is over; this is what was seen until now.')
                break
    except KeyboardInterrupt:
        print('Stopped; this is what was seen until now.')
    figures = _figures(tasks, repeats, seen, sandbox.mode, chosen.quick)
    _print(facts, figures)
    report.save(
        'soak', facts, figures, full=bool(repeats) and not (chosen.only or chosen.no_attacks)
    )
    return 1 if figures['differing'] else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog='python -m benchmarks.soak')
    number: dict[str, Any] = {'type': int, 'metavar': 'N'}
    said = '(default: %(default)s)'
    help_text = f'repeats, each of all tasks in one of the three ways {said}'
    parser.add_argument('--repeats', default=FULL_REPEATS, help=help_text, **number)
    help_text = f'burners for each processor {said}'
    parser.add_argument('--oversubscribe', default=8, help=help_text, **number)
    parser.add_argument('--parallel', default=8, help=f'runs at a time {said}', **number)
    help_text = 'begin no further run after so many minutes (default: no end)'
    parser.add_argument('--minutes', type=float, default=1e6, metavar='M', help=help_text)
    help_text = 'without builds and without attacks that run into a limit of time'
    parser.add_argument('--quick', action='store_true', help=help_text)
    parser.add_argument('--no-attacks', action='store_true', help='submissions only')
    parser.add_argument('--only', default='', metavar='TEXT', help='tasks with this in their name')
    return parser.parse_args()


def _submissions() -> Iterator[Task]:
    """Yield every exam on the files of every submission; equal files are one task."""
    layout = Layout.here()
    engine = SandboxEngine(strongest())
    known = set()
    for assignment in layout.assignments():
        lesson = load_lesson(layout, assignment, engine)
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
    """Yield every program of the corpus."""
    for attack in programs():
        files = tuple(sorted(files_of(attack).items()))
        bound = attack.points if attack.at_most or attack.review else None
        name, exam = f'attack/{attack.kind}/{attack.name}', exams.load(attack.kind)
        # A flag that names a limit, or a bound, means that it goes on until somebody ends it.
        slow = bound is not None or any(word in str(attack.flags) for word in ENDED)
        yield Task(name, exam, files, bound, slow or exam.scenario.program == 'build')


def _repeat(
    tasks: Sequence[Task],
    way: Way,
    sandbox: Sandbox,
    seen: dict[str, Counter[str]],
    number: int,
    until: float,
) -> dict[str, Any]:
    """Run all tasks once, in an order of their own, and note what came of each."""
    order = random.Random(number).sample(tasks, len(tasks))
    began = time.monotonic()

    def run(task: Task) -> str | None:
        return _outcome(task, sandbox) if time.monotonic() < until else None

    with busy(way.burners) if way.burners else nullcontext(), ThreadPoolExecutor(way.jobs) as pool:
        outcomes = list(pool.map(run, order))
    for task, outcome in zip(order, outcomes):
        if outcome is not None:
            seen[task.name][outcome] += 1
    return {
        'way': way.name,
        'jobs': way.jobs,
        'burners': way.burners,
        'runs': sum(outcome is not None for outcome in outcomes),
        'wall_s': round(time.monotonic() - began, 1),
        'load': round(os.getloadavg()[0], 1),
    }


def _outcome(task: Task, sandbox: Sandbox) -> str:
    """Return all that a result says, as JSON."""
    try:
        result = examine(task.exam, dict(task.files), sandbox=sandbox)
    except GraderError as error:
        return f'for review: {type(error).__name__}'
    if task.bound is not None:
        within = result.points <= task.bound
        return 'within its bound' if within else f'{result.points:g} points, over its bound'
    data = {name: value for name, value in result.to_json().items() if name not in NOT_COMPARED}
    return json.dumps(data, sort_keys=True)


def _verdicts(outcome: str) -> str:
    """Return the verdicts in an outcome, without the texts."""
    if not outcome.startswith('{'):
        return outcome
    return ' '.join(f'{one["check"]}:{one["verdict"]}' for one in json.loads(outcome)['checks'])


def _allowed(task: Task, outcome: str) -> bool:
    """Tell whether luck may decide between this and another outcome."""
    return task.bound is not None and not outcome.endswith('over its bound')


def _figures(
    tasks: Sequence[Task],
    repeats: Sequence[dict[str, Any]],
    seen: dict[str, Counter[str]],
    mode: str,
    quick: bool,
) -> dict[str, Any]:
    """Put the figures together, as they are saved."""
    ways: dict[str, dict[str, Any]] = {}
    for repeat in repeats:
        way = ways.setdefault(repeat['way'], {'repeats': 0, 'runs': 0, 'wall_s': 0.0, 'load': []})
        way.update(jobs=repeat['jobs'], burners=repeat['burners'])
        way['repeats'] += 1
        way['runs'] += repeat['runs']
        way['wall_s'] = round(way['wall_s'] + repeat['wall_s'], 1)
        way['load'].append(repeat['load'])
    differing = {}
    for task in tasks:
        outcomes = [one for one in seen[task.name] if not _allowed(task, one)]
        if len(outcomes) > 1 or (task.bound is not None and outcomes):
            differing[task.name] = dict(seen[task.name])
    verdicts = [
        name for name, found in differing.items() if len({_verdicts(one) for one in found}) > 1
    ]
    return {
        'isolation': mode,
        'without_slow_tasks': quick,
        'tasks': len(tasks),
        'attacks': sum(task.name.startswith('attack/') for task in tasks),
        'compared_with_a_bound': sum(task.bound is not None for task in tasks),
        'runs': sum(repeat['runs'] for repeat in repeats),
        'least_repeats_of_a_task': min(sum(found.values()) for found in seen.values()),
        'ways': ways,
        'differing_verdicts': verdicts,
        'differing': differing,
    }


def _say(repeat: dict[str, Any], seen: dict[str, Counter[str]]) -> None:
    several = sum(len(found) > 1 for found in seen.values())
    print(
        f'{repeat["way"]}: {repeat["runs"]} runs in {repeat["wall_s"]} s, load {repeat["load"]}; '
        f'{several or "no"} tasks with more than one outcome so far',
        flush=True,
    )


def _print(facts: dict[str, Any], figures: dict[str, Any]) -> None:
    print(f'\nThe same files judged again and again, isolation {figures["isolation"]}\n')
    report.print_machine(facts)
    rows: list[list[object]] = [
        ['tasks', figures['tasks']],
        ['... of them attacks', figures['attacks']],
        ['... compared with a bound', figures['compared_with_a_bound']],
        ['runs', figures['runs']],
        ['least runs of one task', figures['least_repeats_of_a_task']],
        ['tasks with another verdict', len(figures['differing_verdicts'])],
        ['tasks with another text', len(figures['differing'])],
    ]
    report.print_table(['', ''], rows)
    for name, found in figures['differing'].items():
        print(name)
        for outcome, count in found.items():
            print(f'    {count} times {_verdicts(outcome)[:300]}')


if __name__ == '__main__':
    sys.exit(main())

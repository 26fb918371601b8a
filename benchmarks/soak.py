"""
Judge the same files again and again, to find out whether a verdict or a message ever changes.

A task is one exam on one set of files: each exam of each submission in ``tests/submissions``, each
program in ``tests/attacks``, and a right and a wrong program for each style of keeping time.  Each
repeat runs all tasks in a different order and in one of four ways.  With ``--recordings``, three
programs run more often, and all events of their recordings are compared.
"""

import argparse
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
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
from autograder.grading.examine import Engine
from autograder.grading.pipeline import load_lesson
from autograder.layout import Layout
from autograder.recording import Event
from autograder.runs.observe import observe
from autograder.runs.program import BUILDS
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.sandbox import Sandbox
from autograder.submission.submission import extract, open_submission
from benchmarks import report
from tests.attacks.corpus import files_of, programs
from tests.clock.style_pairs import judged, NAMES

REPEATS = 12
MANY = 10_000
"""Number of runs from which on the figures are saved as ``soak``, not ``one_pass``."""
PROGRAMS = (
    '03_topics/pass__functions_style/talker',
    '07_temperature_monitor/pass__functions_style/temperature_subscriber',
    '02_spinning/pass__tutorial_style/inspector',
)
"""Tasks whose recordings are compared: a publisher, answers, and bursts in several threads."""
COPIES = 34
"""How often each of them runs in a pass, so that twelve passes have more than 400 runs of each."""
CORES = os.cpu_count() or 1
SLOW_S = 3.0
"""The figures of a pass without load name each run that takes longer."""
KINDS = ('sample', 'build', 'attack', 'style')
"""Kinds of tasks: samples, those whose package is built first, attacks, and styles of time."""
GROUPS = {**{f'{kind}_s': (kind,) for kind in KINDS}, 'corpus_s': KINDS[:2], 'all_s': KINDS}
"""Groups of tasks whose durations are reported, by the name of the figure."""
REVIEW, OVER = 'for review: ', ', over its bound'


@dataclass(frozen=True)
class Task:
    """
    One exam applied to one set of files.

    :param bound: maximum points for a result that is only compared with a bound, else None
    """

    name: str
    exam: Exam
    files: tuple[tuple[str, str], ...]
    bound: float | None = None

    @property
    def builds(self) -> bool:
        """Return whether a run builds a package first."""
        return self.exam.scenario.program in BUILDS

    @property
    def kind(self) -> str:
        """Return the kind of task, one of :data:`KINDS`."""
        if self.name.startswith(('attack/', 'style/')):
            return self.name.partition('/')[0]
        return 'build' if self.builds else 'sample'


@dataclass(frozen=True)
class Way:
    """A mode in which the tasks of one repeat are run."""

    name: str
    jobs: int
    burners: int = 0


WAYS = (
    Way('calm', CORES),
    # Most competing processes are runs instead of busy loops: each run has the same number of
    # competitors, and twice as many runs are completed.
    Way('oversubscribed', 6 * CORES, burners=2 * CORES),
    Way('parallel', 8),
    Way('one at a time', 1),
)


@dataclass(frozen=True)
class Ran:
    """
    One run of a task.

    :param outcome: the result without timing and pictures, as JSON
    :param shown: the pictures, as JSON
    :param reason: possible reasons for the duration
    """

    task: Task
    outcome: str
    shown: str = ''
    reason: str = ''
    seconds: float = 0.0


def main() -> int:
    """
    Measure, then print and save the figures.

    :returns: exit code, 1 if any outcome differs
    """
    chosen = _arguments()
    os.environ.setdefault('COURSE_SECRET', 'benchmark')
    facts = report.machine()
    tasks = [one for one in all_tasks() if chosen.only in one.name]
    if chosen.list:
        print('\n'.join(task.name for task in tasks))
        return 0
    run, copies = _run, 1
    if chosen.recordings:
        run, copies = _record, COPIES
        tasks = [one for one in tasks if one.name in PROGRAMS]
    sandbox = strongest()
    outcomes: defaultdict[str, Counter[str]] = defaultdict(Counter)
    pictures: defaultdict[str, Counter[str]] = defaultdict(Counter)
    done: list[dict[str, Any]] = []
    until = time.monotonic() + 60 * chosen.minutes
    try:
        while len(done) < chosen.passes and time.monotonic() < until:
            repeat, found = _repeat(tasks * copies, run, sandbox, len(done), until)
            done.append(repeat)
            for one in found:
                outcomes[one.task.name][one.outcome] += 1
                pictures[one.task.name][one.shown] += 1
            several = len(report.differing(outcomes))
            print(len(done), repeat, f'{several} tasks with more than one outcome', flush=True)
    except KeyboardInterrupt:
        print('Stopped; these are the results so far.')
    figures = {
        'isolation': sandbox.mode,
        **_figures(tasks, done, outcomes),
        'differing_pictures': sorted(report.differing(pictures)),
    }
    # Save a measurement that did not run all tasks only if outcomes differ.
    full = not chosen.only and figures['least_repeats_of_a_task'] > 0
    name = 'soak' if figures['runs'] >= MANY else 'one_pass'
    if chosen.recordings:
        name, full = 'recordings', full and len(done) >= REPEATS
    report.save(name, facts, figures, full=full or bool(figures['differing']))
    return 1 if figures['differing'] else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog='python -m benchmarks.soak')
    help_text = 'start no further run after this many minutes (default: no limit)'
    parser.add_argument('--minutes', type=float, default=1e6, metavar='M', help=help_text)
    help_text = f'number of passes (default: {REPEATS})'
    parser.add_argument('--passes', type=int, default=REPEATS, metavar='N', help=help_text)
    parser.add_argument('--only', default='', metavar='TEXT', help='run only tasks named *TEXT*')
    help_text = 'compare the recordings of three programs instead of all verdicts'
    parser.add_argument('--recordings', action='store_true', help=help_text)
    parser.add_argument('--list', action='store_true', help='print the names of the tasks only')
    return parser.parse_args()


# -- tasks ---------------------------------------------------------------------------------


def all_tasks() -> Iterator[Task]:
    """Yield each exam of each submission, then each attack, then the styles of keeping time."""
    layout = Layout.here()
    for assignment in layout.assignments():
        yield from _submissions(layout, assignment)
    yield from _attacks()
    for style in NAMES:
        for right in (True, False):
            exam, files = judged(style, right)
            name = f'style/{style}/{"right" if right else "wrong"}'
            yield Task(name, exam, tuple(files.items()))


def _submissions(layout: Layout, assignment: str) -> Iterator[Task]:
    """Yield every exam on the files of every submission; equal files give one task."""
    lesson = load_lesson(layout, assignment, Engine(strongest()))
    known = set()
    for sample in samples(layout, assignment, everything=True):
        opened = open_submission(compose(layout, assignment, sample), lesson.release, 'it')
        found = extract(opened, lesson.exams, lesson.release, lesson.notebook)
        for exam in lesson.exams:
            files = tuple(sorted(found[exam.name].files.items()))
            if (exam.name, files) not in known:
                known.add((exam.name, files))
                name = f'{assignment}/{sample.name}/{exam.name}'
                yield Task(name, exam, files)


def _attacks() -> Iterator[Task]:
    """Yield a task for every program in ``tests/attacks``."""
    for attack in programs():
        files = tuple(sorted(files_of(attack).items()))
        bound = attack.points if attack.at_most else None
        name, exam = f'attack/{attack.kind}/{attack.name}', catalog.load(attack.kind)
        yield Task(name, exam, files, bound)


# -- runs ----------------------------------------------------------------------------------


def _repeat(
    tasks: Sequence[Task],
    run: Callable[[Task, Sandbox], Ran],
    sandbox: Sandbox,
    number: int,
    until: float,
) -> tuple[dict[str, Any], list[Ran]]:
    """Run all tasks once, in an order and a way that depend on the repeat."""
    way = WAYS[number % len(WAYS)]
    order = random.Random(number).sample(tasks, len(tasks))
    began = time.monotonic()

    def timed(task: Task) -> Ran | None:
        began = time.monotonic()
        if began > until:
            return None
        return replace(run(task, sandbox), seconds=time.monotonic() - began)

    with report.busy(way.burners), ThreadPoolExecutor(way.jobs) as pool:
        try:
            found = [one for one in pool.map(timed, order) if one is not None]
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
    return {**repeat, **_durations(found, way)}, found


def _durations(found: Sequence[Ran], way: Way) -> dict[str, Any]:
    """Return how long the runs of each kind of task take and, without load, name slow ones."""
    durations: dict[str, Any] = {}
    for name, kinds in GROUPS.items():
        each_s = [one.seconds for one in found if one.task.kind in kinds]
        if len(each_s) > 1:
            p95 = round(statistics.quantiles(each_s, n=20)[-1], 4)
            durations[name] = {**report.spread(each_s), 'p95': p95}
    if way.jobs <= CORES:
        slow = [one for one in found if one.seconds > SLOW_S]
        slow.sort(key=lambda one: -one.seconds)
        durations['slow'] = {one.task.name: f'{one.seconds:.1f} s: {one.reason}' for one in slow}
    return durations


def _run(task: Task, sandbox: Sandbox) -> Ran:
    """Run a task, without measuring its duration."""
    ends: list[Event] = []

    def keep_end(event: Event) -> None:
        if event['event'] == 'process':
            ends.append(event)

    try:
        result = Engine(sandbox, on_event=keep_end).run(task.exam, dict(task.files))
    except GraderError as error:
        failed = f'{REVIEW}{type(error).__name__}'
        return Ran(task, failed, reason=failed)
    reason = _reason(task, ends)
    if task.bound is not None:
        within = result.points <= task.bound
        outcome = 'within its bound' if within else f'{result.points:g} points{OVER}'
        return Ran(task, outcome, reason=reason)
    data = result.to_json()
    outcome = json.dumps(report.compared(data), sort_keys=True)
    return Ran(task, outcome, json.dumps(data['pictures'], sort_keys=True), reason)


def _record(task: Task, sandbox: Sandbox) -> Ran:
    """Run a task; the outcome is all its events except the processor time."""
    scenario = task.exam.scenario.to_json()
    recording, _ = observe(task.exam.name, scenario, dict(task.files), sandbox)
    # Two events of the same virtual instant may swap places.
    instants: defaultdict[int, list[str]] = defaultdict(list)
    for event in recording.events:
        kept = {key: value for key, value in event.items() if key != 'cpu_s'}
        instants[event.get('clock_ns') or 0].append(json.dumps(kept, sort_keys=True))
    events = json.dumps([[at, sorted(found)] for at, found in sorted(instants.items())])
    return Ran(task, events, reason=_reason(task, recording.of('process')))


def _reason(task: Task, ends: Sequence[Event]) -> str:
    """
    Return possible reasons for the duration of a run.

    :param ends: the ``process`` event of the run; empty if nothing was run
    """
    limits = [f'ended by the grader: {one["killed"]}' for one in ends if one['killed']]
    built = ['builds a package'] * task.builds
    used_s = sum(one['cpu_s'] for one in ends)
    return ', '.join([*limits, *built, f'{used_s:.1f} s of processor time'])


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
            **{
                key: [one[key] for one in mine if key in one]
                for key in (*GROUPS, 'slow')
                if key in mine[0]
            },
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

"""
Judge the same files repeatedly, with and without load, to find out whether a result changes.

The program judges a fixed panel of references, near misses and attacks (``panel.yaml``) 200 times,
or, with ``--everything``, all submissions and attacks a few times.  Each repeat runs all of them
again in a different order.  The repeats alternate between three modes: *calm* (one run per CPU),
*oversubscribed* (runs and busy loops that together need eight times the available CPUs) and
*parallel* (eight runs at a time).  All parts of a result are compared, including texts and flags,
except its ``timing``.  Pictures, whose points may differ by one step of the clock, are counted
separately.  If an attack's points vary from run to run, its docstring states an upper bound, and
its result is compared with that bound.
"""

from __future__ import annotations

import argparse
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, field
import json
import os
import random
import sys
import time
from typing import Any

from autograder.errors import GraderError
from autograder.grading.examine import examine
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.sandbox import Sandbox
from benchmarks import report
from benchmarks.repeat_class import busy
from benchmarks.soak_tasks import everything, panel, Task

FULL_REPEATS, FEW_REPEATS = 200, 3
CORES = os.cpu_count() or 1
NOT_COMPARED = ('timing', 'recording', 'pictures')


@dataclass(frozen=True)
class Way:
    """A mode in which the tasks of one repeat are run."""

    name: str
    jobs: int
    burners: int = 0


@dataclass
class Seen:
    """
    The outcomes of the tasks so far, by task name.

    :param outcomes: how often each outcome was seen, as JSON
    :param pictures: how often each set of pictures was seen
    """

    outcomes: dict[str, Counter[str]] = field(default_factory=lambda: defaultdict(Counter))
    pictures: dict[str, Counter[str]] = field(default_factory=lambda: defaultdict(Counter))


def main() -> int:
    """
    Measure, then print and save the figures.

    :returns: exit code, 1 if any outcome differs
    """
    chosen = _arguments()
    os.environ.setdefault('COURSE_SECRET', 'benchmark')
    facts = report.machine()
    tasks = everything() if chosen.everything else panel()
    tasks = [task for task in tasks if chosen.only in task.name]
    if chosen.quick:
        tasks = [task for task in tasks if not task.slow]
    if chosen.list:
        print('\n'.join(task.name for task in tasks))
        return 0
    sandbox = strongest()
    seen, repeats = Seen(), _repeats(chosen, tasks, sandbox)
    done: list[dict[str, Any]] = []
    try:
        for repeat, found in repeats:
            done.append(repeat)
            for name, outcome, pictures in found:
                seen.outcomes[name][outcome] += 1
                seen.pictures[name][pictures] += 1
            _say(len(done), repeat, seen)
    except KeyboardInterrupt:
        print('Stopped; this is what was seen until now.')
    figures = _figures(tasks, done, seen, sandbox.mode, chosen)
    _print(facts, figures)
    name = 'soak_everything' if chosen.everything else 'soak'
    enough = FEW_REPEATS if chosen.everything else FULL_REPEATS
    full = len(done) >= enough and not chosen.only
    # Save the results of a shorter measurement only if outcomes differ.
    report.save(name, facts, figures, full=full or bool(figures['differing']))
    return 1 if figures['differing'] else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog='python -m benchmarks.soak')
    number: dict[str, Any] = {'type': int, 'metavar': 'N'}
    said = '(default: %(default)s)'
    help_text = 'each submission and attack instead of the panel'
    parser.add_argument('--everything', action='store_true', help=help_text)
    help_text = 'repeats, each of all tasks in one of the three ways (default: '
    help_text += f'{FULL_REPEATS}, of everything {FEW_REPEATS})'
    parser.add_argument('--repeats', default=0, help=help_text, **number)
    help_text = f'programs that want each processor, runs and burners {said}'
    parser.add_argument('--oversubscribe', default=8, help=help_text, **number)
    parser.add_argument('--parallel', default=8, help=f'runs at a time {said}', **number)
    help_text = 'begin no further run after so many minutes (default: no end)'
    parser.add_argument('--minutes', type=float, default=1e6, metavar='M', help=help_text)
    help_text = 'without builds and without attacks that run into a limit of time'
    parser.add_argument('--quick', action='store_true', help=help_text)
    parser.add_argument('--only', default='', metavar='TEXT', help='tasks with this in their name')
    parser.add_argument('--list', action='store_true', help='only print the names of the tasks')
    return parser.parse_args()


Found = list[tuple[str, str, str]]
"""For each run: the task's name, the outcome and the pictures, as JSON."""


def _repeats(
    chosen: argparse.Namespace, tasks: Sequence[Task], sandbox: Sandbox
) -> Iterator[tuple[dict[str, Any], Found]]:
    """Run all tasks repeatedly, alternating between the modes; yield each repeat's results."""
    ways = (
        Way('calm', CORES),
        # Most competing processes are runs instead of busy loops: each run has equally many
        # competitors, and twice as many runs are completed.
        Way('oversubscribed', (chosen.oversubscribe - 2) * CORES, burners=2 * CORES),
        Way('parallel', chosen.parallel),
    )
    until = time.monotonic() + 60 * chosen.minutes
    count = chosen.repeats or (FEW_REPEATS if chosen.everything else FULL_REPEATS)
    for number in range(count):
        if time.monotonic() > until:
            print('The time is over; this is what was seen until now.')
            return
        yield _repeat(tasks, ways[number % len(ways)], sandbox, number, until)


def _repeat(
    tasks: Sequence[Task], way: Way, sandbox: Sandbox, number: int, until: float
) -> tuple[dict[str, Any], Found]:
    """Run all tasks once, in an order that depends on the repeat."""
    order = random.Random(number).sample(tasks, len(tasks))
    began = time.monotonic()

    def run(task: Task) -> tuple[str, str, str] | None:
        return (task.name, *_outcome(task, sandbox)) if time.monotonic() < until else None

    with busy(way.burners) if way.burners else nullcontext(), ThreadPoolExecutor(way.jobs) as pool:
        found = [one for one in pool.map(run, order) if one is not None]
    facts = {
        'way': way.name,
        'jobs': way.jobs,
        'burners': way.burners,
        'runs': len(found),
        'wall_s': round(time.monotonic() - began, 1),
        'load': round(os.getloadavg()[0], 1),
    }
    return facts, found


def _outcome(task: Task, sandbox: Sandbox) -> tuple[str, str]:
    """Return a result without its timing, and its pictures, both as JSON."""
    try:
        result = examine(task.exam, dict(task.files), sandbox=sandbox)
    except GraderError as error:
        return f'for review: {type(error).__name__}', ''
    if task.bound is not None:
        within = result.points <= task.bound
        return 'within its bound' if within else f'{result.points:g} points, over its bound', ''
    data = result.to_json()
    compared = {name: value for name, value in data.items() if name not in NOT_COMPARED}
    return json.dumps(compared, sort_keys=True), json.dumps(data.get('pictures'), sort_keys=True)


def _verdicts(outcome: str) -> str:
    """Return only the verdicts of an outcome, without the texts."""
    if not outcome.startswith('{'):
        return outcome
    return ' '.join(f'{one["check"]}:{one["verdict"]}' for one in json.loads(outcome)['checks'])


def _allowed(task: Task, outcome: str) -> bool:
    """Return whether an outcome may vary from run to run."""
    return task.bound is not None and not outcome.endswith('over its bound')


def _differing(tasks: Sequence[Task], seen: Seen) -> dict[str, dict[str, int]]:
    """Return the tasks with more than one outcome, or with an outcome above its bound."""
    differing = {}
    for task in tasks:
        outcomes = [one for one in seen.outcomes[task.name] if not _allowed(task, one)]
        if len(outcomes) > 1 or (task.bound is not None and outcomes):
            differing[task.name] = dict(seen.outcomes[task.name])
    return differing


def _figures(
    tasks: Sequence[Task],
    repeats: Sequence[dict[str, Any]],
    seen: Seen,
    mode: str,
    chosen: argparse.Namespace,
) -> dict[str, Any]:
    """Combine the measurements into the figures to save."""
    ways: dict[str, dict[str, Any]] = {}
    for repeat in repeats:
        way = ways.setdefault(repeat['way'], {'repeats': 0, 'runs': 0, 'wall_s': 0.0, 'load': []})
        way.update(jobs=repeat['jobs'], burners=repeat['burners'])
        way['repeats'] += 1
        way['runs'] += repeat['runs']
        way['wall_s'] = round(way['wall_s'] + repeat['wall_s'], 1)
        way['load'].append(repeat['load'])
    for way in ways.values():
        way['load'] = {'least': min(way['load']), 'most': max(way['load'])}
    counts = [sum(seen.outcomes[task.name].values()) for task in tasks]
    differing = _differing(tasks, seen)
    return {
        'isolation': mode,
        'of': 'everything' if chosen.everything else 'the panel',
        'without_slow_tasks': bool(chosen.quick),
        'tasks': len(tasks),
        'attacks': sum(task.name.startswith('attack/') for task in tasks),
        'compared_with_a_bound': sum(task.bound is not None for task in tasks),
        'repeats': len(repeats),
        'runs': sum(counts),
        'least_repeats_of_a_task': min(counts, default=0),
        'ways': ways,
        'distinct_outcomes': sum(len(found) for found in seen.outcomes.values()),
        'differing_verdicts': [
            name for name, found in differing.items() if len({_verdicts(one) for one in found}) > 1
        ],
        'for_review': {
            name: sum(found[one] for one in found if one.startswith('for review'))
            for name, found in seen.outcomes.items()
            if any(one.startswith('for review') for one in found)
        },
        'differing': differing,
        'differing_pictures': [name for name, found in seen.pictures.items() if len(found) > 1],
    }


def _say(number: int, repeat: dict[str, Any], seen: Seen) -> None:
    several = sum(len(found) > 1 for found in seen.outcomes.values())
    print(
        f'{number}, {repeat["way"]}: {repeat["runs"]} runs in {repeat["wall_s"]} s, load '
        f'{repeat["load"]}; {several or "no"} tasks with more than one outcome so far',
        flush=True,
    )


def _print(facts: dict[str, Any], figures: dict[str, Any]) -> None:
    print(f'\nThe same files judged again and again, isolation {figures["isolation"]}\n')
    report.print_machine(facts)
    rows: list[list[object]] = [
        ['tasks', figures['tasks']],
        ['... of them attacks', figures['attacks']],
        ['... compared with a bound', figures['compared_with_a_bound']],
        ['repeats', figures['repeats']],
        ['runs', figures['runs']],
        ['least runs of one task', figures['least_repeats_of_a_task']],
        ['distinct outcomes', figures['distinct_outcomes']],
        ['tasks with another verdict', len(figures['differing_verdicts'])],
        ['tasks with another text', len(figures['differing'])],
        ['tasks with another picture', len(figures['differing_pictures'])],
    ]
    report.print_table(['', ''], rows)
    for name, found in figures['differing'].items():
        print(name)
        for outcome, count in found.items():
            print(f'    {count} times {_verdicts(outcome)[:300]}')


if __name__ == '__main__':
    sys.exit(main())

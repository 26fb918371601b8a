"""
Run three programs again and again, with and without load, and compare the recordings.

One program publishes, one answers inputs, and one handles bursts in several threads.  Recordings
are compared as sets of events for each instant of virtual time, because two events of the same
instant may swap places.
"""

import argparse
from collections import Counter, defaultdict
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
import json
import os
import sys
import time
from typing import Any

from autograder.recording import Recording
from autograder.runs.observe import observe
from autograder.sandboxes.choose import strongest
from benchmarks import report
from benchmarks.soak import all_tasks, Task

PROGRAMS = (
    '03_topics/pass__functions_style/talker',
    '07_temperature_monitor/pass__functions_style/temperature_subscriber',
    '02_spinning/pass__tutorial_style/inspector',
)
"""Lesson, sample submission and exam of each program, as in the soak benchmark."""
REPEATS = 200
CORES = os.cpu_count() or 1
BURNERS = {'calm': 0, 'eight busy processes per core': 8 * CORES}


def main() -> int:
    """
    Measure, then print and save the figures.

    :returns: exit code, 1 if any two recordings of a program differ
    """
    parser = argparse.ArgumentParser(prog='python -m benchmarks.same_recordings')
    help_text = 'how often to run each program in each way (default: %(default)s)'
    parser.add_argument('--repeats', type=int, default=REPEATS, metavar='N', help=help_text)
    repeats = parser.parse_args().repeats
    os.environ.setdefault('COURSE_SECRET', 'benchmark')
    facts = report.machine()
    known = {task.name: task for task in all_tasks()}
    tasks = [known[name] for name in PROGRAMS]
    seen: defaultdict[str, Counter[str]] = defaultdict(Counter)
    ways: dict[str, Any] = {}
    for way, burners in BURNERS.items():
        walls = defaultdict(list)
        with report.busy(burners), ThreadPoolExecutor(CORES) as pool:
            for task in tasks:
                for found, wall_s in pool.map(_run_of(task), range(repeats)):
                    seen[task.exam.name][found] += 1
                    walls[task.exam.name].append(wall_s)
            load = report.load()
        ways[way] = {
            'load': load,
            'run_s': {name: report.spread(each) for name, each in walls.items()},
        }
        print(way, ways[way], {name: len(found) for name, found in seen.items()}, flush=True)
    figures = {
        'runs': {name: found.total() for name, found in seen.items()},
        'distinct_recordings': {name: len(found) for name, found in seen.items()},
        'ways': ways,
    }
    report.save('same_recordings', facts, figures, full=repeats >= REPEATS)
    return int(bool(report.differing(seen)))


def _run_of(task: Task) -> Callable[[int], tuple[str, float]]:
    """Return a function that runs a task, and returns its events and the duration [s]."""

    def once(_: int) -> tuple[str, float]:
        began = time.monotonic()
        scenario = task.exam.scenario.to_json()
        recording, _timing = observe(task.exam.name, scenario, dict(task.files), strongest())
        events = _events(recording)
        return events, time.monotonic() - began

    return once


def _events(recording: Recording) -> str:
    """Return the events, sorted within each virtual instant, without the processor time."""
    instants: defaultdict[int, list[str]] = defaultdict(list)
    for event in recording.events:
        kept = {key: value for key, value in event.items() if key != 'cpu_s'}
        instants[event.get('clock_ns') or 0].append(json.dumps(kept, sort_keys=True))
    return json.dumps([[at, sorted(found)] for at, found in sorted(instants.items())])


if __name__ == '__main__':
    sys.exit(main())

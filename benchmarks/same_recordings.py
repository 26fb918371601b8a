"""
Run three programs again and again, calm and under load, and compare what was recorded.

One program publishes, one answers inputs, and one handles bursts in several threads.  Recordings
are compared as sets of events for each instant of virtual time, because two events of the same
instant may change places.
"""

import argparse
from collections import Counter, defaultdict
from concurrent.futures import ThreadPoolExecutor
from functools import partial
import json
import os
import sys
import time
from typing import Any

from autograder.authoring.sample_class import compose, samples
from autograder.grading.pipeline import load_lesson, SandboxEngine
from autograder.layout import Layout
from autograder.recording import Recording
from autograder.runs.stored_runs import load_or_record
from autograder.sandboxes.choose import strongest
from autograder.submission.extract import extract
from autograder.submission.submission import open_submission
from benchmarks import report

PROGRAMS = (
    ('03_topics', 'pass__reference', 'talker'),
    ('07_temperature_monitor', 'pass__reference', 'temperature_subscriber'),
    ('02_spinning', 'pass__tutorial_style', 'inspector'),
)
"""Lesson, sample submission and exam of each program."""
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
    seen: defaultdict[str, Counter[str]] = defaultdict(Counter)
    ways: dict[str, Any] = {}
    for way, burners in BURNERS.items():
        walls = defaultdict(list)
        with report.busy(burners), ThreadPoolExecutor(CORES) as pool:
            for program in PROGRAMS:
                for found, wall_s in pool.map(_run_of(program), range(repeats)):
                    seen[program[-1]][found] += 1
                    walls[program[-1]].append(wall_s)
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


def _run_of(program: tuple[str, str, str]) -> Any:
    """Return a function that runs a program, and returns its events and the duration [s]."""
    assignment, wanted, name = program
    layout, sandbox = Layout.here(), strongest()
    lesson = load_lesson(layout, assignment, SandboxEngine(sandbox))
    sample = next(
        one for one in samples(layout, assignment, everything=True) if one.name == wanted
    )
    opened = open_submission(compose(layout, assignment, sample), lesson.release, 'it')
    files = extract(opened, lesson.exams, lesson.release, lesson.notebook)[name].files
    exam = next(one for one in lesson.exams if one.name == name)
    run = partial(load_or_record, exam, files, sandbox)

    def once(_: int) -> tuple[str, float]:
        began = time.monotonic()
        events = _events(run().recording)
        return events, time.monotonic() - began

    return once


def _events(recording: Recording) -> str:
    """Return the events for each instant, in any order within it, without the processor time."""
    instants: defaultdict[int, list[str]] = defaultdict(list)
    for event in recording.events:
        kept = {key: value for key, value in event.items() if key != 'cpu_s'}
        instants[event.get('clock_ns') or 0].append(json.dumps(kept, sort_keys=True))
    return json.dumps([[at, sorted(found)] for at, found in sorted(instants.items())])


if __name__ == '__main__':
    sys.exit(main())

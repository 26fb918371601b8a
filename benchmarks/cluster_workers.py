"""
Compare two cluster workers with one, each on a separate core, like machines of a lab.

The scheduler, the command and the workers run on this machine.  A worker and the sandboxes and
probes that it starts share one core.  The command and the scheduler may use all cores, so the CPU
time that they use is lost to the workers.  One and two workers alternate, with the same class.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, ExitStack
import json
import os
from pathlib import Path
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from typing import Any

from autograder.layout import Layout
from benchmarks import reduced_course, report
from benchmarks.class_of_200 import class_of, MORE_CHECKS, SECONDS

FULL_SIZE, FULL_ROUNDS = 80, 3
READY_S = 120


def main() -> None:
    """Measure, then print and save the figures."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks.cluster_workers')
    parser.add_argument('--size', type=int, default=FULL_SIZE, metavar='N', help='submissions')
    parser.add_argument('--rounds', type=int, default=FULL_ROUNDS, metavar='N')
    chosen = parser.parse_args()
    if len(os.sched_getaffinity(0)) < 2:
        parser.error('expected two cores, one for each worker, got one')
    facts = report.machine()
    with tempfile.TemporaryDirectory(prefix='benchmark_') as folder:
        answers = class_of(chosen.size)
        layout = reduced_course.build(Path(folder), answers, SECONDS, MORE_CHECKS, 2)
        graded = [grade(layout, workers) for _ in range(chosen.rounds) for workers in (1, 2)]
    figures = _figures(chosen.size, graded)
    report.print_machine(facts)
    print(json.dumps(figures, indent=2))
    full = chosen.size >= FULL_SIZE and chosen.rounds >= FULL_ROUNDS
    report.save('cluster_workers', facts, figures, full=full)


def grade(layout: Layout, workers: int) -> dict[str, Any]:
    """
    Grade the class on a number of workers, as if for the first time.

    :raises RuntimeError: with the command's output, if it produces no verdicts
    """
    shutil.rmtree(layout.work, ignore_errors=True)
    with cluster(layout, workers) as address:
        command = [sys.executable, '-m', 'autograder', 'grade', '--json', '--cluster', address]
        done = subprocess.run(
            [*command, '--submitted', str(reduced_course.submitted(layout))],
            cwd=layout.root,
            env={**os.environ, 'COURSE_SECRET': 'benchmark'},
            capture_output=True,
            text=True,
            check=False,
        )
    running = re.search(r'of which runs took ([\d.]+) s', done.stderr)
    if done.returncode != 0 or running is None:
        raise RuntimeError(f'autograder grade ended with {done.returncode}:\n{done.stderr}')
    return {'workers': workers, 'running_s': float(running[1]), 'points': _points(done.stdout)}


@contextmanager
def cluster(layout: Layout, workers: int) -> Iterator[str]:
    """Yield the address of a scheduler with a number of workers, each on a separate core."""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(n_workers=0, host='127.0.0.1', dashboard_address=None) as local,
        ExitStack() as running,
    ):
        address = str(local.scheduler_address)
        for core in sorted(os.sched_getaffinity(0))[:workers]:
            running.enter_context(worker(layout, address, core))
        with Client(address, set_as_default=False) as client:
            client.wait_for_workers(workers, timeout=READY_S)
        yield address


@contextmanager
def worker(layout: Layout, address: str, core: int) -> Iterator[None]:
    """Run a worker that executes one run at a time."""
    command = ['taskset', '--cpu-list', str(core), sys.executable, '-m', 'dask', 'worker']
    command += [address, '--nworkers', '1', '--nthreads', '1', '--no-dashboard', '--no-nanny']
    with subprocess.Popen(
        [*command, '--local-directory', str(layout.root)],
        cwd=layout.root,  # the worker uses the grader in this copy
        stderr=subprocess.DEVNULL,
    ) as process:
        try:
            yield
        finally:
            process.terminate()


def _points(results: str) -> Mapping[str, float]:
    """Return the points by student."""
    return {
        one['student']: sum(
            float(check['points']) for exam in one['exams'] for check in exam['checks']
        )
        for one in json.loads(results)
    }


def _figures(size: int, graded: list[dict[str, Any]]) -> dict[str, Any]:
    """Combine the measurements into the figures to save."""
    points = [run.pop('points') for run in graded]
    one, two = (
        statistics.median(run['running_s'] for run in graded if run['workers'] == workers)
        for workers in (1, 2)
    )
    return {
        'submissions': size,
        'exam': f'{SECONDS} s at 1 Hz, 10 checks',
        'two_workers_against_one': round(one / two, 2),
        'same_points': all(each == points[0] for each in points),
        'runs': graded,
    }


if __name__ == '__main__':
    main()

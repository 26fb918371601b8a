"""
Compare two cluster workers with one, each on a separate core, like machines in a lab.

The scheduler, the command and the workers run on this machine.  A worker and the sandboxes and
probes that it starts share one core.  The command and the scheduler may use all cores, so their
CPU time is lost to the workers.  One and two workers alternate, with the same class.
"""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager, ExitStack
import os
from pathlib import Path
import statistics
import subprocess
import sys
import tempfile

from autograder.layout import Layout
from benchmarks import reduced_course, report
from benchmarks.class_of_200 import class_in, SECONDS

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
    running_s: dict[int, list[float]] = {1: [], 2: []}
    points = []
    with tempfile.TemporaryDirectory(prefix='benchmark_') as folder:
        layout = class_in(Path(folder), chosen.size)
        for _ in range(chosen.rounds):
            for workers, times in running_s.items():
                with cluster(layout, workers) as address:
                    graded = reduced_course.grade(layout, '--cluster', address)
                times.append(graded.running_s)
                points.append(graded.points)
    one_s, two_s = map(statistics.median, running_s.values())
    figures = {
        'submissions': chosen.size,
        'exam': f'{SECONDS} s at 1 Hz, 10 checks',
        'two_workers_against_one': round(one_s / two_s, 2),
        'same_points': all(each == points[0] for each in points),
        'running_s': running_s,
    }
    full = chosen.size >= FULL_SIZE and chosen.rounds >= FULL_ROUNDS
    report.save('cluster_workers', facts, figures, full=full)


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


if __name__ == '__main__':
    main()

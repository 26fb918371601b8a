"""
Grade a class of 200 with ten checks each; measure CPU time, memory and the gain of two workers.

No two submissions have the same files, so they share no recordings.  Half of them are correct,
half are wrong in different ways.  CPU time is measured with a control group, in which the kernel
accounts for every process that the command starts, including sandboxes.

On an idle machine, a run stays on one core, but any core may start it and read its output.  So two
workers are compared with one worker twice: on the same cores, and with one core per worker, as in
a lab with identical machines.

The greatest possible gain of two workers is measured before and after: the time of two processes
that only count, compared with one that does the same work.  Virtual CPUs may share one real CPU.
"""

import argparse
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
import os
from pathlib import Path
import re
import shutil
import statistics
import tempfile
import threading
import time
from typing import Any

import psutil

from autograder.layout import Layout
from autograder.recording import Recording
from benchmarks import reduced_course, report
from benchmarks.reduced_course import publishers, REFERENCE

FULL_SIZE = 200
SECONDS = 60
COUNT, COUNTED = 5_000_000, 10
CONTROLLED = ('/sys/fs/cgroup', '/sys/fs/cgroup/unified', '/sys/fs/cgroup/cpuacct')
SAMPLES = (
    REFERENCE,
    'fail__two_hertz',
    'pass__lambda_and_subclass',
    'fail__topic_typo',
    'pass__functions_style',
    'fail__best_effort',
    'pass__whole_degrees',
    'error__exception_in_callback',
)
MORE_CHECKS = '''

from autograder.exam.exam import Failed, Run


@exam.check(points=1, needs=['starts_its_node'])
def sends_at_least_ten(run: Run) -> None:
    """Your node sends at least ten messages."""
    if len(run.recording.messages('/temperature_topic')) < 10:
        raise Failed(expected='ten messages', observed='fewer')


@exam.check(points=1, needs=['starts_its_node'])
def runs_to_the_end(run: Run) -> None:
    """Your node runs as long as the exam."""
    if run.recording.end_reason != 'complete':
        raise Failed(expected='a whole run', observed=run.recording.end_reason)
'''


def main() -> None:
    """Measure, then print and save the figures."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks.class_of_200')
    parser.add_argument('--size', type=int, default=FULL_SIZE, metavar='N', help='submissions')
    help_text = 'duration of the exam [virtual s]'
    parser.add_argument('--seconds', type=int, default=SECONDS, metavar='N', help=help_text)
    chosen = parser.parse_args()
    size, seconds = chosen.size, chosen.seconds
    facts = report.machine()
    counting = [_two_that_count() for _ in range(COUNTED)]
    with tempfile.TemporaryDirectory(prefix='benchmark_') as folder:
        layout = class_in(Path(folder), size, seconds)
        # Measure in the order two, one, two, to reveal a change in load.
        graded = [_grade(layout, jobs, anew=True) for jobs in (2, 1, 2)]
        on_one_core = _grade(layout, 1, anew=True, before=('taskset', '--cpu-list', '0'))
        again = _grade(layout, 2, anew=False)
        (judged,) = reduced_course.finish(reduced_course.start(layout, 'rejudge')).results
    counting += [_two_that_count() for _ in range(COUNTED)]
    ratios, one_s = zip(*counting)
    two, one, two_again = (run['running_s'] for run in graded)
    best_s = min(two, two_again) or float('nan')
    cpu = [run['cpu_s'] for run in graded if run['cpu_s'] is not None]
    figures = {
        'submissions': size,
        'exam': f'{seconds} s at 1 Hz, 10 checks',
        'cpu_s_a_submission': round(statistics.mean(cpu) / size, 3) if cpu else None,
        'peak_memory_of_coordinator_mib': max(run['coordinator_peak_mib'] for run in graded),
        'two_workers_against_one': round(one / best_s, 2),
        'two_on_two_cores_against_one_on_one': round(on_one_core['running_s'] / best_s, 2),
        'same_points': len({run['points'] for run in (*graded, on_one_core, again)}) == 1,
        'unchanged_ms_a_submission': round(1000 * again['running_s'] / size, 2),
        'unchanged_wall_s': again['wall_s'],
        'judged_again_ms_a_submission': round(1000 * judged['seconds'] / size, 2),
        'not_judged_again': sum(bool(one['kept']) for one in judged['submissions']),
        'runs': [*graded, on_one_core, again],
        'two_that_only_count_against_one': round(statistics.median(ratios), 2),
        'one_counts_ms': round(1000 * statistics.median(one_s)),
    }
    name = 'class_of_200' if seconds == SECONDS else f'class_of_200_{seconds}_s'
    report.save(name, facts, figures, full=size >= FULL_SIZE)


def _two_that_count() -> tuple[float, float]:
    """Return the speed-up of two counting processes over one, and the time of one count [s]."""
    with ProcessPoolExecutor(2) as pool:
        list(pool.map(_count, (1, 1)))  # wait until both processes have started
        began = time.monotonic()
        list(pool.map(_count, (COUNT,)))
        list(pool.map(_count, (COUNT,)))
        between = time.monotonic()
        list(pool.map(_count, (COUNT, COUNT)))
        one_s = (between - began) / 2
        return 2 * one_s / (time.monotonic() - between), one_s


def _count(number: int) -> int:
    return sum(one * one % 7 for one in range(number))


def class_in(folder: Path, size: int, seconds: int = SECONDS) -> Layout:
    """
    Create a class of publishers that differ at least in a comment.

    :param folder: an empty folder
    :param seconds: duration of the exam [virtual s]
    """
    texts = list(publishers(SAMPLES).values())
    answers = {
        f'student{number:03}': f'{texts[number % len(texts)]}\n# student {number}\n'
        for number in range(size)
    }
    return reduced_course.build(folder, answers, seconds, MORE_CHECKS, 2)


def _grade(layout: Layout, jobs: int, anew: bool, before: tuple[str, ...] = ()) -> dict[str, Any]:
    """
    Grade the class with the complete command.

    :param before: prefix of the command line
    :raises RuntimeError: with the command's output, if it produces no verdicts
    """
    if anew:
        shutil.rmtree(layout.work, ignore_errors=True)
    with _counted() as (begin, used_s):
        shell = ('sh', '-c', f'{begin}exec "$@"', 'sh', *before)
        process = reduced_course.start(layout, 'grade', '--jobs', str(jobs), before=shell)
        watch = _Watch(process.pid)
        done = reduced_course.finish(process)
        watch.join()
        cpu_s = used_s()
    exams = [exam for result in done.results for exam in result['exams']]
    recordings = [
        Recording.load(layout.recordings / exam['exam'] / exam['recording'])
        for exam in exams
        if exam['recording']
    ]
    return {
        'jobs': jobs,
        'cores': before[-1] if before else 'all',
        'wall_s': round(done.wall_s, 2),
        'running_s': done.running_s,
        'cpu_s': cpu_s,
        'coordinator_cpu_s': round(watch.cpu_s, 2),
        'coordinator_peak_mib': watch.peak >> 20,
        'programs_cpu_s': round(sum(float(one.process['cpu_s']) for one in recordings), 2),
        **{
            figure: round(sum(exam['timing'].get(name, 0.0) for exam in exams), 3)
            for figure, name in (
                ('judging_s', 'judge_s'),
                ('until_ready_s', 'ready_s'),
                ('runs_s', 'run_s'),
            )
        },
        'points': sum(sum(points.values()) for points in done.points.values()),
    }


@contextmanager
def _counted() -> Iterator[tuple[str, Callable[[], float | None]]]:
    """Yield a shell line that enters a new control group, and a function to read its CPU time."""
    name = f'benchmark_{os.getpid()}_{time.monotonic_ns()}'
    for above in CONTROLLED:
        group = Path(above, name)
        try:
            group.mkdir()
        except OSError:
            continue
        try:
            if any((group / file).is_file() for file in ('cpuacct.usage', 'cpu.stat')):
                yield f'echo $$ > {group}/cgroup.procs && ', partial(_used_s, group)
                return
        finally:
            with suppress(OSError):  # a last process is still ending; an empty group does no harm
                group.rmdir()
    yield '', lambda: None


def _used_s(group: Path) -> float:
    """Return the CPU time of all processes that have ever been in a group [s]."""
    old = group / 'cpuacct.usage'
    if old.is_file():
        return round(int(old.read_text('ascii')) / 1e9, 2)
    used = dict(line.split() for line in (group / 'cpu.stat').read_text('ascii').splitlines())
    return round(int(used['usage_usec']) / 1e6, 2)


class _Watch(threading.Thread):
    """Polls the kernel for the CPU time and peak memory of the command itself until it ends."""

    def __init__(self, pid: int) -> None:
        super().__init__(daemon=True)
        self.process = psutil.Process(pid)
        self.cpu_s, self.peak = 0.0, 0
        self.start()

    def run(self) -> None:
        """Poll ten times a second; both figures only grow."""
        status = Path('/proc', str(self.process.pid), 'status')
        with suppress(psutil.Error, OSError):  # the process has ended
            while True:
                times = self.process.cpu_times()
                self.cpu_s = times.user + times.system
                peak = re.search(r'VmHWM:\s+(\d+) kB', status.read_text('ascii', 'replace'))
                self.peak = max(self.peak, int(peak[1]) << 10 if peak else 0)
                time.sleep(0.1)


if __name__ == '__main__':
    main()

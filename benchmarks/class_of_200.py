"""
Grade a class of 200 with ten checks each; measure CPU time, memory and the gain of two workers.

No two submissions have the same files, so they share no recordings.  Half of them are correct,
half are wrong in different ways.  CPU time is measured with a control group, in which the kernel
accounts for every process that the command starts, including sandboxes.

A run stays on one core of a calm machine, but starts and is read on any.  So two workers are
compared with one worker twice: on the same cores, and with one core per worker, as in a lab with
identical machines.

The greatest possible gain of two workers is measured before and after: the time of two processes
that only count, against one process that does the same work.  Virtual CPUs may share one real CPU.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial
import json
import os
from pathlib import Path
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from typing import Any

import psutil

from autograder.layout import Layout
from autograder.recording import Recording
from benchmarks import reduced_course, report
from benchmarks.submissions import publishers, REFERENCE

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
    parser.add_argument(
        '--seconds', type=int, default=SECONDS, metavar='N', help='virtual, of the exam'
    )
    chosen = parser.parse_args()
    size, seconds = chosen.size, chosen.seconds
    facts = report.machine()
    counting = [_two_that_count() for _ in range(COUNTED)]
    with tempfile.TemporaryDirectory(prefix='benchmark_') as folder:
        answers = class_of(size)
        layout = reduced_course.build(Path(folder), answers, seconds, MORE_CHECKS, 2)
        # Measure in the order two, one, two, so that a change of load becomes visible.
        graded = [_grade(layout, jobs, anew=True) for jobs in (2, 1, 2)]
        on_one_core = _grade(layout, 1, anew=True, cores='0')
        again = _grade(layout, 2, anew=False)
        rejudged = _rejudge(layout)
    counting += [_two_that_count() for _ in range(COUNTED)]
    ratios, one_s = zip(*counting)
    figures = {
        **_figures(size, seconds, graded, on_one_core, again, rejudged),
        'two_that_only_count_against_one': round(statistics.median(ratios), 2),
        'one_counts_ms': round(1000 * statistics.median(one_s)),
    }
    report.print_machine(facts)
    print(json.dumps(figures, indent=2))
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


def class_of(size: int) -> dict[str, str]:
    """Return a class of publishers, by student; each file differs at least in a comment."""
    texts = list(publishers(SAMPLES).values())
    return {
        f'student{number:03}': f'{texts[number % len(texts)]}\n# student {number}\n'
        for number in range(size)
    }


def _grade(layout: Layout, jobs: int, anew: bool, cores: str = '') -> dict[str, Any]:
    """
    Grade the class with the complete command.

    :param cores: CPU numbers that the command may use, in taskset(1) format; empty for all
    :raises RuntimeError: with the command's output, if it produces no verdicts
    """
    if anew:
        subprocess.run(['rm', '-rf', str(layout.work)], check=True)
    command = [sys.executable, '-m', 'autograder', 'grade', '--json', '--jobs', str(jobs)]
    command += ['--submitted', str(reduced_course.submitted(layout))]
    command = ['taskset', '--cpu-list', cores, *command] if cores else command
    with _counted() as (begin, used_s):
        began = time.monotonic()
        process = subprocess.Popen(
            ['sh', '-c', f'{begin}exec "$@"', 'sh', *command],
            cwd=layout.root,  # Python searches here first, so the copy of the grader runs
            env={**os.environ, 'COURSE_SECRET': 'benchmark'},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        watch = _Watch(process.pid)
        said, errors = process.communicate()
        wall_s = time.monotonic() - began
        watch.join()
        cpu_s = used_s()
    if process.returncode != 0:
        raise RuntimeError(f'autograder grade ended with {process.returncode}:\n{errors}')
    results = json.loads(said)
    running = re.search(r'of which runs took ([\d.]+) s', errors)
    return {
        'jobs': jobs,
        'cores': cores or 'all',
        'wall_s': round(wall_s, 2),
        'running_s': float(running[1]) if running else None,
        'cpu_s': cpu_s,
        'coordinator_cpu_s': round(watch.cpu_s, 2),
        'coordinator_peak_mib': watch.peak >> 20,
        'programs_cpu_s': round(_programs_s(layout, results), 2),
        'judging_s': round(_sum(results, 'judge_s'), 3),
        'until_ready_s': round(_sum(results, 'ready_s'), 2),
        'runs_s': round(_sum(results, 'run_s'), 2),
        'points': sum(check['points'] for check in _checks(results)),
    }


@contextmanager
def _counted() -> Iterator[tuple[str, Any]]:
    """Yield a shell line that enters a new control group, and a function to read its CPU time."""
    name = f'benchmark_{os.getpid()}_{time.monotonic_ns()}'
    for above in CONTROLLED:
        group = Path(above, name)
        try:
            group.mkdir()
        except OSError:
            continue
        try:
            files = (group / 'cpuacct.usage', group / 'cpu.stat')
            if any(file.is_file() for file in files):
                yield f'echo $$ > {group}/cgroup.procs && ', partial(_used_s, group)
                return
        finally:
            _remove(group)
    yield '', lambda: None


def _used_s(group: Path) -> float:
    """Return the CPU time of all processes that have ever been in a group [s]."""
    old = group / 'cpuacct.usage'
    if old.is_file():
        return round(int(old.read_text('ascii')) / 1e9, 2)
    for line in (group / 'cpu.stat').read_text('ascii').splitlines():
        if line.startswith('usage_usec'):
            return round(int(line.split()[1]) / 1e6, 2)
    raise RuntimeError(f'{group}: no usage_usec in cpu.stat')


def _remove(group: Path) -> None:
    try:
        group.rmdir()
    except OSError:
        pass  # a last process is still ending; an empty group does no harm


class _Watch(threading.Thread):
    """Polls the kernel for the CPU time and peak memory of the command itself until it ends."""

    def __init__(self, pid: int) -> None:
        super().__init__(daemon=True)
        self.process = psutil.Process(pid)
        self.cpu_s, self.peak = 0.0, 0
        self._ended = threading.Event()
        self.start()

    def run(self) -> None:
        """Poll ten times a second; both figures only grow."""
        status = Path('/proc', str(self.process.pid), 'status')
        try:
            while not self._ended.wait(0.1):
                times = self.process.cpu_times()
                self.cpu_s = times.user + times.system
                peak = re.search(r'VmHWM:\s+(\d+) kB', status.read_text('ascii', 'replace'))
                self.peak = max(self.peak, int(peak[1]) << 10 if peak else 0)
        except (psutil.Error, OSError):
            pass  # the process has ended


def _checks(results: list[Any]) -> Iterator[Mapping[str, Any]]:
    for result in results:
        for exam in result['exams']:
            yield from exam['checks']


def _sum(results: list[Any], name: str) -> float:
    return sum(exam['timing'].get(name, 0.0) for one in results for exam in one['exams'])


def _programs_s(layout: Layout, results: list[Any]) -> float:
    """Return the CPU time of the students' programs alone [s]."""
    seconds = 0.0
    for result in results:
        for exam in result['exams']:
            if exam['recording']:
                path = layout.recordings / exam['exam'] / exam['recording']
                seconds += float(Recording.load(path).process['cpu_s'])
    return seconds


def _rejudge(layout: Layout) -> dict[str, Any]:
    """Judge all submissions again from the recordings, as after an edited check."""
    command = [sys.executable, '-m', 'autograder', 'rejudge', '--json']
    command += ['--submitted', str(reduced_course.submitted(layout))]
    done = subprocess.run(
        command,
        cwd=layout.root,
        env={**os.environ, 'COURSE_SECRET': 'benchmark'},
        capture_output=True,
        text=True,
        check=True,
    )
    (account,) = json.loads(done.stdout)
    return {
        'seconds': account['seconds'],
        'kept': sum(bool(s['kept']) for s in account['submissions']),
    }


def _figures(
    size: int,
    seconds: int,
    graded: list[dict[str, Any]],
    on_one_core: dict[str, Any],
    again: dict[str, Any],
    rejudged: dict[str, Any],
) -> dict[str, Any]:
    """Combine the measurements into the figures to save."""
    two, one, two_again = graded
    best = min(two['running_s'], two_again['running_s'])
    cpu = [run['cpu_s'] for run in graded if run['cpu_s'] is not None]
    return {
        'submissions': size,
        'exam': f'{seconds} s at 1 Hz, 10 checks',
        'cpu_s_a_submission': round(sum(cpu) / len(cpu) / size, 3) if cpu else None,
        'peak_memory_of_coordinator_mib': max(run['coordinator_peak_mib'] for run in graded),
        'two_workers_against_one': round(one['running_s'] / best, 2) if best else None,
        'two_on_two_cores_against_one_on_one': (
            round(on_one_core['running_s'] / best, 2) if best else None
        ),
        'same_points': len({run['points'] for run in (*graded, on_one_core, again)}) == 1,
        'unchanged_ms_a_submission': round(1000 * again['running_s'] / size, 2),
        'unchanged_wall_s': again['wall_s'],
        'judged_again_ms_a_submission': round(1000 * rejudged['seconds'] / size, 2),
        'not_judged_again': rejudged['kept'],
        'runs': [*graded, on_one_core, again],
    }


if __name__ == '__main__':
    main()

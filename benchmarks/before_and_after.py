"""
Grade the same classes with this version and with an earlier one, in turn.

Usage: ``python -m benchmarks.before_and_after FOLDER``, where FOLDER is a clone of the project at
the earlier version in which ``make prepare`` was run.  Each version grades with its own commands
and its own exam, as in ``stock_nbgrader``: 60 s at 1 Hz.
"""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
import itertools
from pathlib import Path
import statistics
import subprocess
import tempfile
from typing import Any

from autograder.layout import Layout
from benchmarks import report

FULL_PAIRS = 6
CLASSES = {'one submission': 1, 'six submissions': 6}
JOBS = (1, 2)
PROGRAM = """
import inspect, sys
from pathlib import Path
from benchmarks.reduced_course import build, grade
try:
    from benchmarks.reduced_course import publishers, SIX
except ImportError:  # before the virtual clock
    from benchmarks.submissions import publishers, SIX
root, count = Path(sys.argv[1]), int(sys.argv[2])
layout = build(root, dict(list(publishers(SIX).items())[:count]), 60)
for jobs in sys.stdin:
    old = 'jobs' in inspect.signature(grade).parameters
    done = grade(layout, int(jobs)) if old else grade(layout, '--fresh', '--jobs', jobs.strip())
    print(done.wall_s, flush=True)
"""
"""Grades one class in one version, once for each line of standard input: the number of jobs."""


def main() -> None:
    """Measure, then print and save the figures."""
    chosen = _arguments()
    facts = report.machine()
    versions = {'before': chosen.folder.resolve(), 'after': Layout.here().root}
    figures: dict[str, Any] = {'commits': {name: _commit(one) for name, one in versions.items()}}
    for (title, count), jobs in itertools.product(CLASSES.items(), JOBS):
        if jobs > count:
            continue
        with _graders(versions, count) as graders:
            pairs = [
                {name: _seconds(one, jobs) for name, one in graders.items()}
                for _ in range(1 + chosen.pairs)
            ][1:]  # the first grading compiles modules and warms the caches
        ratios = [pair['before'] / pair['after'] for pair in pairs]
        figures[f'{title}, --jobs {jobs}'] = {
            **{name: report.spread([pair[name] for pair in pairs]) for name in versions},
            'ratio': round(statistics.median(ratios), 2),
        }
    report.save('before_and_after', facts, figures, full=chosen.pairs >= FULL_PAIRS)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog='python -m benchmarks.before_and_after')
    help_text = 'clone of an earlier version, prepared with make prepare'
    parser.add_argument('folder', type=Path, help=help_text)
    help_text = 'gradings of each class by each version (default: %(default)s)'
    parser.add_argument('--pairs', type=int, default=FULL_PAIRS, metavar='N', help=help_text)
    return parser.parse_args()


def _commit(folder: Path) -> str:
    command = ['git', '-C', str(folder), 'rev-parse', '--short=8', 'HEAD']
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


@contextmanager
def _graders(versions: dict[str, Path], count: int) -> Iterator[dict[str, subprocess.Popen[str]]]:
    """Start a process for each version that has made the class of ``count`` submissions."""
    with tempfile.TemporaryDirectory(prefix='benchmark_') as folder:
        started = {}
        for name, version in versions.items():
            root = Path(folder, name)
            root.mkdir()
            python = str(version / '.venv' / 'bin' / 'python')
            command = [python, '-c', PROGRAM, str(root), str(count)]
            started[name] = subprocess.Popen(
                command, cwd=version, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
            )
        try:
            yield started
        finally:
            for process in started.values():
                process.communicate()  # closes standard input


def _seconds(grader: subprocess.Popen[str], jobs: int) -> float:
    """Grade the class once, and return the real time of the complete command [s]."""
    assert grader.stdin is not None
    assert grader.stdout is not None
    grader.stdin.write(f'{jobs}\n')
    grader.stdin.flush()
    said = grader.stdout.readline()
    if not said:
        raise RuntimeError('A version could not grade its class; its message is above.')
    return float(said)


if __name__ == '__main__':
    main()

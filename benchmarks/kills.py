"""
Kill and restart a grading repeatedly: nothing may be lost, duplicated or left over.

The program grades a class once without disturbance.  Then it grades the class from scratch and, at
random moments, kills the command itself or a process of a run (sandbox, probe, student's program)
without warning.  It starts the same command again until the command completes.  The results and
the gradebook must be the same as after the undisturbed grading.  No sandbox may outlive its
grader, and no temporary file may be left at the end.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
import json
import os
from pathlib import Path
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from typing import Any

import psutil

from autograder.layout import Layout
from benchmarks import reduced_course, report, stock_course
from benchmarks.submissions import ASSIGNMENT, publishers, SIX

FULL_KILLS = 50
SECONDS = 10
ORPHANS_S = 60.0
"""How long the processes of a killed grader may take to end on a busy machine."""
NOT_COMPARED = ('timing', 'recording', 'pictures')
KINDS = ('grader', 'run')
REFUSED = 2
Facts = Mapping[str, Any]


@dataclass
class Account:
    """
    The observations so far.

    :param kills: number of kills by kind of process
    :param wrong: violations, one line each
    :param gradings: number of gradings that completed
    """

    kills: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)
    gradings: int = 0
    starts: int = 0


def main() -> int:
    """
    Measure, then print and save the figures.

    :returns: exit code, 1 if something was lost, duplicated or left over
    """
    parser = argparse.ArgumentParser(prog='python -m benchmarks.kills')
    parser.add_argument('--kills', type=int, default=FULL_KILLS, metavar='N', help='how many')
    parser.add_argument('--seed', type=int, default=1, metavar='N', help='of the instants')
    parser.add_argument('--jobs', type=int, default=2, metavar='N', help='parallel runs')
    chosen = parser.parse_args()
    facts = report.machine()
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix='benchmark_') as folder:
        account = soak(Path(folder), SIX, chosen.kills, chosen.seed, chosen.jobs, SECONDS)
    figures = {
        'kills': dict(account.kills),
        'starts': account.starts,
        'gradings_to_the_end': account.gradings,
        'wrong': account.wrong,
        'seconds': round(time.monotonic() - began),
        'seed': chosen.seed,
    }
    report.print_machine(facts)
    print(json.dumps(figures, indent=2))
    report.save('kills', facts, figures, full=sum(account.kills.values()) >= FULL_KILLS)
    return 1 if account.wrong else 0


def soak(
    root: Path, names: Sequence[str], kills: int, seed: int, jobs: int, seconds: int
) -> Account:
    """
    Kill a grading a number of times, and continue it each time.

    :param root: an empty folder
    :param names: names of sample submissions
    :param seconds: virtual seconds of the exam
    """
    (root / 'tmp').mkdir()
    layout = reduced_course.build(root / 'course', publishers(names), seconds)
    _enter_soon(layout)
    chance, account = random.Random(seed), Account()
    began = time.monotonic()
    peace = _grade_in_peace(layout, jobs)
    length_s = time.monotonic() - began
    while sum(account.kills.values()) < kills:
        shutil.rmtree(layout.work, ignore_errors=True)
        after = None
        while after is None:
            # Short enough to interrupt the grading; after enough kills, let it complete
            # undisturbed.
            ended = sum(account.kills.values()) >= kills
            within_s = None if ended else length_s * chance.uniform(0, 0.8)
            after = _killed_or_done(layout, jobs, within_s, chance, account)
        _compare(peace, after, account)
        account.gradings += 1
        print(f'{sum(account.kills.values())} kills, {len(account.wrong)} wrong', flush=True)
    account.wrong += [f'left: {path.name}' for path in (root / 'tmp').iterdir()]
    return account


def _enter_soon(layout: Layout) -> None:
    """Make the grader record results during the run even for such a small class."""
    path = layout.root / 'autograder' / 'gradebook' / 'live_entry.py'
    text = path.read_text(encoding='utf-8')
    if text.count('TOGETHER = 10') != 1:
        raise RuntimeError(f'{path.name}: expected TOGETHER = 10 once; adapt this benchmark.')
    path.write_text(text.replace('TOGETHER = 10', 'TOGETHER = 2'), encoding='utf-8')


def _command(layout: Layout, jobs: int) -> subprocess.Popen[str]:
    command = [sys.executable, '-m', 'autograder', 'grade', '--json', '--jobs', str(jobs)]
    command += ['--submitted', str(reduced_course.submitted(layout))]
    temporary = str(layout.root.parent / 'tmp')
    return subprocess.Popen(
        command,
        cwd=layout.root,  # Python searches here first, so the copy of the grader runs
        env={**os.environ, 'COURSE_SECRET': 'benchmark', 'TMPDIR': temporary},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def _grade_in_peace(layout: Layout, jobs: int) -> Facts:
    grading = _command(layout, jobs)
    return _facts(layout, grading, *grading.communicate())


def _facts(layout: Layout, grading: subprocess.Popen[str], said: str, errors: str) -> Facts:
    """
    Return everything that a grading printed and wrote to the gradebook.

    :raises RuntimeError: with the command's output, if it did not complete
    """
    if grading.returncode not in (0, 1) or not said:
        raise RuntimeError(f'autograder grade ended with {grading.returncode}:\n{errors}')
    results = {one['student']: _without(one) for one in json.loads(said)}
    return {'results': results, 'entered': stock_course.points(_gradebook(layout), ASSIGNMENT)}


def _gradebook(layout: Layout) -> Path:
    return layout.work / 'gradebook.db'


def _without(data: Any) -> Any:
    """Return a result without the values that differ from run to run."""
    if isinstance(data, dict):
        return {name: _without(one) for name, one in data.items() if name not in NOT_COMPARED}
    return [_without(one) for one in data] if isinstance(data, list) else data


def _killed_or_done(
    layout: Layout,
    jobs: int,
    within_s: float | None,
    chance: random.Random,
    account: Account,
) -> Facts | None:
    """
    Start a grading and kill one of its processes, unless the grading ends before that.

    :param within_s: delay before the kill [s], None for no kill
    :returns: what the grading printed and wrote, None if it did not complete
    """
    grading = _command(layout, jobs)
    account.starts += 1
    try:
        return _facts(layout, grading, *grading.communicate(timeout=within_s))
    except subprocess.TimeoutExpired:
        pass
    kind = chance.choice(KINDS)
    others = _of_runs(grading.pid) if kind == 'run' else []
    if others:
        _kill(chance.choice(others))
        account.kills[kind] += 1
        # The grader runs a submission with a killed run again, or marks it for review until
        # restarted.
        said, errors = grading.communicate()
        if grading.returncode == REFUSED:
            return None  # the kill happened while the grader was trying out the sandbox
        found = _facts(layout, grading, said, errors)
        return found if grading.returncode == 0 else None
    everybody = _family(grading.pid)
    grading.kill()
    account.kills['grader'] += 1
    grading.communicate()
    _, alive = psutil.wait_procs(everybody, timeout=ORPHANS_S)
    # Ignore zombies: they have ended and only wait to be reaped.
    account.wrong += [
        f'orphan: {" ".join(words)[:120]}' for one in alive if (words := _words(one))
    ]
    return None


def _family(pid: int) -> list[psutil.Process]:
    try:
        return psutil.Process(pid).children(recursive=True)
    except psutil.Error:
        return []


def _of_runs(pid: int) -> list[psutil.Process]:
    """Return the processes that start sandboxes, and all processes in them."""
    return [
        one
        for one in _family(pid)
        if any(word == 'bwrap' or word.startswith('/grader/') for word in _words(one))
    ]


def _words(process: psutil.Process) -> list[str]:
    try:
        return list(process.cmdline())
    except psutil.Error:
        return []


def _kill(process: psutil.Process) -> None:
    try:
        process.send_signal(signal.SIGKILL)
    except psutil.Error:
        pass  # the process has just ended


def _compare(peace: Facts, after: Facts, account: Account) -> None:
    """Record the differences between the undisturbed grading and the interrupted one."""
    for part in ('results', 'entered'):
        for student in peace[part].keys() | after[part].keys():
            one, two = peace[part].get(student), after[part].get(student)
            if one != two:
                account.wrong.append(f'{part} of {student}: {one} became {two}'[:400])


if __name__ == '__main__':
    sys.exit(main())

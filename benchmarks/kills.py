"""
Kill and restart a grading run repeatedly: nothing may be lost, duplicated or left over.

The program grades a class once without interruption.  Then it grades the class from scratch and,
at random moments, kills the command itself or a process of the grader in a run (sandbox,
probe) without warning.  It starts the same command again until the command completes.  The
results and the gradebook must be the same as after the uninterrupted grading.  No sandbox may
outlive its grader, and no temporary file may be left at the end.
"""

import argparse
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
import random
import shutil
import subprocess
import sys
import tempfile
import time
from typing import Any

import psutil

from autograder.layout import Layout
from benchmarks import reduced_course, report, stock_course
from benchmarks.reduced_course import ASSIGNMENT, publishers, SIX

FULL_KILLS = 50
SECONDS = 10
ORPHANS_S = 60.0
"""How long the processes of a killed grader may take to end on a busy machine."""
DONE, FOR_REVIEW, REFUSED = 0, 1, 2
Facts = Mapping[str, Mapping[str, Any]]


@dataclass
class Account:
    """
    The observations so far.

    :param kills: number of kills by kind of process
    :param wrong: violations, one line each
    :param gradings: number of grading runs that completed
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
    parser.add_argument(
        '--kills', type=int, default=FULL_KILLS, metavar='N', help='kills in total'
    )
    parser.add_argument('--seed', type=int, default=1, metavar='N', help='seed of the kill times')
    chosen = parser.parse_args()
    facts = report.machine()
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix='benchmark_') as folder:
        account = soak(Path(folder), SIX, chosen.kills, chosen.seed, SECONDS)
    figures = {
        'kills': dict(account.kills),
        'starts': account.starts,
        'gradings_to_the_end': account.gradings,
        'wrong': account.wrong,
        'seconds': round(time.monotonic() - began),
        'seed': chosen.seed,
    }
    report.save('kills', facts, figures, full=account.kills.total() >= FULL_KILLS)
    return 1 if account.wrong else 0


def soak(root: Path, names: Sequence[str], kills: int, seed: int, seconds: int) -> Account:
    """
    Kill a grading run several times, and continue it each time.

    :param root: an empty folder
    :param names: names of sample submissions
    :param seconds: virtual seconds of the exam
    """
    (root / 'tmp').mkdir()
    layout = reduced_course.build(root / 'course', publishers(names), seconds)
    # Make the grader record results during the run even for such a small class.
    entry = layout.root / 'autograder' / 'gradebook' / 'live_entry.py'
    reduced_course.replace_once(entry, 'BATCH_SIZE = 10', 'BATCH_SIZE = 2')
    chance, account = random.Random(seed), Account()
    began = time.monotonic()
    peace = _facts(layout, _start(layout))
    length_s = time.monotonic() - began
    while account.kills.total() < kills:
        shutil.rmtree(layout.work, ignore_errors=True)
        after = None
        while after is None:
            # Choose a time that is short enough to interrupt the grading; after enough kills, let
            # the grading complete undisturbed.
            ended = account.kills.total() >= kills
            within_s = None if ended else length_s * chance.uniform(0, 0.8)
            after = _killed_or_done(layout, within_s, chance, account)
        _compare(peace, after, account)
        account.gradings += 1
        print(f'{account.kills.total()} kills, {len(account.wrong)} wrong', flush=True)
    account.wrong += [f'left: {path.name}' for path in (root / 'tmp').iterdir()]
    return account


def _start(layout: Layout) -> subprocess.Popen[str]:
    temporary = str(layout.root.parent / 'tmp')
    return reduced_course.start(layout, 'grade', '--jobs', '2', TMPDIR=temporary)


def _facts(layout: Layout, grading: subprocess.Popen[str], timeout: float | None = None) -> Facts:
    """
    Return everything that a grading run printed and wrote to the gradebook, by student.

    :raises RuntimeError: with the command's output, if it did not complete
    :raises subprocess.TimeoutExpired: if it is still running
    """
    done = reduced_course.finish(grading, (DONE, FOR_REVIEW), timeout)
    results = {one['student']: report.compared(one) for one in done.results}
    entered = stock_course.points(layout.work / 'gradebook.db', ASSIGNMENT)
    return {'results': results, 'entered': entered}


def _killed_or_done(
    layout: Layout, within_s: float | None, chance: random.Random, account: Account
) -> Facts | None:
    """
    Start a grading run and kill one of its processes, unless the run ends earlier.

    :param within_s: delay before the kill [s], None for no kill
    :returns: everything that the run printed and wrote, None if it did not complete
    """
    grading = _start(layout)
    account.starts += 1
    try:
        return _facts(layout, grading, within_s)
    except subprocess.TimeoutExpired:
        family = _family(grading.pid)
    of_runs = [one for one in family if _starts_or_is_in_a_sandbox(one)]
    if of_runs and chance.random() < 0.5:
        with suppress(psutil.Error):  # the process has just ended
            chance.choice(of_runs).kill()
        account.kills['run'] += 1
        # The grader marks the submission for review, and the next grading runs it again.
        try:
            found = _facts(layout, grading)
        except RuntimeError:
            if grading.returncode != REFUSED:  # refused: the grader was testing the sandbox
                raise
            return None
        return found if grading.returncode == DONE else None
    grading.kill()
    account.kills['grader'] += 1
    grading.communicate()
    _, alive = psutil.wait_procs(family, timeout=ORPHANS_S)
    # Ignore zombies: they have ended and only wait to be reaped.
    account.wrong += [f'orphan: {words[:120]}' for one in alive if (words := _words(one))]
    return None


def _family(pid: int) -> list[psutil.Process]:
    try:
        return psutil.Process(pid).children(recursive=True)
    except psutil.Error:
        return []


def _starts_or_is_in_a_sandbox(process: psutil.Process) -> bool:
    return any(word == 'bwrap' or word.startswith('/grader/') for word in _words(process).split())


def _words(process: psutil.Process) -> str:
    """Return the command line of a process, empty if it has ended."""
    try:
        return ' '.join(process.cmdline())
    except psutil.Error:
        return ''


def _compare(peace: Facts, after: Facts, account: Account) -> None:
    """Record the differences between the uninterrupted grading and the interrupted one."""
    for part in ('results', 'entered'):
        for student in peace[part].keys() | after[part].keys():
            one, two = peace[part].get(student), after[part].get(student)
            if one != two:
                account.wrong.append(f'{part} of {student}: {one} became {two}'[:400])


if __name__ == '__main__':
    sys.exit(main())

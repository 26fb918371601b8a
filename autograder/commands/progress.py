"""
Show the progress of a grading: one changing line on a terminal, repeated lines in a log.

Progress is counted in runs, one per submission and exam.  The remaining time is estimated from the
runs so far, which is too optimistic if many of them were already recorded.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
import os
import sys
import threading
import time
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from autograder.errors import GraderError
from autograder.explaining.feedback import printable
from autograder.grading.pipeline import Done
from autograder.results import shortened

NAME_CHARS = 30
LINE_S = 5.0
"""Time between two lines in a log [s]."""


@dataclass
class Totals:
    """Count the outcomes of a class during the grading; :meth:`add` is thread-safe."""

    counts: Counter[str] = field(default_factory=Counter)
    seconds: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    _guard: threading.Lock = field(default_factory=threading.Lock, repr=False)

    def add(self, done: Done) -> None:
        """Count one run."""
        with self._guard:
            if isinstance(done.outcome, GraderError):
                self.counts['for review'] += 1
                return
            full = done.outcome.points >= done.outcome.max_points
            self.counts['full marks' if full else 'less'] += 1
            self.seconds[done.student] += done.outcome.ran_s

    @property
    def slowest(self) -> tuple[str, float]:
        """Return the student with the longest run time, and the time [s]; ('', 0.0) if unknown."""
        # Students with equal files share a recording and its time: choose the first by name, so
        # that the result does not depend on the order of the runs.
        names = sorted(self.seconds)
        student = max(names, key=lambda name: round(self.seconds[name], 3), default='')
        took = self.seconds.get(student, 0.0)
        return (student, took) if took else ('', 0.0)

    @property
    def count(self) -> int:
        """Return the number of runs that have ended."""
        return self.counts.total()

    def text(self) -> str:
        """Return the totals as text, such as ``3 full marks, 2 less``."""
        words = ['full marks', 'less', *(['for review'] if self.counts['for review'] else [])]
        return ', '.join(f'{self.counts[word]} {word}' for word in words)

    def slowest_text(self) -> str:
        """Return the slowest student as text; empty if unknown."""
        student, took = self.slowest
        if not student:
            return ''
        return f'longest run time: {shortened(printable(student), NAME_CHARS)}, {took:.1f} s'


@contextmanager
def progress(
    total: int, what: str, line_s: float = LINE_S, totals: Totals | None = None
) -> Iterator[Callable[[Done], None]]:
    """
    Show the finished runs, the remaining time and the number of full marks.

    :param total: number of all runs
    :param what: label of the progress line, such as the assignment
    :param line_s: time between two lines without a terminal, or in CI [s]
    :param totals: object that counts the outcomes; None for a new one
    :returns: a function to call after each run, from any thread
    """
    totals, console = totals or Totals(), Console(stderr=True)
    if not is_alive(console):
        with _lines(totals, total, what, line_s):
            yield totals.add
        return
    with _bar(totals, total, what, console) as tell:
        yield tell


def is_alive(console: Any) -> bool:
    """Return whether the console is a terminal that can rewrite a line, and not in CI."""
    return console.is_terminal and os.environ.get('CI', '') in ('', '0', 'false')


@contextmanager
def _bar(totals: Totals, total: int, what: str, console: Any) -> Iterator[Callable[[Done], None]]:
    """Show a progress bar until the context ends."""
    columns: tuple[Any, ...] = (
        TextColumn('{task.description}'),
        BarColumn(bar_width=20),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        TextColumn('{task.fields[totals]}', markup=False),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(escape(what), total=total, totals='')

        def tell(done: Done) -> None:
            totals.add(done)
            said = '; '.join(filter(None, (totals.text(), totals.slowest_text())))
            bar.update(task, advance=1, totals=said)

        yield tell


@contextmanager
def _lines(totals: Totals, total: int, what: str, line_s: float) -> Iterator[None]:
    """Print a line every ``line_s`` seconds until all runs have ended."""
    began, ended = time.monotonic(), threading.Event()

    def print_lines() -> None:
        while not ended.wait(line_s) and totals.count < total:
            said = line_of(totals, total, time.monotonic() - began)
            print(f'{what}: {said}', file=sys.stderr, flush=True)

    printer = threading.Thread(target=print_lines, daemon=True)
    printer.start()
    try:
        yield
    finally:
        ended.set()
        printer.join()


def line_of(totals: Totals, total: int, took_s: float) -> str:
    """Return the progress of a grading as a line for a log."""
    count = totals.count
    words = [f'{count} of {total} runs']
    if count:
        words += [totals.text(), f'about {took_s / count * (total - count):.0f} s left']
    return '; '.join(words)

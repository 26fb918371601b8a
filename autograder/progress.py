"""
How far a grading is: a line on a terminal, nothing in a log.

What is counted are runs: a submission has one for each exam.  The time that is left is estimated
by rich from the pace so far, which equal and kept submissions make faster than it will stay.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
import os
import threading
from typing import Any

from autograder.errors import GraderError
from autograder.explaining.feedback import printable
from autograder.judging.results import ExamResult, shortened

NAME_CHARS = 30


@dataclass(frozen=True)
class Done:
    """
    One exam of one submission is over.

    :param student: whose it is
    :param outcome: the result, or our own fault
    """

    student: str
    exam: str
    outcome: ExamResult | GraderError


@dataclass
class Totals:
    """What came of a class so far; told from any thread."""

    full: int = 0
    less: int = 0
    review: int = 0
    seconds: dict[str, float] = field(default_factory=dict)
    _guard: threading.Lock = field(default_factory=threading.Lock, repr=False)

    def add(self, done: Done) -> None:
        """Count one."""
        with self._guard:
            if isinstance(done.outcome, GraderError):
                self.review += 1
                return
            if done.outcome.points >= done.outcome.max_points:
                self.full += 1
            else:
                self.less += 1
            took = self.seconds.get(done.student, 0.0) + done.outcome.ran_s
            self.seconds[done.student] = took

    @property
    def slowest(self) -> tuple[str, float]:
        """Return who took longest to run, and how long [s]; no name if that is not known."""
        # Equal files take equally long: the first by name, whichever came in first.
        names = sorted(self.seconds)
        student = max(names, key=lambda name: round(self.seconds[name], 3), default='')
        took = self.seconds.get(student, 0.0)
        return (student, took) if took else ('', 0.0)

    def text(self) -> str:
        """Return the totals in a few words."""
        words = [f'{self.full} full marks', f'{self.less} less']
        if self.review:
            words.append(f'{self.review} for review')
        return ', '.join(words)

    def slowest_text(self) -> str:
        """Return who took longest in a few words, empty if that is not known."""
        student, took = self.slowest
        if not student:
            return ''
        return f'longest in runs {shortened(printable(student), NAME_CHARS)}, {took:.1f} s'


@contextmanager
def progress(total: int, what: str) -> Iterator[Callable[[Done], None]]:
    """
    Show what is done, what is left and what came of it; be quiet in CI and where no terminal is.

    :param total: how many runs there will be
    :param what: name of what is graded
    :returns: what to call after each run, from any thread
    """
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True)
    columns: tuple[Any, ...] = (
        TextColumn('{task.description}'),
        BarColumn(bar_width=20),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        TextColumn('{task.fields[totals]}', markup=False),
    )
    totals = Totals()
    with Progress(*columns, console=console, disable=is_quiet(console), transient=True) as bar:
        task = bar.add_task(escape(what), total=total, totals='')

        def tell(done: Done) -> None:
            totals.add(done)
            said = '; '.join(filter(None, (totals.text(), totals.slowest_text())))
            bar.update(task, advance=1, totals=said)

        yield tell


def is_quiet(console: Any) -> bool:
    """Tell whether nobody watches."""
    return not console.is_terminal or os.environ.get('CI', '') not in ('', '0', 'false')

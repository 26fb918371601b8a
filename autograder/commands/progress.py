"""
Show the progress of a grading run: one changing line on a terminal, periodic lines in a log.

Progress is counted in runs, one per submission and exam.  The remaining time is estimated from the
runs so far; the estimate is too low if many of them were already recorded.
"""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
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
from autograder.grading.pipeline import Outcome
from autograder.results import ExamResult, shortened

Tell = Callable[[str, Outcome], None]
NAME_CHARS = 30
LINE_S = 5.0
"""Time between two lines in a log [s]."""


@contextmanager
def progress(total: int, what: str, line_s: float = LINE_S) -> Iterator[Tell]:
    """
    Show the finished runs, the remaining time, the number of full marks and the slowest student.

    :param line_s: time between two lines without a terminal, or in CI [s]
    :returns: a function to call after each run, from any thread
    """
    # Other threads read the counts, so no key is added later.
    counts = Counter({'full marks': 0, 'less': 0, 'for review': 0})
    seconds: dict[str, float] = defaultdict(float)
    guard, console = threading.Lock(), Console(stderr=True)
    alive = is_alive(console)
    bar = Progress(
        TextColumn('{task.description}'),
        BarColumn(bar_width=20),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        TextColumn('{task.fields[totals]}', markup=False),
        console=console,
        transient=True,
        disable=not alive,
    )
    task = bar.add_task(escape(what), total=total, totals='')

    def tell(student: str, outcome: Outcome) -> None:
        with guard:
            counts[kind_of(outcome)] += 1
            if not isinstance(outcome, GraderError):
                seconds[student] += run_s(outcome)
            said = '; '.join(filter(None, (text_of(counts), slowest_text(seconds))))
            bar.update(task, completed=counts.total(), totals=said)

    with bar, nullcontext() if alive else _lines(counts, total, what, line_s):
        yield tell


def kind_of(outcome: Outcome) -> str:
    """Return the key under which a run is counted."""
    if isinstance(outcome, GraderError):
        return 'for review'
    return 'full marks' if outcome.points >= outcome.max_points else 'less'


def is_alive(console: Any) -> bool:
    """Return whether the console is a terminal that can rewrite lines; False in CI."""
    return console.is_terminal and os.environ.get('CI', '') in ('', '0', 'false')


@contextmanager
def _lines(counts: Counter[str], total: int, what: str, line_s: float) -> Iterator[None]:
    """Print a line every ``line_s`` seconds until all runs have ended."""
    began, ended = time.monotonic(), threading.Event()

    def print_lines() -> None:
        while not ended.wait(line_s) and counts.total() < total:
            said = line_of(counts, total, time.monotonic() - began)
            print(f'{what}: {said}', file=sys.stderr, flush=True)

    printer = threading.Thread(target=print_lines, daemon=True)
    printer.start()
    try:
        yield
    finally:
        ended.set()
        printer.join()


def run_s(result: ExamResult) -> float:
    """Return the duration of a run in this grading [s]; 0.0 if its recording was stored."""
    return result.timing.get('run_s', 0.0)


def text_of(counts: Mapping[str, int]) -> str:
    """Return the counts as text, such as ``3 full marks, 2 less``."""
    words = ['full marks', 'less', *(['for review'] if counts['for review'] else [])]
    return ', '.join(f'{counts[word]} {word}' for word in words)


def slowest_text(seconds: Mapping[str, float]) -> str:
    """
    Return the student with the longest run time, as text; empty if no program ran.

    Students with equal files share a run and its time.  Of these, the first by name is
    returned, regardless of the order of the runs.
    """
    student = max(sorted(seconds), key=lambda name: round(seconds[name], 3), default='')
    if not seconds.get(student):
        return ''
    name = shortened(printable(student), NAME_CHARS)
    return f'longest run time: {name}, {seconds[student]:.1f} s'


def line_of(counts: Counter[str], total: int, took_s: float) -> str:
    """Return the progress of the grading run as one log line."""
    count = counts.total()
    words = [f'{count} of {total} runs']
    if count:
        words += [text_of(counts), f'about {took_s / count * (total - count):.0f} s left']
    return '; '.join(words)

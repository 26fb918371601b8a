"""
Keep a run on one processor.

Two threads of a run hardly ever compute at the same time, because its virtual clock wakes them one
by one.  So a second processor gains nothing.  On the contrary: waking a thread there takes longer
than switching to it, because an idle processor must first wake up itself.  Before the clock moves,
program and probe start side by side, and use all processors.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
import os
from pathlib import Path
import threading

BUSY = 2
"""Threads ready to run, per processor, above which a run does not stay on one processor."""
_PROCESSOR = 36  # field "processor" of proc(5), counted after the name of the command
_lock = threading.Lock()
_runs: Counter[int] = Counter()  # runs of this process on each processor


@contextmanager
def one_processor() -> Iterator[set[int]]:
    """
    Choose the processor with the fewest runs for a run, for :func:`keep_on`.

    On a busy machine, no processor is idle, and the system chooses better where to run a thread.
    Then, all processors are chosen.
    """
    allowed = os.sched_getaffinity(0)
    if _ready_to_run() > BUSY * len(allowed):
        yield allowed
        return
    here = _current()
    with _lock:
        # The system has chosen the current processor, and it also knows of other programs.
        chosen = min(allowed, key=lambda one: (_runs[one], one != here))
        _runs[chosen] += 1
    try:
        yield {chosen}
    finally:
        with _lock:
            _runs[chosen] -= 1


def keep_on(processors: set[int], pids: Iterable[int]) -> None:
    """
    Let all threads of these processes, and what they start from now on, use only some processors.

    A process that the grader may not change, or that has ended, is left as it is.

    :param processors: numbers of the processors
    :param pids: host pids
    """
    for pid in pids:
        with suppress(OSError):
            for thread in os.listdir(f'/proc/{pid}/task'):
                os.sched_setaffinity(int(thread), processors)


def _ready_to_run() -> int:
    """Return how many threads of the machine run or are ready to run."""
    facts = dict(line.split(maxsplit=1) for line in _lines('/proc/stat'))
    return int(facts['procs_running'])


def _current() -> int:
    """Return the number of the processor that this thread runs on."""
    (stat,) = _lines('/proc/thread-self/stat')
    return int(stat.rpartition(')')[2].split()[_PROCESSOR])


def _lines(path: str) -> list[str]:
    return Path(path).read_text(encoding='utf-8').splitlines()

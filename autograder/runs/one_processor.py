"""
Keep a run on one processor.

Two threads of a run hardly ever compute at the same time, because the virtual clock wakes them one
by one.  So a second processor gains nothing, and even costs time: waking a thread on an idle
processor takes longer than switching to it, because that processor must wake up first.  Before the
clock advances, the program and the probe start in parallel and use all processors.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
import os
from pathlib import Path
import threading

from autograder.sandboxes.processes import ready_to_run

BUSY = 2
"""Number of ready threads per processor above which a run may use all processors."""
_PROCESSOR = 36  # index of the field "processor" in proc(5), after the command name
_lock = threading.Lock()
_runs: Counter[int] = Counter()  # runs of this process on each processor


@contextmanager
def one_processor() -> Iterator[set[int]]:
    """
    Choose the processor with the fewest runs, for :func:`keep_on`.

    On a busy machine, choose all processors: none is idle, and the kernel places threads better.
    """
    allowed = os.sched_getaffinity(0)
    if ready_to_run() > BUSY * len(allowed):
        yield allowed
        return
    here = _current()
    with _lock:
        # Prefer the current processor, which the kernel has chosen with regard to all programs.
        chosen = min(allowed, key=lambda one: (_runs[one], one != here))
        _runs[chosen] += 1
    try:
        yield {chosen}
    finally:
        with _lock:
            _runs[chosen] -= 1


def keep_on(processors: set[int], pids: Iterable[int]) -> None:
    """
    Restrict the current and future threads of the given processes to the given processors.

    A process that has ended, or that the grader may not change, is skipped.
    """
    for pid in pids:
        with suppress(OSError):
            for thread in os.listdir(f'/proc/{pid}/task'):
                os.sched_setaffinity(int(thread), processors)


def _current() -> int:
    """Return the number of the processor that this thread runs on."""
    stat = Path('/proc/thread-self/stat').read_text(encoding='utf-8')
    return int(stat.rpartition(')')[2].split()[_PROCESSOR])

"""Runs are spread over the processors, and each stays on one."""

from __future__ import annotations

import os
import subprocess
import sys
from threading import Barrier, Thread

import pytest

from autograder.runs import one_processor as module
from autograder.runs.one_processor import BUSY, one_processor

ALLOWED = 'import os; print(sorted(os.sched_getaffinity(0)))'


@pytest.fixture(autouse=True)
def calm(monkeypatch):
    """Let the machine seem to do nothing else."""
    monkeypatch.setattr(module, '_ready_to_run', lambda: 1)


def test_a_thread_and_its_children_stay_on_one_processor_until_the_run_ends():
    """Afterwards, the thread may use all processors again."""
    before = os.sched_getaffinity(0)
    with one_processor():
        (chosen,) = os.sched_getaffinity(0)
        child = subprocess.run(
            [sys.executable, '-c', ALLOWED], capture_output=True, text=True, check=True
        )
    assert chosen in before
    assert child.stdout == f'[{chosen}]\n'
    assert os.sched_getaffinity(0) == before


def test_runs_side_by_side_share_the_processors_evenly():
    """Twice as many runs as processors: two on each."""
    allowed = sorted(os.sched_getaffinity(0))
    together, chosen = Barrier(2 * len(allowed)), []

    def run() -> None:
        with one_processor():
            chosen.extend(os.sched_getaffinity(0))
            together.wait()

    threads = [Thread(target=run) for _ in range(2 * len(allowed))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(chosen) == sorted(2 * allowed)


def test_on_a_busy_machine_the_system_chooses_the_processor(monkeypatch):
    """No processor is idle then, so staying on one gains nothing."""
    allowed = os.sched_getaffinity(0)
    monkeypatch.setattr(module, '_ready_to_run', lambda: BUSY * len(allowed) + 1)
    with one_processor():
        assert os.sched_getaffinity(0) == allowed

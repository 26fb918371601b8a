"""Runs are spread over the processors, and each run stays on one processor."""

import os
import subprocess
import sys
from threading import Barrier, Thread

import pytest

from autograder.runs import one_processor as module
from autograder.runs.one_processor import BUSY, keep_on, one_processor

AFFINITY = 'import os; print(sorted(os.sched_getaffinity(0)))'


@pytest.fixture(autouse=True)
def calm(monkeypatch):
    """Make the machine seem idle."""
    monkeypatch.setattr(module, 'ready_to_run', lambda: 1)


def test_all_threads_of_a_process_and_its_children_stay_on_the_chosen_processor():
    begin = 'import sys, threading; other = threading.Thread(target=sys.stdin.read); other.start()'
    code = f'{begin}; print("begun", flush=True); other.join(); {AFFINITY}'
    argv = [sys.executable, '-c', code]
    ended = subprocess.Popen(['true'])
    ended.wait()
    with subprocess.Popen(argv, stdin=-1, stdout=-1, text=True) as child, one_processor() as one:
        child.stdout.readline()
        keep_on(one, [ended.pid, child.pid])
        tasks = map(int, os.listdir(f'/proc/{child.pid}/task'))
        assert [os.sched_getaffinity(task) for task in tasks] == [one, one]
        child.stdin.close()
        assert child.stdout.read() == f'{sorted(one)}\n'
    assert len(one) == 1


def test_runs_side_by_side_share_the_processors_evenly():
    allowed = sorted(os.sched_getaffinity(0))
    together, chosen = Barrier(2 * len(allowed)), []

    def run() -> None:
        with one_processor() as one:
            chosen.extend(one)
            together.wait()

    threads = [Thread(target=run) for _ in range(2 * len(allowed))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(chosen) == sorted(2 * allowed)


def test_on_a_busy_machine_the_system_chooses_the_processor(monkeypatch):
    """If no processor is idle, staying on one gains nothing."""
    allowed = os.sched_getaffinity(0)
    monkeypatch.setattr(module, 'ready_to_run', lambda: BUSY * len(allowed) + 1)
    with one_processor() as chosen:
        assert chosen == allowed

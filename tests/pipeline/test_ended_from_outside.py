"""A process that ends a program or its sandbox from outside is reported."""

from collections.abc import Callable
from contextlib import suppress
import os
from pathlib import Path
import threading
from typing import Any

import psutil
import pytest

from autograder.errors import ProbeFailed
from autograder.exam import catalog
from autograder.grading.examine import Engine
from autograder.recording import Event
from autograder.results import ExamResult
from autograder.runs import observe
from autograder.sandboxes import forked
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.forked import Probe, start_probe

pytestmark = [pytest.mark.pipeline, pytest.mark.ros]

EXAM = 'temperature_publisher'
ANSWER = Path(
    'tests/submissions/07_temperature_monitor/pass__annotated_and_configured/temp_publisher.py'
)
ENDS_ITSELF = """
import os, signal
import rclpy
rclpy.init()
node = rclpy.create_node('temperature_publisher')
node.create_timer(1.0, lambda: os.kill(os.getpid(), signal.SIGKILL))
rclpy.spin(node)
"""


def graded(text: str, on_event: Callable[[Event], None] | None = None) -> ExamResult:
    return Engine(strongest(), on_event=on_event).run(
        catalog.load(EXAM), {'temp_publisher.py': text}
    )


class Killer:
    """
    Ends a process at the first message of a run.

    :param wanted: whether to end a process
    """

    def __init__(self, wanted: Callable[[psutil.Process], bool]) -> None:
        self.wanted = wanted
        self.runs = 0

    def __call__(self, event: Event) -> None:
        if event['event'] == 'message' and not self.runs:
            for one in psutil.Process().children(recursive=True):
                with suppress(psutil.NoSuchProcess, FileNotFoundError):
                    if self.wanted(one):
                        one.kill()
                        self.runs += 1
                        break


def program(one: psutil.Process) -> bool:
    """Return whether a process is the student's program itself."""
    separate = os.readlink(f'/proc/{one.pid}/ns/pid') != os.readlink('/proc/self/ns/pid')
    return separate and _runs_nodes(one)


def _runs_nodes(one: psutil.Process) -> bool:
    return any('run_node.py' in word for word in one.cmdline())


def server(one: psutil.Process) -> bool:
    """Return whether a process is the fork server of the student's program."""
    # Earlier tests may have left further servers, which are idle.
    forked_it = any(map(program, one.children(recursive=True)))
    return forked_it and _runs_nodes(one) and not _runs_nodes(one.parent())


def parent(one: psutil.Process) -> bool:
    """Return whether a process is the parent of a student's program, a child of the server."""
    return _runs_nodes(one) and _runs_nodes(one.parent()) and not program(one)


def launcher(one: psutil.Process) -> bool:
    """Return whether a process is the bubblewrap that started the student's sandbox."""
    return one.name() == 'bwrap' and forked.LAUNCHER[-1] in one.cmdline()


@pytest.mark.parametrize(
    ('wanted', 'said'),
    [
        (launcher, 'ended the sandbox with signal 9'),
        (server, 'ended the process that reports'),
        (parent, 'ended the process that reports'),
    ],
)
def test_a_process_of_the_grader_that_is_killed_makes_no_verdict(wanted, said):
    """Without evidence, the student does not get a zero: an instructor decides."""
    killer = Killer(wanted)
    with pytest.raises(ProbeFailed, match=said):
        graded(ANSWER.read_text(encoding='utf-8'), killer)

    assert killer.runs == 1


@pytest.mark.parametrize('ends_itself', [True, False])
def test_a_program_that_is_ended_by_a_signal_is_judged_and_flagged(ends_itself):
    """The kernel does not tell whether the signal came from the program itself."""
    killer = Killer(program)
    text = ENDS_ITSELF if ends_itself else ANSWER.read_text(encoding='utf-8')
    result = graded(text, None if ends_itself else killer)

    assert killer.runs == (0 if ends_itself else 1)
    assert {check.cause_id for check in result.checks if check.cause_id} == {'died'}
    assert any(flag.startswith('ended with exit code') for flag in result.flags)


def test_a_machine_without_memory_makes_no_verdict(monkeypatch):
    """The kernel counts the processes that it ends, but not which process used the memory."""
    counted = iter(range(100))
    monkeypatch.setattr(observe, 'oom_kills', lambda: next(counted))
    with pytest.raises(ProbeFailed, match='ran out of memory'):
        graded(ENDS_ITSELF)


def test_a_probe_that_is_held_up_for_a_second_changes_nothing(monkeypatch):
    """Virtual time stops meanwhile, which is not a fault of the program."""
    started, stopped = [], []

    def start(*given: Any) -> Probe:
        started.append(start_probe(*given))
        return started[-1]

    monkeypatch.setattr(observe, 'start_probe', start)

    def stall(event: Event) -> None:
        if event['event'] == 'seen':
            probe = psutil.Process(started[-1].pid)
            family = [probe, *probe.children(recursive=True)]
            stopped.extend(family)
            for one in family:
                one.suspend()
            threading.Timer(1.0, lambda: [one.resume() for one in family]).start()

    result = graded(ANSWER.read_text(encoding='utf-8'), stall)

    assert stopped
    assert result.points == result.max_points

"""A program that another process ends costs its student no points."""

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
from autograder.grading.examine import examine
from autograder.recording import Event
from autograder.results import ExamResult
from autograder.runs import observe
from autograder.sandboxes import forked
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.probes import Probe, start_probe

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
    return examine(
        catalog.load(EXAM), {'temp_publisher.py': text}, sandbox=strongest(), on_event=on_event
    )


class Killer:
    """
    Ends processes at the first message.

    :param wanted: whether to end a process
    :param times: number of runs in which to end it
    """

    def __init__(self, wanted: Callable[[psutil.Process], bool], times: int = 1) -> None:
        self.wanted = wanted
        self.left = times
        self.runs = 0
        self.armed = True

    def __call__(self, event: Event) -> None:
        if event['event'] == 'seen':  # the first message of a run
            self.armed = True
        if event['event'] == 'message' and self.armed and self.left:
            self.armed = False
            self.left -= 1
            for one in psutil.Process().children(recursive=True):
                with suppress(psutil.NoSuchProcess, FileNotFoundError):
                    if self.wanted(one):
                        one.kill()
                        self.runs += 1
                        break


def program(one: psutil.Process) -> bool:
    """Return whether a process is the student's program itself."""
    separate = os.readlink(f'/proc/{one.pid}/ns/pid') != os.readlink('/proc/self/ns/pid')
    return separate and any('run_node.py' in word for word in one.cmdline())


def launcher(one: psutil.Process) -> bool:
    """Return whether a process is the bubblewrap that started the student's sandbox."""
    return one.name() == 'bwrap' and forked.LAUNCHER[-1] in one.cmdline()


@pytest.mark.parametrize('wanted', [program, launcher])
def test_a_program_that_is_killed_from_outside_gets_its_points(wanted):
    killer = Killer(wanted)
    result = graded(ANSWER.read_text(encoding='utf-8'), killer)

    assert killer.runs == 1
    assert (result.points, result.timing.get('repeated')) == (result.max_points, 1.0)


def test_a_launcher_that_is_killed_each_time_makes_no_verdict():
    """Without evidence, the student does not get a zero: an instructor decides."""
    killer = Killer(launcher, times=2)
    with pytest.raises(ProbeFailed, match='Another program ended the sandbox with signal 9'):
        graded(ANSWER.read_text(encoding='utf-8'), killer)

    assert killer.runs == 2


def test_a_program_that_ends_itself_so_is_judged():
    result = graded(ENDS_ITSELF)

    assert result.timing['repeated'] == 1.0
    assert {check.cause_id for check in result.checks if check.cause_id} == {'died'}


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
    assert 'repeated' not in result.timing
    assert result.points == result.max_points

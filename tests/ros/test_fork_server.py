"""Probes are forks of one server, which is replaced after a failure and drops privileges."""

from concurrent.futures import ThreadPoolExecutor
import os
from pathlib import Path
import signal
import socket

import pytest

from autograder.errors import ProbeFailed
from autograder.exam import catalog
from autograder.grading.examine import examine
from autograder.results import ExamResult
from autograder.sandboxes import probes
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.confined import Limits, Program
from autograder.sandboxes.probes import ForkServer

pytestmark = [pytest.mark.ros]

ANSWER = Path('tests/submissions/03_topics/pass__functions_style/talker.py')


def graded() -> ExamResult:
    """Examine a correct talker."""
    return examine(
        catalog.load('talker'), {'talker.py': ANSWER.read_text('utf-8')}, sandbox=strongest()
    )


def server() -> ForkServer:
    """Return the fork server that was used last."""
    return probes._idle[-1]


def test_two_runs_share_one_fork_server():
    """Loading rclpy takes longer than the work of a probe."""
    results = [graded()]
    first = server()
    results.append(graded())

    assert server() is first
    assert all(result.points == result.max_points for result in results)


def test_a_run_in_another_thread_uses_the_same_fork_server():
    """Each assignment of a class uses different threads."""
    graded()
    first = server()
    with ThreadPoolExecutor(1) as thread:
        result = thread.submit(graded).result()

    assert server() is first
    assert result.points == result.max_points


def test_a_fork_server_that_has_ended_is_replaced():
    """Killing the fork server does not affect the next run."""
    graded()
    first = server()
    os.killpg(first.process.pid, signal.SIGKILL)
    first.process.wait()
    result = graded()

    assert server() is not first
    assert result.points == result.max_points


def test_a_fork_server_that_ends_during_a_run_makes_no_verdict(tmp_path):
    """Without evidence there is no verdict, and the ended server is not used again."""
    sandbox = strongest()
    found = ForkServer(sandbox)
    os.killpg(found.process.pid, signal.SIGKILL)
    found.process.wait()
    student = sandbox.start(Program(('sleep', 'infinity')), Limits(), tmp_path)
    try:
        with pytest.raises(ProbeFailed, match='The fork server of the probes'):
            found.make(student, 0)
    finally:
        student.kill()

    assert not found.usable(sandbox)


def test_a_probe_has_given_up_its_rights(tmp_path):
    """A program that takes over the probe gains no privileges."""
    sandbox = strongest()
    student = sandbox.start(Program(('sleep', 'infinity')), Limits(), tmp_path)
    ours, theirs = socket.socketpair()
    try:
        probe = ForkServer(sandbox).make(student, theirs.fileno())
        lines = Path(f'/proc/{probe.pid}/status').read_text('ascii').splitlines()
        network = os.readlink(f'/proc/{probe.pid}/ns/net')
        expected = os.readlink(f'/proc/{student.pid}/ns/net')
        probe.end()
    finally:
        student.kill()
        ours.close()
        theirs.close()
    status = dict(line.split(':\t', 1) for line in lines)

    assert network == expected
    assert status['NoNewPrivs'] == '1'
    assert status['Seccomp'] == '2'
    if sandbox.facts.root:
        assert {int(uid) for uid in status['Uid'].split()}.isdisjoint({0})
        assert int(status['CapEff'], 16) == int(status['CapPrm'], 16) == 0

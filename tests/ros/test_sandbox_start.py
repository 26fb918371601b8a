"""A sandbox is complete when it has started, and a program that never starts is not to blame."""

import os
from pathlib import Path
import subprocess
import sys

import pytest

from autograder.errors import GraderError, ProbeFailed, SandboxUnavailable
from autograder.exam import catalog
from autograder.grading.examine import Engine
from autograder.runs import observe
from autograder.sandboxes import forked
from autograder.sandboxes import sandbox as sandboxes
from autograder.sandboxes.choose import strongest, try_out
from autograder.sandboxes.confinement import ConfinedProgram, Limits, Program

pytestmark = [pytest.mark.ros]

FAILS = ('sh', '-c', 'echo no loopback >&2; exit 3', 'sh')


def test_files_and_network_are_complete_when_a_sandbox_has_started(tmp_path):
    """Fast DDS lists the interfaces once: a probe that looks too early would see no node."""
    for _ in range(5):
        confined = strongest().start(Program(('sleep', 'infinity')), Limits(), tmp_path)
        try:
            addresses = Path(f'/proc/{confined.pid}/net/fib_trie').read_text('ascii')
            assert '127.0.0.1' in addresses
            assert Path(f'/proc/{confined.pid}/root/tmp/home').is_dir()
        finally:
            confined.kill()


def test_a_sandbox_that_is_never_complete_is_our_fault(monkeypatch):
    """The grader stops waiting and reports its own failure; the learner does not get 0 points."""
    monkeypatch.setattr(sandboxes, 'READY', FAILS)

    with pytest.raises(SandboxUnavailable, match='bubblewrap refused: no loopback'):
        Engine(strongest()).run(catalog.load('talker'), {'talker.py': ''})


def test_a_sandbox_that_ends_before_the_program_begins_is_our_fault(monkeypatch):
    """There is no namespace that a fork could enter."""
    monkeypatch.setattr(forked, 'LAUNCHER', FAILS)

    with pytest.raises(GraderError, match=r'not be confined|before the program began|refused'):
        Engine(strongest()).run(catalog.load('talker'), {'talker.py': ''})


def test_a_program_that_was_never_let_begin_is_not_one_without_a_node(monkeypatch):
    """A delay before the start of the program says nothing about the student's code."""
    monkeypatch.setattr(ConfinedProgram, 'release', lambda self: None)

    scenario = catalog.load('talker').scenario.to_json()
    with pytest.raises(ProbeFailed, match='had not begun when the run ended: no_node'):
        observe.observe('talker', scenario, {'talker.py': ''}, strongest())


def test_a_trial_of_the_sandbox_that_somebody_ended_says_nothing_about_rclpy(monkeypatch):
    """The advice is to repeat the command, not to look for missing packages."""
    sandbox = strongest()
    # The launcher reads the exit code of the trial's program.
    monkeypatch.setattr(forked, 'LAUNCHER', ('sh', '-c', 'read code; kill -9 $$'))

    with pytest.raises(SandboxUnavailable, match='Another program ended the trial') as caught:
        try_out(sandbox)

    assert caught.value.fix == 'Try: run the same command again'


ENTERS = """
from autograder.errors import SandboxUnavailable
from autograder.sandboxes.choose import strongest
try:
    print(strongest().mode)
except SandboxUnavailable as refused:
    print(refused)
"""


@pytest.mark.skipif(os.geteuid() != 0, reason='a plain user has all rights in its user namespace')
def test_a_system_that_lets_no_program_enter_a_sandbox_is_refused_with_advice():
    """Only programs enter a mount namespace, with a right that bubblewrap does not need."""
    without = ('setpriv', '--bounding-set=-sys_chroot', sys.executable, '-c', ENTERS)
    said = subprocess.run(without, capture_output=True, text=True, check=True).stdout

    assert 'setns: Operation not permitted' in said
    assert 'start it as a plain user' in said
    assert '--allow-weak=landlock-uid' in said


def test_a_namespace_that_a_fork_cannot_enter_is_refused_with_advice(monkeypatch):
    """The kernel refuses to enter the user namespace that a process is in."""
    sandbox, own = strongest(), os.open('/proc/self/ns/user', os.O_RDONLY)
    monkeypatch.setattr(forked, '_open_namespaces', lambda confined: [own])
    try:
        with pytest.raises(SandboxUnavailable, match='setns: Invalid argument') as caught:
            try_out(sandbox)
    finally:
        os.close(own)

    assert caught.value.fix == 'Try: make doctor'

"""The probe waits for its network, and a program that never starts is not the student's fault."""

import os
from pathlib import Path
import select
import subprocess
import sys
import time
from typing import Any

import pytest

from autograder.errors import ProbeFailed, SandboxUnavailable
from autograder.exam import catalog
from autograder.grading.examine import examine
from autograder.runs import observe
from autograder.runs.observe import HERE
from autograder.sandboxes import forked
from autograder.sandboxes.choose import strongest, try_out
from autograder.sandboxes.confined import Confined
from autograder.sandboxes.probes import Probe, start_probe
from autograder.sandboxes.sandbox import Sandbox

pytestmark = [pytest.mark.ros]

ANSWER = Path('tests/submissions/03_topics/pass__functions_style/talker.py')


# In a separate network whose loopback interface is off at first, as in a new sandbox.
LATE = f"""
import fcntl, socket, sys, threading
sys.path.insert(0, {str(HERE / 'probe')!r})
import probe_loopback
from probe_loopback import IFF_UP, IFREQ, INTERFACE

SIOCSIFFLAGS = 0x8914
asked, works = threading.Event(), probe_loopback.works

def works_and_tells():
    found = works()
    asked.set()
    return found

probe_loopback.works = works_and_tells
print(works())
waiting = threading.Thread(target=probe_loopback.wait)
waiting.start()
asked.wait()
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
    fcntl.ioctl(any_socket, SIOCSIFFLAGS, IFREQ.pack(INTERFACE, IFF_UP))
waiting.join()
print(works())
"""


def test_it_waits_until_the_sandbox_has_switched_its_network_on():
    """A participant created earlier would receive nothing during the whole run."""
    own_network = ['unshare', '--net', *(() if os.geteuid() == 0 else ('--map-root-user',))]
    ran = subprocess.run(
        [*own_network, sys.executable, '-c', LATE],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )

    assert ran.stdout.split() == ['False', 'True']


SWITCH = f"""
import fcntl, socket, sys
sys.path.insert(0, {str(HERE / 'probe')!r})
from probe_loopback import IFF_UP, IFREQ, INTERFACE, wait

on = sys.argv[1] == 'on'
if not on:
    wait()  # bubblewrap switches it on once
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
    fcntl.ioctl(any_socket, 0x8914, IFREQ.pack(INTERFACE, IFF_UP if on else 0))
"""


def switch(student: Confined, to: str) -> None:
    """Switch the network of a sandbox on or off."""
    files = {
        name: student.namespaces[name] for name in ('user', 'net') if name in student.namespaces
    }
    into = [f'--{name}=/proc/self/fd/{file}' for name, file in files.items()]
    into += ['--preserve-credentials'] if 'user' in files else []
    argv = ['nsenter', *into, sys.executable, '-c', SWITCH, to]
    subprocess.run(argv, check=True, timeout=60, pass_fds=files.values())


def listening(student: Confined) -> list[int]:
    """Return the netlink ports in a sandbox's network that listen for events."""
    sockets = Path(f'/proc/{student.pid}/net/netlink').read_text('ascii').splitlines()[1:]
    fields = [one.split() for one in sockets]
    return [int(port) for _, _, port, groups, *_ in fields if int(groups, 16)]


MOST_PROCESSES = 1 << 22  # PID_MAX_LIMIT: proc(5)


def test_a_node_is_seen_however_late_its_network_is(monkeypatch):
    """A learner loses no points if the sandbox is ready later than the probe."""

    def start_first(sandbox: Sandbox, student: Confined, *others: Any) -> Probe:
        switch(student, 'off')
        probe = start_probe(sandbox, student, *others)
        deadline = time.monotonic() + 60
        while not (ports := listening(student)):
            assert time.monotonic() < deadline, 'the probe does not wait for its network'
            select.select((), (), (), 0.01)
        # Bubblewrap needs the netlink port whose number is its own process id.
        assert min(ports) > MOST_PROCESSES
        switch(student, 'on')
        return probe

    monkeypatch.setattr(observe, 'start_probe', start_first)
    exam = catalog.load('talker')

    result = examine(exam, {'talker.py': ANSWER.read_text('utf-8')}, sandbox=strongest())

    assert result.points == exam.max_points


def test_a_sandbox_that_ends_before_the_program_begins_is_our_fault(monkeypatch):
    """The grader stops waiting and reports its own failure; the learner does not get 0 points."""
    monkeypatch.setattr(forked, 'LAUNCHER', ('sh', '-c', 'echo no loopback >&2; exit 3'))

    with pytest.raises(
        ProbeFailed, match='ended with code 3 before the program began: no loopback'
    ):
        examine(catalog.load('talker'), {'talker.py': ''}, sandbox=strongest())


def test_a_program_that_was_never_let_begin_is_not_one_without_a_node(monkeypatch):
    """A delay before the start of the program says nothing about the student's code."""
    monkeypatch.setattr(Confined, 'release', lambda self: None)

    scenario = catalog.load('talker').scenario.to_json()
    with pytest.raises(ProbeFailed, match='had not begun when the run ended: no_node'):
        observe.observe('talker', scenario, {'talker.py': ''}, strongest())


def test_a_trial_of_the_sandbox_that_somebody_ended_says_nothing_about_rclpy(monkeypatch):
    """The advice is to repeat the command, not to look for missing packages."""
    sandbox = strongest()
    monkeypatch.setattr(Sandbox, 'command', lambda *_: ['sh', '-c', 'kill -9 $$'])

    with pytest.raises(SandboxUnavailable, match='Another program ended the trial') as caught:
        try_out(sandbox)

    assert caught.value.fix == 'Try: run the same command again'

"""Probes and programs are unprivileged forks of servers, which are replaced after a failure."""

from concurrent.futures import ThreadPoolExecutor
import json
import os
from pathlib import Path
import signal
import socket

import pytest

from autograder.clock.virtual_clock import virtual_clock
from autograder.errors import ProbeFailed
from autograder.exam import catalog
from autograder.grading.examine import Engine
from autograder.results import ExamResult
from autograder.sandboxes import fork_server
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.confinement import ConfinedProgram, Limits, Program
from autograder.sandboxes.fork_server import ForkServer
from autograder.sandboxes.forked import (
    INSIDE,
    loaded_probe,
    start_probe,
    start_program,
    STUDENT,
)
from autograder.sandboxes.sandbox import Sandbox

pytestmark = [pytest.mark.ros]

ANSWER = Path('tests/submissions/03_topics/pass__functions_style/talker.py')


def graded() -> ExamResult:
    """Examine a correct talker."""
    return Engine(strongest()).run(
        catalog.load('talker'), {'talker.py': ANSWER.read_text('utf-8')}
    )


def servers() -> set[ForkServer]:
    """Return the last two fork servers: those of the program and of the probe."""
    return set(fork_server._idle[-2:])


def test_two_runs_share_their_fork_servers():
    """Loading rclpy takes longer than most runs."""
    results = [graded()]
    first = servers()
    results.append(graded())

    assert servers() == first
    assert {server.loaded.boxed for server in first} == {strongest().facts.root, False}
    assert all(result.points == result.max_points for result in results)


def test_a_run_in_another_thread_uses_the_same_fork_servers():
    """Each assignment of a class uses different threads."""
    graded()
    first = servers()
    with ThreadPoolExecutor(1) as thread:
        result = thread.submit(graded).result()

    assert servers() == first
    assert result.points == result.max_points


def test_a_fork_server_that_has_ended_is_replaced():
    """Killing the fork servers does not affect the next run."""
    graded()
    first = servers()
    for server in first:
        os.killpg(server.process.pid, signal.SIGKILL)
        server.process.wait()
    result = graded()

    assert not servers() & first
    assert result.points == result.max_points


def test_a_fork_server_that_ends_during_a_run_makes_no_verdict(tmp_path, monkeypatch):
    """Without evidence there is no verdict, and the ended server is not used again."""
    sandbox = strongest()
    found = ForkServer(sandbox, loaded_probe(sandbox))
    os.killpg(found.process.pid, signal.SIGKILL)
    found.process.wait()
    assert found.channel.recv(1) == b''  # the server itself ends shortly after its launcher
    monkeypatch.setattr('autograder.sandboxes.forked.free_servers', lambda *_: [found])
    student = sandbox.start(Program(('sleep', 'infinity')), Limits(), tmp_path)
    try:
        with pytest.raises(ProbeFailed, match='The fork server'):
            start_probe(sandbox, student, 0)
    finally:
        student.kill()

    assert not found.usable(sandbox)


def test_a_probe_has_given_up_its_rights(tmp_path):
    """A program that takes over the probe gains no privileges."""
    sandbox = strongest()
    student = sandbox.start(Program(('sleep', 'infinity')), Limits(), tmp_path)
    ours, theirs = socket.socketpair()
    try:
        probe = start_probe(sandbox, student, theirs.fileno())
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
    assert int(status['CapEff'], 16) == int(status['CapPrm'], 16) == 0
    if sandbox.facts.root:
        assert {int(uid) for uid in status['Uid'].split()}.isdisjoint({0})


FACTS = """
import ctypes, json, os, re, resource, signal, socket, sys
status = dict(line.split(':\\t', 1) for line in open('/proc/self/status'))
limits = {
    name: resource.getrlimit(getattr(resource, name))
    for name in dir(resource) if name.startswith('RLIMIT_')
}
libc = ctypes.CDLL(None, use_errno=True)
CLONE_NEWUSER, PTRACE_ATTACH = 0x10000000, 16
print(json.dumps({
    'status': {
        name: status[name].split()
        for name in ('CapInh', 'CapPrm', 'CapEff', 'CapBnd', 'CapAmb', 'NoNewPrivs', 'Seccomp',
                     'Groups', 'SigBlk', 'SigIgn')
    },
    'uids': len({*os.getresuid(), *os.getresgid()}),
    'root': 0 in (*os.getresuid(), *os.getresgid()),
    'limits': limits,
    'mounts': [line.split()[3:] for line in open('/proc/self/mountinfo')],
    'root folder': sorted(os.listdir('/')),
    'processes': sum(name.isdigit() for name in os.listdir('/proc')),
    'variables': {name: text for name, text in os.environ.items() if name != 'VIRTUAL_CLOCK'},
    'folder': os.getcwd(),
    'host': socket.gethostname(),
    'open': sum(int(name) < 100 for name in os.listdir('/proc/self/fd')),
    'arguments': sys.argv,
    'path': sys.path,
    'main': sorted(sys.modules['__main__'].__dict__),
    'grader': sorted(name for name in ('forks', 'confine', 'gate') if name in sys.modules),
    'namespaces': {
        name: os.readlink(f'/proc/self/ns/{name}') for name in os.listdir('/proc/self/ns')
    },
    'unshare': libc.unshare(CLONE_NEWUSER),
    'trace': libc.ptrace(PTRACE_ATTACH, 1, 0, 0),
    'signal': libc.kill(1, 0),
}), flush=True)
"""


def facts_of(sandbox: Sandbox, folder: Path, forked: bool) -> dict:
    """Run FACTS as a fork, or as a program that bubblewrap starts."""
    submission = folder / 'submission'
    submission.mkdir(exist_ok=True)
    (submission / 'facts.py').write_text(FACTS, 'utf-8')
    argv = (sandbox.ros.python, '/grader/inside/run_node.py', '/submission/facts.py', 'word')
    program = Program(argv, {**INSIDE, str(submission): '/submission'})
    with virtual_clock(2) as clock:
        if forked:
            student = start_program(sandbox, program, Limits(), folder, clock)
        else:
            placed = Program((*clock.command(STUDENT), *argv), program.binds)
            place = clock.places[STUDENT].fileno()
            student = sandbox.start(placed, Limits(), folder, (place,))
        clock.begin()
        return _facts(student)


def _facts(student: ConfinedProgram) -> dict:
    try:
        student.release()
        said, error = student.process.communicate(timeout=60)
    finally:
        student.kill()
    assert student.process.returncode == 0, error.decode()
    return json.loads(said)


def test_a_fork_is_confined_like_a_program_that_bubblewrap_starts(tmp_path):
    """Rights, limits, files, variables, processes and descriptors are the same."""
    tmp_path.chmod(0o755)
    sandbox = strongest()
    started = facts_of(sandbox, tmp_path, forked=False)
    forked = facts_of(sandbox, tmp_path, forked=True)
    of_grader = {
        name: os.readlink(f'/proc/self/ns/{name}') for name in os.listdir('/proc/self/ns')
    }
    spaces = [facts.pop('namespaces') for facts in (started, forked)]
    most = [facts['limits'].pop('RLIMIT_NPROC')[0] for facts in (started, forked)]
    processes = [facts.pop('processes') for facts in (started, forked)]

    assert forked == started
    assert processes[1] - processes[0] == 1  # the launcher
    assert forked['status']['CapEff'] == forked['status']['CapBnd'] == ['0' * 16]
    assert most[1] > most[0]  # plus the parent outside, or a plain user's threads
    for found in spaces:
        same = {name for name in found if found[name] == of_grader[name]}
        assert same <= {'user', 'time', 'time_for_children'}
        assert sandbox.facts.root or 'user' not in same

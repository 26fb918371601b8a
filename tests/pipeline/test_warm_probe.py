"""
A probe that is a fork of a warm process is as alone, and as short-lived, as one of its own.

What it may do is asked of the kernel, while it waits for its scenario.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
import errno
import os
from pathlib import Path
import select
import signal
import subprocess
import sys
import threading
from typing import Any

import psutil
import pytest

from autograder import exams
from autograder.errors import ProbeFailed, SandboxUnavailable
from autograder.runs.examine import examine
from autograder.runs.recording import Event
from autograder.sandboxes import confined, isolation, probes, warm_probes
from autograder.sandboxes import sandbox as sandboxes
from autograder.sandboxes.confined import Confined, Limits, Probe, Program
from autograder.sandboxes.isolation import System
from autograder.sandboxes.processes import ports
from autograder.sandboxes.sandbox import Sandbox, strongest
from autograder.sandboxes.warm_probes import CAPABILITIES, WarmProbes
from autograder.whole_class import pipeline

pytestmark = [
    pytest.mark.pipeline,
    pytest.mark.skipif(os.geteuid() != 0, reason='a plain user has no right to join a network'),
]

ANSWER = Path('tests/submissions/03_topics/pass__functions_style/talker.py')
LIMITS = {
    'nproc': 'Max processes',
    'as': 'Max address space',
    'fsize': 'Max file size',
    'core': 'Max core file size',
    'nofile': 'Max open files',
    'cpu': 'Max cpu time',
}
NAMESPACES = ('mnt', 'pid', 'ipc', 'net')
IN_A_PROCESS = """
import os, sys
from pathlib import Path
from autograder.sandboxes.confined import Limits, Program
from autograder.sandboxes.probes import start_probe
from autograder.sandboxes.sandbox import strongest
from autograder.sandboxes.warm_probes import _of_thread

sandbox, home = strongest(), Path(sys.argv[1])
program = Program((sandbox.ros.python, '-c', 'import sys; sys.stdin.read()'))
student = sandbox.start(program, Limits(), home)
probe = start_probe(sandbox, student, home)
print(_of_thread.probes.process.pid, probe.pid, student.pid, flush=True)
sys.stdin.read()
"""


@pytest.fixture
def student(tmp_path: Path) -> Iterator[Confined]:
    """Hold a program in a sandbox."""
    sandbox = strongest()
    program = Program((sandbox.ros.python, '-c', 'import sys; sys.stdin.read()'))
    held = sandbox.start(program, Limits(), tmp_path)
    yield held
    held.kill()


@contextmanager
def probe_of(student: Confined) -> Iterator[Probe]:
    """Start a probe beside a held program."""
    probe = probes.start_probe(strongest(), student, Path('/nowhere'))
    try:
        yield probe
    finally:
        probe.end()


def warm() -> WarmProbes:
    """Return what makes this thread's probes."""
    return warm_probes._of_thread.probes


def forget() -> None:
    """Have the next probe of this thread made by another process."""
    warm_probes._of_thread.__dict__.clear()


def maker() -> int:
    """Return the host pid of the process that is forked, the innermost of its sandbox."""
    (inner,) = psutil.Process(warm().process.pid).children()
    (python,) = inner.children()
    return python.pid


def status(pid: int) -> dict[str, str]:
    """Return what the kernel tells of a process."""
    lines = Path(f'/proc/{pid}/status').read_text('ascii').splitlines()
    return {name: value.strip() for name, _, value in (line.partition(':') for line in lines)}


def namespaces(pid: int) -> dict[str, str]:
    """Return the namespaces of a process."""
    return {name: os.readlink(f'/proc/{pid}/ns/{name}') for name in NAMESPACES}


def is_closed(folder: Path) -> bool:
    """Tell whether even root can write nothing into a folder of a sandbox."""
    try:
        (folder / 'left').write_text('for the next')
    except OSError as error:
        return error.errno == errno.EROFS
    return False


class TestConfinement:
    """What a probe has given up before it reads its scenario."""

    def test_it_may_do_nothing_and_is_nobody(self, student):
        """No capability, none to be had from a program, calls filtered, no uid of this machine."""
        with probe_of(student) as probe:
            found = status(probe.pid)

        sets = {name: int(found[name], 16) for name in found if name.startswith('Cap')}
        assert sets == dict.fromkeys(('CapInh', 'CapPrm', 'CapEff', 'CapBnd', 'CapAmb'), 0)
        assert found['NoNewPrivs'] == '1'
        assert found['Seccomp'] == '2'  # a filter
        assert found['Groups'] == ''
        for name in ('Uid', 'Gid'):
            (number,) = {int(word) for word in found[name].split()}
            assert number >= sandboxes.FIRST_UID

    def test_its_maker_may_do_what_a_fork_needs_and_no_more(self, student):
        """It has no network and no node either."""
        with probe_of(student):
            pid = maker()
            found = status(pid)
            in_use = ports(pid)

        numbers = {'CAP_SETGID': 6, 'CAP_SETUID': 7, 'CAP_SETPCAP': 8, 'CAP_SYS_ADMIN': 21}
        assert int(found['CapEff'], 16) == sum(1 << numbers[name] for name in CAPABILITIES)
        assert in_use == set()

    def test_it_shares_the_network_with_the_program_and_nothing_else_with_anybody(self, student):
        """Neither with the program, nor with its maker, nor with us."""
        with probe_of(student) as probe:
            own, makers = namespaces(probe.pid), namespaces(maker())
            programs, ours = namespaces(student.pid), namespaces(os.getpid())

        assert own['net'] == programs['net']
        for name in ('mnt', 'pid', 'ipc'):
            assert own[name] not in {makers[name], programs[name], ours[name]}
        assert makers['net'] not in {own['net'], ours['net']}

    def test_it_holds_three_pipes_and_the_limits_of_a_probe(self, student):
        """The way to its maker is closed, and the network's descriptor too."""
        with probe_of(student) as probe:
            while len(files := sorted(os.listdir(f'/proc/{probe.pid}/fd'))) > 3:
                select.select((), (), (), 0.001)  # it says that it is there just before
            text = Path(f'/proc/{probe.pid}/limits').read_text('ascii')

        assert files == ['0', '1', '2']
        rows = {line[:26].strip(): line[26:].split()[:2] for line in text.splitlines()}
        wanted = probes.LIMITS.of_process()
        for name, row in LIMITS.items():
            assert rows[row] == [str(wanted.pop(name))] * 2
        assert wanted == {}

    def test_nothing_is_left_for_the_next_probe(self, student):
        """Two of one maker have other folders, another uid, and the same pid: the first."""
        seen = []
        for _ in range(2):
            with probe_of(student) as probe:
                made_by = maker()
                root = Path(f'/proc/{probe.pid}/root')
                left = os.listdir(root / 'tmp' / 'home')
                (root / 'tmp' / 'home' / 'left').write_text('for the next')
                closed = [is_closed(root / folder) for folder in ('tmp', 'dev/shm', '')]
                found = status(probe.pid)
                seen.append((found['Uid'], made_by))
            assert left == []
            assert closed == [True] * 3
            assert found['NSpid'].split()[-1] == '1'

        (first, maker_of_first), (second, maker_of_second) = seen
        assert maker_of_first == maker_of_second
        assert first != second

    def test_it_sees_what_lies_below_the_folder_of_temporary_files(self, student, monkeypatch):
        """The course and its Python may be there: a clone is often made where it is soon gone."""
        below = '/tmp/of the course/test.py'
        files = {__file__: below}
        made = Sandbox.bwrap

        def with_more(sandbox: Sandbox, program: Program, *given: Any) -> list[str]:
            return made(sandbox, replace(program, binds={**program.binds, **files}), *given)

        monkeypatch.setattr(Sandbox, 'bwrap', with_more)
        forget()

        with probe_of(student) as probe:
            seen = Path(f'/proc/{probe.pid}/root{below}').read_text('utf-8')

        assert seen == Path(__file__).read_text('utf-8')


class TestEnds:
    """However one of them ends, nobody waits for it and no verdict comes of it."""

    @pytest.mark.parametrize('whom', ['launcher', 'maker'])
    def test_a_maker_that_was_ended_between_two_runs_is_replaced(self, student, whom):
        """Whoever ended it."""
        with probe_of(student):
            before = warm()
            pid = before.process.pid if whom == 'launcher' else maker()
        os.kill(pid, signal.SIGKILL)
        before.process.wait(60)

        with probe_of(student) as probe:
            assert warm() is not before
            assert status(probe.pid)['NSpid'].split()[-1] == '1'

    def test_a_probe_that_ends_by_itself_says_so(self, student):
        """The end of its input is the grader's, and no fault."""
        with probe_of(student) as probe:
            probe.stdin.close()
            assert probe.stdout.read() == b''
            before = warm()
        with probe_of(student):
            assert warm() is before

        assert probe.code in (0, -signal.SIGKILL)

    def test_two_probes_of_one_thread_have_two_makers(self, student):
        """One makes one at a time."""
        with probe_of(student) as first, probe_of(student) as second:
            assert psutil.Process(first.pid).ppid() != psutil.Process(second.pid).ppid()

    def test_it_ends_with_the_thread_that_has_it(self, student):
        """So does its sandbox."""
        found = []

        def run() -> None:
            with probe_of(student) as probe:
                found.extend((warm().process, probe.pid))

        thread = threading.Thread(target=run)
        thread.start()
        thread.join()
        process, pid = found

        assert process.wait(60) != 0
        assert not psutil.pid_exists(pid)

    def test_ctrl_c_ends_it_before_the_program(self, student, monkeypatch, tmp_path):
        """Else it could record that the program has ended, which was not the student's doing."""
        with probe_of(student):
            pass  # what makes probes is older now than the next program, as it usually is
        sandbox = strongest()
        program = Program((sandbox.ros.python, '-c', 'import sys; sys.stdin.read()'))
        later = sandbox.start(program, Limits(), tmp_path)
        ended: list[int] = []
        try:
            with probe_of(later) as probe, monkeypatch.context() as changed:
                changed.setattr(psutil.Process, 'kill', lambda one: ended.append(one.pid))
                pipeline._end_sandboxes()
        finally:
            later.kill()

        assert ended.index(probe.pid) < min(ended.index(one.pid) for one in (student, later))

    @pytest.mark.parametrize('how', [signal.SIGKILL, signal.SIGTERM, None])
    def test_nothing_outlives_the_process_that_grades(self, tmp_path, how):
        """Whether it was killed or came to its end."""
        with subprocess.Popen(
            [sys.executable, '-c', IN_A_PROCESS, str(tmp_path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        ) as grader:
            held = [os.pidfd_open(int(word)) for word in grader.stdout.readline().split()]
            if how is None:
                grader.stdin.close()
            else:
                grader.send_signal(how)
        try:
            for pidfd in held:
                assert select.select([pidfd], [], [], 60)[0], 'it lives on'
        finally:
            for pidfd in held:
                os.close(pidfd)

    @pytest.mark.ros
    @pytest.mark.parametrize('whom', ['probe', 'maker'])
    def test_one_that_is_ended_in_a_run_is_no_evidence(self, whom):
        """The run is done again; and if that is no better, there is no verdict, and no zero."""
        exam, files = exams.load('talker'), {'talker.py': ANSWER.read_text('utf-8')}
        left = 1
        last = {'run': 0}

        def told(event: Event) -> None:
            nonlocal left
            if event['event'] == 'seen':  # it waits for us next
                last['run'] += 1
                if left:
                    left -= 1
                    python = psutil.Process(maker())
                    ended = python.children()[0] if whom == 'probe' else python
                    ended.kill()
                    ended.wait(60)  # what it does to others is done then, too

        again = examine(exam, files, sandbox=strongest(), told=told)
        left = 2
        with pytest.raises(ProbeFailed, match=r'broke off with code (-9|None)'):
            examine(exam, files, sandbox=strongest(), told=told)

        assert (again.points, again.timing['repeated']) == (exam.max_points, 1.0)
        assert (left, last['run']) == (0, 4)


class TestRefusals:
    """What the machine does not allow is said in its own words, and leaves nothing open."""

    def test_a_sandbox_that_does_not_start(self, student, tmp_path, monkeypatch):
        """With the repair that goes with it."""
        program = tmp_path / 'bwrap'
        program.write_text('#!/bin/sh\necho "No permissions to create" >&2\nexit 1\n', 'utf-8')
        program.chmod(0o755)
        monkeypatch.setattr(sandboxes, 'BARE', {'PATH': f'{tmp_path}:/usr/bin:/bin'})
        monkeypatch.setattr(System, 'here', classmethod(lambda cls: System(apparmor_restricts=1)))
        forget()

        with pytest.raises(SandboxUnavailable, match='No permissions to create') as caught:
            probes.start_probe(strongest(), student, tmp_path)

        assert caught.value.fix == isolation.fix_for('No permissions to create', System.here())

    def test_a_fork_that_cannot_be_confined(self, student, monkeypatch):
        """The call that was refused is named, and the next probe is a probe."""
        with monkeypatch.context() as changed:
            changed.setattr(confined.Limits, 'of_process', lambda self: {'nofile': 1 << 40})
            with pytest.raises(ProbeFailed, match='could not be confined: ValueError'):
                probes.start_probe(strongest(), student, Path('/nowhere'))

        with probe_of(student) as probe:
            assert int(status(probe.pid)['CapEff'], 16) == 0

    def test_a_probe_that_is_gone_at_once(self, student, monkeypatch):
        """It is no evidence, so the run may be done again; with another maker."""
        with probe_of(student):
            before = warm()

        def gone(pid: int) -> int:
            raise ProcessLookupError(errno.ESRCH, 'No such process')

        with monkeypatch.context() as changed:
            changed.setattr(os, 'pidfd_open', gone)
            with pytest.raises(ProbeFailed, match='ended before it was told'):
                probes.start_probe(strongest(), student, Path('/nowhere'))

        with probe_of(student):
            assert warm() is not before

    def test_no_descriptor_is_left_open(self, student):
        """After probes, and after one that failed."""
        with probe_of(student):
            pass
        before = sorted(os.listdir('/proc/self/fd'))
        for _ in range(3):
            with probe_of(student):
                pass
        with suppress(ProbeFailed):
            warm().make(os.open('/dev/null', os.O_RDONLY))  # no network at all

        assert len(os.listdir('/proc/self/fd')) == len(before) + 1  # the one just opened

"""
One run: the student's program in the sandbox, the probe beside it, and a recording out of it.

The grader's side of the pipes is one loop over file descriptors.  It reads what the probe and the
program write, bounded; looks every 50 ms at what the sandbox uses; and ends the run when the
probe is done, a limit is passed or the wall clock says so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
import json
import os
from pathlib import Path
import secrets
import selectors
import shutil
import tempfile
import time
from typing import Any

from autograder.errors import ProbeFailed, TooBusy
from autograder.judging.exam import Scenario
from autograder.runs.recording import header, Recording
from autograder.sandboxes.confined import Confined, KILLED, Limits, Program
from autograder.sandboxes.probes import start_probe
from autograder.sandboxes.processes import (
    oom_kills,
    other_domains,
    ports,
    proportional,
    Threads,
    usage,
    wait_until_quiet,
    wait_until_still,
)
from autograder.sandboxes.sandbox import HERE, Sandbox

KEPT_OUTPUT = 64 * 1024
LARGEST_RECORDING = 32 << 20
WATCH_EVERY_S = 0.05
MOST_SLEPT_S = 0.25  # that one look can find; the shortest wait that decides anything takes four
# What the probe is told, see probe.py.
TICK, QUIET, EXITED = b't', b'q', b'e'
BUSY_S = 3.0  # processor time without a node: imports take 0.3 s, and a slow machine thrice that
STILL_S = 0.0025  # twice the period of a writer's questions, see fastdds.xml
MOST_WALL = 5  # times the limit, before a machine counts as too busy for a verdict
INSIDE = {str(HERE / 'inside'): '/grader/inside'}
# A message package takes some 5 s of processor time; six times that, for slower machines.
BUILD_LIMITS = Limits(cpu_s=30)
# A build and a run, one after the other.
PACKAGE_LIMITS = Limits(wall_s=2 * Limits.wall_s, cpu_s=BUILD_LIMITS.cpu_s + Limits.cpu_s)
COURSE_PACKAGE = 'temp_monitor_pkg'


def program_for(scenario: Scenario, submission: Path, python: str) -> tuple[Program, Limits]:
    """
    Return what to run for a scenario.

    :param submission: host folder with the student's files, readable by everyone
    :param python: interpreter of the prepared environment
    """
    binds = {**INSIDE, str(submission): '/submission'}
    if scenario.program == 'build':
        argv = [python, '/grader/inside/build_package.py', '/submission']
        argv += [scenario.build_type.partition('/')[0], scenario.build_type]
        return Program(argv, binds, course_messages=False), BUILD_LIMITS
    if scenario.program == 'package':
        argv = [python, '/grader/inside/run_package.py', '/submission', scenario.build_type]
        argv += [scenario.file.removesuffix('.py'), '--ros-args', '-p', 'use_sim_time:=true']
        # A package of the course's own name brings the messages itself.
        own = scenario.build_type == COURSE_PACKAGE
        argv += scenario.arguments
        return Program(argv, binds, course_messages=not own), PACKAGE_LIMITS
    argv = [python, '/grader/inside/run_node.py', f'/submission/{scenario.file}']
    argv += ['--ros-args', '-p', 'use_sim_time:=true', *scenario.arguments]
    return Program(argv, binds), Limits()


@contextmanager
def laid_out(files: Mapping[str, str]) -> Iterator[tuple[Path, Path]]:
    """
    Write the student's files into a fresh folder and yield it with an empty home.

    :param files: relative path to text; the paths come from our own cell parser
    """
    base = Path(tempfile.mkdtemp(prefix='run-'))
    try:
        base.chmod(0o755)
        submission, home = base / 'submission', base / 'home'
        for folder in (submission, home):
            folder.mkdir(mode=0o755)
        for name, text in files.items():
            path = submission / name
            path.parent.mkdir(mode=0o755, parents=True, exist_ok=True)
            path.write_text(text, encoding='utf-8', errors='replace')
            path.chmod(0o644)
        yield submission, home
    finally:
        shutil.rmtree(base, ignore_errors=True)


def observe(
    exam_name: str,
    scenario: Scenario,
    files: Mapping[str, str],
    sandbox: Sandbox,
    told: Callable[[Mapping[str, Any]], None] | None = None,
) -> tuple[Recording, dict[str, float]]:
    """
    Run a student's files through a scenario.

    :param exam_name: for the recording's header
    :param files: relative path to text
    :param told: called with each event as it happens
    :returns: the recording, and wall-clock facts [s] that no verdict may use
    :raises ProbeFailed: if our own observer died: there is no evidence then
    :raises SandboxUnavailable: if the sandbox refuses
    """
    began = time.monotonic()
    with sandbox.turn(), laid_out(files) as (submission, home):
        program, limits = program_for(scenario, submission, sandbox.ros.python)
        student = sandbox.start(program, limits, home)
        try:
            watched = _Watched(student, limits, scenario, sandbox, home)
            watched.exam, watched.told = exam_name, told
            events = watched.run()
        finally:
            student.kill()
    timing = {'run_s': time.monotonic() - began, 'ready_s': watched.ready_s - began}
    return Recording(header(exam_name, sandbox.mode), events), timing


class _Watched:
    """The loop over one run's pipes."""

    def __init__(
        self,
        student: Confined,
        limits: Limits,
        scenario: Scenario,
        sandbox: Sandbox,
        home: Path,
    ) -> None:
        self.student = student
        self.limits = limits
        self.probe = start_probe(sandbox, student, home)
        self.threads, self.probe_threads = Threads(student.pid), Threads(self.probe.pid)
        self.scenario = scenario
        self.exam = ''
        self.events: list[dict[str, Any]] = []
        self.told: Callable[[Mapping[str, Any]], None] | None = None
        self.pending = b''
        self.recorded = 0
        self.output = {'stdout': b'', 'stderr': b''}
        self.printed = 0
        self.killed = ''
        self.exit: int | None = None
        self.cpu_s = 0.0
        self.ready_s = 0.0
        self.done = False
        self.left = False
        self.domains: list[int] = []
        self.began = self.looked = time.monotonic()
        self.own_s = 0.0
        self.oom_kills = oom_kills()

    def run(self) -> list[dict[str, Any]]:
        """Drive the run to its end and return all events."""
        try:
            self._loop()
            self._look_around()
            self._nobody_else_ended_it()
        finally:
            said = self.probe.end()
            self.threads.close()
            self.probe_threads.close()
        self._read_the_rest()
        if not self.events or self.events[-1]['event'] != 'end':
            if self.killed and not self.ready_s:
                raise ProbeFailed(f'The probe was not ready in time: {self.killed}.')
            if not self.killed:
                code = self.probe.code
                raise ProbeFailed(
                    f'exam {self.exam}: the probe broke off with code {code}: {said or "no word"}.'
                )
            self._keep_event({'event': 'end', 'clock_ns': None, 'reason': self.killed})
        if self.student.held():
            why = self.events[-1]['reason']
            raise ProbeFailed(f'The program had not begun when the run ended: {why}.')
        self._keep_event(self._process_event())
        return self.events

    def _loop(self) -> None:
        # A neutral name that no program can know beforehand.
        order = {**self.scenario.to_json(), 'name': f'n{secrets.token_hex(6)}'}
        self._tell_probe(json.dumps(order).encode() + b'\n')
        with selectors.DefaultSelector() as pipes:
            pipes.register(self.probe.stdout, selectors.EVENT_READ, 'probe')
            ended = os.pidfd_open(self.student.process.pid)
            try:
                pipes.register(ended, selectors.EVENT_READ, 'ended')
                for name in ('stdout', 'stderr'):
                    pipes.register(getattr(self.student.process, name), selectors.EVENT_READ, name)
                self._read_until_done(pipes)
            finally:
                os.close(ended)

    def _read_until_done(self, pipes: selectors.BaseSelector) -> None:
        while not self.done:
            for key, _ in pipes.select(WATCH_EVERY_S):
                if key.data == 'ended':
                    pipes.unregister(key.fileobj)
                    self._student_ended()
                else:
                    self._read(pipes, key)
            if time.monotonic() > self.looked + WATCH_EVERY_S:
                self._look()
            if self.killed:
                return

    def _read(self, pipes: selectors.BaseSelector, key: selectors.SelectorKey) -> None:
        data = os.read(key.fd, 1 << 16)
        if not data:
            pipes.unregister(key.fileobj)
            self.done = self.done or key.data == 'probe'
        elif key.data == 'probe':
            self._recorded(data)
        else:
            self._keep(key.data, data)

    def _keep(self, name: str, data: bytes) -> None:
        """Keep the beginning and the end of what was printed: the end has the traceback."""
        self.printed += len(data)
        kept = self.output[name] + data
        if len(kept) > KEPT_OUTPUT:
            kept = kept[: KEPT_OUTPUT // 4] + kept[-KEPT_OUTPUT * 3 // 4 :]
        self.output[name] = kept

    def _read_the_rest(self) -> None:
        """Read what the program printed last, without waiting for more."""
        for name in self.output:
            stream = getattr(self.student.process, name)
            os.set_blocking(stream.fileno(), False)
            try:
                self._keep(name, os.read(stream.fileno(), 1 << 20))
            except BlockingIOError:
                continue

    def _recorded(self, data: bytes) -> None:
        self.recorded += len(data)
        *lines, self.pending = (self.pending + data).split(b'\n')
        for line in lines:
            try:
                event = json.loads(line)
            except ValueError as error:
                raise ProbeFailed(f'The probe wrote a line that is no event: {error}.') from error
            if event['event'] == 'ready':
                self.ready_s = time.monotonic()
                self.student.release()
                continue
            if event['event'] == 'is_it_quiet':
                # What either sent has arrived when the other's threads have taken it in: a
                # datagram on the loopback interface wakes its reader before its writer goes on.
                wait_until_quiet(self.threads, self.probe_threads)
                self._tell_probe(QUIET)
                continue
            if event['event'] == 'is_it_still':
                wait_until_still(STILL_S, self.threads, self.probe_threads)
                self._tell_probe(QUIET)
                continue
            self._keep_event(event)
            if event['event'] == 'end':
                self._ended(event)
        if self.recorded > LARGEST_RECORDING:
            self.killed = 'too_much_recorded'

    def _ended(self, event: dict[str, Any]) -> None:
        self.done = True
        if event['reason'] == 'too_busy':
            raise ProbeFailed('The machine was too busy: the probe got no turn while it watched.')

    def _keep_event(self, event: dict[str, Any]) -> None:
        self.events.append(event)
        if self.told is not None:
            self.told(event)

    def _student_ended(self) -> None:
        self.exit = self.student.process.wait()
        if self.student.held():
            self._read_the_rest()
            said = self.output['stderr'].decode(errors='replace').strip() or 'no word'
            what = f'The sandbox ended with code {self.exit} before the program began'
            raise ProbeFailed(f'{what}: {said}.')
        self._tell_probe(EXITED)

    def _tell_probe(self, line: bytes) -> None:
        try:
            self.probe.stdin.write(line)
            self.probe.stdin.flush()
        except BrokenPipeError:
            pass  # it ended first

    def _look(self) -> None:
        """Charge the time since the last look, tell the probe, and compare with the limits."""
        now = time.monotonic()
        passed, self.looked = now - self.looked, now
        resident, seconds = usage(self.student.pid) if self.exit is None else (0, self.cpu_s)
        used, self.cpu_s = max(0.0, seconds - self.cpu_s), max(self.cpu_s, seconds)
        # If it was this process that did not look for long, nobody else is to blame; only of a
        # program that used nothing meanwhile is it known that it slept.
        passed = min(passed, 2 * WATCH_EVERY_S if used else MOST_SLEPT_S)
        before = int(self.own_s / WATCH_EVERY_S)
        # A program's time is what it computes and what it sleeps. While it, or our probe, wants a
        # processor and does not get it, the machine is busy and nobody is late.
        self.own_s += min(passed, used) if self._somebody_runs() else passed
        if ticks := int(self.own_s / WATCH_EVERY_S) - before:
            self._tell_probe(TICK * ticks)
        if now - self.began > MOST_WALL * self.limits.wall_s:
            raise TooBusy(
                f'The machine was too busy: {now - self.began:.0f} s passed, and the program had '
                f'{self.own_s:.0f} s of them.'
            )
        self.killed = self.killed or self._over_limit(resident, seconds)

    def _somebody_runs(self) -> bool:
        for threads in (self.threads, self.probe_threads):
            threads.look()
        return self.threads.run() or self.probe_threads.run()

    def _over_limit(self, resident: int, seconds: float) -> str:
        """Return the name of the limit that is passed, or nothing."""
        if self.own_s > self.limits.wall_s:
            return 'wall_time_limit'
        if self.printed > self.limits.output:
            return 'output_limit'
        if self.exit is not None:
            return ''
        if resident > self.limits.memory and proportional(self.student.pid) > self.limits.memory:
            return 'memory_limit'
        if seconds > self.limits.cpu_s:
            return 'cpu_limit'
        starting = not self.events
        if starting and self.scenario.program == 'node' and seconds > BUSY_S:
            return 'busy_before_node'
        count, size = self.student.files()
        if count > self.limits.inodes:
            return 'inode_limit'
        # A sandbox's folders have a size of their own.
        if self.student.home and size > self.limits.folder:
            return 'disk_limit'
        return ''

    def _nobody_else_ended_it(self) -> None:
        """Refuse evidence of a program that the machine, or somebody on it, has ended."""
        if self.killed or self.exit is None:
            return
        if oom_kills() > self.oom_kills and self.exit in KILLED:
            raise ProbeFailed('The machine ran out of memory, and the system ended the program.')
        # No signal from inside reaches the launcher, which is in another pid namespace.
        if self.student.namespaces and self.exit < 0:
            raise ProbeFailed(f'Somebody ended the sandbox from outside, by signal {-self.exit}.')

    def _look_around(self) -> None:
        """See from outside what the probe cannot: other ROS domains, and further processes."""
        if self.student.home is None:  # else the network is that of the whole machine
            self.domains = other_domains(ports(self.student.pid))
        self.threads.look()
        launcher = bool(self.student.namespaces) or self.student.supervised
        running = self.exit is None
        self.left = len(self.threads.processes) > max(1, launcher + running)

    def _process_event(self) -> dict[str, Any]:
        ends = {name: data.decode(errors='replace') for name, data in self.output.items()}
        facts = {
            'exit': self.exit,
            'killed': self.killed,
            'cpu_s': round(self.cpu_s, 2),
            'left': self.left,
            'domains': self.domains,
        }
        return {'event': 'process', **facts, **ends}

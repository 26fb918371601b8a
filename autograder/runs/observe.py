"""
Run the student's program in the sandbox with the probe next to it, and record the run.

Both processes share one virtual clock, so the recording does not depend on the machine.  One loop
over file descriptors reads a limited amount of output from the probe and the program.  It ends the
run when the probe or the program has ended, or when the watchdog reports an exceeded limit.
"""

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
import json
import os
import secrets
import selectors
import signal
import time
from typing import Any

from autograder.clock.virtual_clock import virtual_clock, VirtualClock
from autograder.errors import ProbeFailed
from autograder.inside.confine import family
from autograder.recording import header, Recording
from autograder.runs.one_processor import keep_on, one_processor
from autograder.runs.program import BUILDS, program_for, submission_folder
from autograder.runs.watchdog import Watchdog
from autograder.sandboxes.confinement import ConfinedProgram, KILLED
from autograder.sandboxes.forked import PROBE, Probe, start_probe, start_program, STUDENT
from autograder.sandboxes.processes import oom_kills, running
from autograder.sandboxes.sandbox import Sandbox

KEPT_OUTPUT = 64 * 1024
LARGEST_RECORDING = 32 << 20
EXIT_TIMEOUT_S = 60.0  # timeout for the exit of a sandbox, which normally takes milliseconds
_BREAKS = (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGXCPU)
BROKEN = tuple(code for sign in _BREAKS for code in (-sign, 128 + sign))
"""Exit codes of a probe that crashed on received data; Python exceptions give other codes."""
_NO_TYPE = 'Try: add the package to environment/messages.txt, then run make prepare.'


def observe(
    exam_name: str,
    scenario: Mapping[str, Any],
    files: Mapping[str, str],
    sandbox: Sandbox,
    on_event: Callable[[Mapping[str, Any]], None] | None = None,
) -> tuple[Recording, dict[str, float]]:
    """
    Run a student's files through a scenario and record the run.

    A program that a limit ended is not started a second time: its end counts for both starts.

    :param exam_name: for the recording's header
    :param scenario: made by :meth:`autograder.exam.scenario.Scenario.to_json`
    :param files: text by relative path
    :param on_event: called with each event as it happens
    :returns: the recording, and wall-clock times [s] that must not affect verdicts
    :raises ProbeFailed: if the probe failed, so there is no evidence
    :raises SandboxUnavailable: if the sandbox cannot be started
    """
    found, timing = _observe_start(exam_name, scenario, files, sandbox, on_event)
    if not scenario.get('again'):
        return found, timing
    if found.process.get('killed'):
        ends = [event for event in found.events if event['event'] in ('end', 'process')]
        return replace(found, again=replace(found, events=ends)), timing
    if on_event is not None:
        on_event({'event': 'again'})
    second, more = _observe_start(exam_name, scenario['again'], files, sandbox, on_event)
    return replace(found, again=second), {**timing, 'run_s': timing['run_s'] + more['run_s']}


def _observe_start(
    exam_name: str,
    scenario: Mapping[str, Any],
    files: Mapping[str, str],
    sandbox: Sandbox,
    on_event: Callable[[Mapping[str, Any]], None] | None,
) -> tuple[Recording, dict[str, float]]:
    """Start the program once, as in :func:`observe`."""
    builds = scenario['program'] in BUILDS  # compilers run in parallel
    began = time.monotonic()
    with (
        sandbox.turn(),
        nullcontext(os.sched_getaffinity(0)) if builds else one_processor() as processors,
        submission_folder(files) as (submission, home),
        virtual_clock(2) as clock,
    ):
        program, limits = program_for(scenario, submission, sandbox.ros)
        student = start_program(sandbox, program, limits, home, clock, builds)
        try:
            probe = start_probe(sandbox, student, clock.places[PROBE].fileno())
            clock.begin()
            watchdog = Watchdog(student, (probe.pid, clock.driver.pid), limits, builds)
            loop = _RunLoop(
                exam_name, scenario, student, probe, watchdog, clock, processors, on_event
            )
            events = loop.run()
        finally:
            student.kill()
    timing = {'run_s': time.monotonic() - began, 'ready_s': loop.ready_s - began}
    return Recording(header(exam_name, sandbox.mode), events), timing


@dataclass(eq=False)
class _RunLoop:
    """One run: the loop that reads the output of the probe and of the student's program."""

    exam: str
    scenario: Mapping[str, Any]
    student: ConfinedProgram
    probe: Probe
    watchdog: Watchdog
    clock: VirtualClock
    processors: set[int]
    on_event: Callable[[Mapping[str, Any]], None] | None
    events: list[dict[str, Any]] = field(default_factory=list)
    output: dict[str, bytes] = field(default_factory=lambda: {'stdout': b'', 'stderr': b''})
    pending: bytes = b''
    recorded: int = 0
    printed: int = 0
    killed: str = ''
    exit: int | None = None
    ended_ns: int | None = None
    over_ns: int | None = None
    ready_s: float = 0.0
    released_ns: int = 0
    done: bool = False
    left: bool = False
    killed_before: int = field(default_factory=lambda: oom_kills())

    def run(self) -> list[dict[str, Any]]:
        """Run until the probe has finished or a limit is exceeded, and return all events."""
        try:
            self._loop()
            self._record_end()
            self._record_surroundings()
            self._read_the_rest()
            self._raise_if_ended_externally()
        finally:
            said = self.probe.end()  # until now, virtual time stood still
        if self.ended_ns is not None:
            self.events = _until(self.events, self.ended_ns)
            self._keep_end(self.ended_ns, 'student_exited')
        elif not self._has_end():
            self._keep_end(None, self._why_stopped(said))
        if self.student.held():
            why = self.events[-1]['reason']
            raise ProbeFailed(f'The program had not begun when the run ended: {why}.')
        self._keep_event(self._process_event())
        return self.events

    def _has_end(self) -> bool:
        return bool(self.events) and self.events[-1]['event'] == 'end'

    def _keep_end(self, clock_ns: int | None, reason: str) -> None:
        self._keep_event({'event': 'end', 'clock_ns': clock_ns, 'reason': reason})

    def _why_stopped(self, said: str) -> str:
        """Return the limit that ended the run, or that the program broke the probe."""
        if self.killed and not self.ready_s:
            raise ProbeFailed(f'The probe was not ready in time: {self.killed}.')
        code, said = self.probe.returncode, said or 'no error message'
        if not self.killed and not (self.ready_s and code in BROKEN):
            raise ProbeFailed(
                f'exam {self.exam}: the probe stopped with exit code {code}: {said}.',
                _NO_TYPE if 'ModuleNotFoundError' in said else '',
            )
        self.killed = self.killed or 'probe_broken'
        return self.killed

    def _record_end(self) -> None:
        """Record the program's exit if, in virtual time, it ended before the scenario."""
        if self.killed or (self.done and not self._has_end()):
            return  # a limit has ended the run, or the probe has failed
        self.ended_ns = self._early_end_ns()
        if self.ended_ns is None:
            self.exit = None  # the run ends with the scenario
        elif self.exit is None:
            self.exit = self.student.process.wait(EXIT_TIMEOUT_S)

    def _early_end_ns(self) -> int | None:
        """Return when the program ended [ns]; None if it runs or the scenario ended first."""
        ended_ns = self.clock.ended_ns(STUDENT)
        if ended_ns is None or not self.ready_s:
            return None
        ended_ns -= self.released_ns
        return None if self.over_ns is not None and ended_ns > self.over_ns else ended_ns

    def _is_past_end(self) -> bool:
        """Return whether virtual time has passed an early end of the program."""
        ended_ns = self._early_end_ns()
        return ended_ns is not None and self.clock.elapsed_ns - self.released_ns > ended_ns

    def _loop(self) -> None:
        # Give the probe's node a random name, which no program can predict.
        order = {**self.scenario, 'name': f'n{secrets.token_hex(6)}'}
        self.probe.tell(json.dumps(order).encode() + b'\n')
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
            # The probe writes all events of an instant before virtual time advances, and one read
            # empties the pipe.
            past_end = self._is_past_end()
            # The program's output must not determine when the watchdog checks the limits.
            for key, _ in pipes.select(0 if past_end else self.watchdog.due_in_s()):
                if key.data == 'ended':
                    pipes.unregister(key.fileobj)
                    self._student_ended()
                else:
                    self._read(pipes, key)
            if not self.done and not self.watchdog.due_in_s():
                begun, virtual_s = bool(self.events), self.clock.elapsed_ns / 1e9
                self.killed = self.killed or self.watchdog.look(self.printed, begun, virtual_s)
            if self.killed or (past_end and self._is_past_end()):
                return

    def _read(self, pipes: selectors.BaseSelector, key: selectors.SelectorKey) -> None:
        data = os.read(key.fd, 1 << 16)
        if not data:
            pipes.unregister(key.fileobj)
            self.done = self.done or key.data == 'probe'
        elif key.data == 'probe':
            self._read_events(data)
        else:
            self._keep_output(key.data, data)

    def _keep_output(self, name: str, data: bytes) -> None:
        """Add data to the output; keep only its start and its end (with the traceback)."""
        self.printed += len(data)
        kept = self.output[name] + data
        if len(kept) > KEPT_OUTPUT:
            kept = kept[: KEPT_OUTPUT // 4] + kept[-KEPT_OUTPUT * 3 // 4 :]
        self.output[name] = kept

    def _read_the_rest(self) -> None:
        """Read the program's remaining output without blocking."""
        for name in self.output:
            stream = getattr(self.student.process, name)
            os.set_blocking(stream.fileno(), False)
            try:
                self._keep_output(name, os.read(stream.fileno(), 1 << 20))
            except BlockingIOError:
                continue

    def _read_events(self, data: bytes) -> None:
        self.recorded += len(data)
        *lines, self.pending = (self.pending + data).split(b'\n')
        for line in lines:
            try:
                event = json.loads(line)
            except ValueError as error:
                raise ProbeFailed(
                    f'The probe wrote a line that is not an event: {error}.'
                ) from error
            if event['event'] == 'ready':
                # Virtual time stands still until the probe has received the start byte.
                self.ready_s, self.released_ns = time.monotonic(), self.clock.elapsed_ns
                together = self.probe.pid, self.clock.driver.pid, *family(*self.student.pids)
                keep_on(self.processors, together)
                self.student.release()
                self.probe.tell(b'g')
                continue
            self._keep_event(event)
            self.done = self.done or event['event'] == 'end'
            if event.get('when') == 'end':
                self.over_ns = event['clock_ns']
        if self.recorded > LARGEST_RECORDING:
            self.killed = 'too_much_recorded'

    def _keep_event(self, event: dict[str, Any]) -> None:
        self.events.append(event)
        if self.on_event is not None:
            self.on_event(event)

    def _student_ended(self) -> None:
        self.exit = self.student.process.wait()
        if self.student.held():
            self._read_the_rest()
            said = self.output['stderr'].decode(errors='replace').strip() or 'no error message'
            what = f'The sandbox ended with code {self.exit} before the program began'
            raise ProbeFailed(f'{what}: {said}.')

    def _raise_if_ended_externally(self) -> None:
        """Raise if the machine or another program ended the student's program."""
        if self.killed or self.exit is None:
            return
        # A build whose compiler was killed ends with an exit code of its own.
        ended = self.exit in KILLED or (self.exit and self.scenario['program'] in BUILDS)
        if ended and oom_kills() > self.killed_before:
            raise ProbeFailed('The machine ran out of memory, and the system ended a process.')
        # No process in the sandbox can signal the launcher or the fork's parent, which are in
        # another pid namespace.
        if self.student.namespaces and self.exit < 0:
            raise ProbeFailed(f'Another program ended the sandbox with signal {-self.exit}.')
        if not self.student.reported():
            raise ProbeFailed('Another program ended the process that reports the exit code.')

    def _record_surroundings(self) -> None:
        """Record what the probe cannot see: processes left running."""
        expected = bool(self.student.namespaces) + self.student.supervised
        if self.exit is None:  # the program is still running; a fork also has a launcher
            expected += 1 + bool(self.student.fork)
        self.left = len(running(*self.student.pids)) > expected

    def _process_event(self) -> dict[str, Any]:
        ends = {name: data.decode(errors='replace') for name, data in self.output.items()}
        facts = {
            'exit': self.exit,
            'ended_ns': self.ended_ns,
            'killed': self.killed,
            'cpu_s': round(self.watchdog.cpu_s, 2),
            'left': self.left,
        }
        return {'event': 'process', **facts, **ends}


def _until(events: list[dict[str, Any]], ended_ns: int) -> list[dict[str, Any]]:
    """Return the events up to the program's end, without those at the end of the scenario."""
    early = (event for event in events if (event['clock_ns'] or 0) <= ended_ns)
    return [one for one in early if one['event'] != 'end' and one.get('when') != 'end']

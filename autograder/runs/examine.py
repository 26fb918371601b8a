"""
One exam on one set of files: run it if nobody has yet, then judge the recording.

A recording depends on the files, the exam and the environment, and on nothing else.  It is
kept under a digest of the three, so that equal files (an untouched stub handed in by half a class)
run once, a rerun runs nothing, and a changed check is judged again in milliseconds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
import hashlib
import json
from pathlib import Path
import signal
import threading
import time
from typing import Any

from autograder.errors import (
    GraderError,
    ProbeFailed,
    RecordingInvalid,
    SandboxUnavailable,
    TooBusy,
)
from autograder.explaining.picture_data import pictures
from autograder.judging.clock_steps import parts_of, stepped
from autograder.judging.exam import Exam, Run, Scenario
from autograder.judging.flags import flags_of
from autograder.judging.judge import judge, worth_running
from autograder.judging.late_answers import first_run, second_run
from autograder.judging.own_time import patient
from autograder.judging.results import CheckResult, ExamResult, Verdict
from autograder.runs.observe import observe
from autograder.runs.recording import Event, header, Recording
from autograder.runs.version import environment_digest, made_with
from autograder.runs.workers import outcome_of, Place, task_of
from autograder.sandboxes.isolation import not_protected
from autograder.sandboxes.sandbox import Sandbox

Outcome = tuple[Recording, dict[str, float]]
"""A recording, and times of the run [s]."""
AGAIN = 'again, as it may follow a clock of its own'
"""What somebody who watches is told before a second run."""
_running: dict[str, threading.Lock] = {}
_running_guard = threading.Lock()


def examine(
    exam: Exam,
    files: Mapping[str, str],
    *,
    sandbox: Sandbox,
    recordings: Path | None = None,
    fresh: bool = False,
    told: Callable[[Event], None] | None = None,
    place: Place | None = None,
) -> ExamResult:
    """
    Judge a student's files by an exam.

    :param files: relative path to text, only the files that exist
    :param sandbox: from :func:`autograder.sandboxes.sandbox.strongest`, or ``plain()`` for visible
        checks
    :param recordings: folder that keeps recordings; None keeps nothing
    :param fresh: run even if a recording is kept
    :param told: called with each event of a run as it happens, if it takes place here
    :param place: where to run, None for this thread; judged is always here
    :raises GraderError: for a fault of ours; then there is no verdict
    """
    if exam.hidden and not sandbox.keeps_secrets:
        raise SandboxUnavailable(
            f'A hidden exam is never run with isolation {sandbox.mode}: it keeps nothing hidden.'
        )
    if result := without_recording(exam, files, sandbox.mode):
        return result

    def run() -> Outcome:
        def once(scenario: Scenario) -> Outcome:
            if place is None:
                return observe(exam.name, scenario, files, sandbox, told)
            task = task_of(exam.name, scenario.to_json(), files, sandbox.mode)
            return outcome_of(place.run(task))

        return _run(exam, files, sandbox, once, told or (lambda _: None))

    if recordings is None:
        return judged(exam, files, *run())
    path = recordings / exam.name / f'{digest(exam, files, sandbox)}.jsonl'
    with _one_at_a_time(str(path)):
        recording, timing = _kept_or_run(path, fresh, run)
    result = judged(exam, files, recording, timing)
    return replace(result, recording=path.name if path.exists() else '')


def judged(
    exam: Exam,
    files: Mapping[str, str],
    recording: Recording,
    timing: Mapping[str, float] | None = None,
) -> ExamResult:
    """
    Judge files of which a recording was made; nothing is run.

    :param timing: of the run, if it was just made
    :raises GraderError: if a check itself breaks
    """
    began = time.perf_counter()
    run = Run(files, recording, exam.facts)
    checks = judge(exam, run)
    mode = str(recording.header.get('mode', ''))
    return ExamResult(
        exam.name,
        checks,
        _note(recording),
        mode,
        flags_of(recording, exam.scenario),
        {**(timing or _kept_timing(recording)), 'judge_s': time.perf_counter() - began},
        not_protected=not_protected(mode),
        pictures=pictures(exam, run, checks),
    )


def _kept_timing(recording: Recording) -> dict[str, float]:
    """Return what a recording knows of the time of its run: nothing, if it is an old one."""
    run_s, repeated = recording.header.get('run_s'), recording.header.get('repeated')
    timing = {'kept_run_s': float(run_s)} if isinstance(run_s, (int, float)) else {}
    return {**timing, **({'repeated': 1.0} if repeated else {})}


def without_recording(exam: Exam, files: Mapping[str, str], mode: str) -> ExamResult | None:
    """
    Judge files that need no run, because one is missing or the files alone decide; else None.

    :param mode: isolation mode to name
    """
    missing = [name for name in exam.requires if name not in files]
    if missing:
        return _without(exam, missing)
    if worth_running(exam, files):
        return None
    return judged(exam, files, Recording(header(exam.name, mode), ()))


def _kept_or_run(path: Path, fresh: bool, run: Callable[[], Outcome]) -> Outcome:
    # A file made by this process is as fresh as can be: equal files of a class run once.
    if path.exists() and (not fresh or path in _made_now):
        try:
            kept = Recording.load(path)
        except RecordingInvalid:
            pass  # damaged or of an older format: it is made again
        else:
            # What a limit of time has ended is evidence, and tried again the next time.
            if path in _made_now or kept.process.get('killed') != 'wall_time_limit':
                return kept, {}
    recording, timing = run()
    recording = _for_people(recording, timing)
    recording.save(path)
    _made_now.add(path)
    return recording, timing


_made_now: set[Path] = set()


def _for_people(recording: Recording, timing: Mapping[str, float]) -> Recording:
    """Return a recording that also says how long it took and which versions made it."""
    notes: dict[str, Any] = {'made_with': dict(made_with())}
    if 'run_s' in timing:
        notes['run_s'] = timing['run_s']
    if timing.get('repeated'):
        notes['repeated'] = True
    return Recording({**recording.header, **notes}, recording.events)


def _run(
    exam: Exam,
    files: Mapping[str, str],
    sandbox: Sandbox,
    once: Callable[[Scenario], Outcome],
    told: Callable[[Event], None],
) -> Outcome:
    """Run once, and again in another way if a clock of the program's own may have decided."""
    parts = parts_of(exam.scenario, files)
    first = first_run(exam.scenario, files, exam.hidden)
    recording, timing = _once_or_twice(stepped(first, parts), once)
    # A learner who checks a rhythm does not wait for that: the cause is the same.
    rhythm = patient(exam.scenario, files, recording) if exam.hidden else None
    again = rhythm or second_run(exam.scenario, files, recording, exam.hidden)
    if again and not _passes(exam, files, recording):
        told({'event': 'mark', 'clock_ns': None, 'name': AGAIN})
        other, more = _once_or_twice(stepped(again, parts), once)
        run_s = timing.get('run_s', 0.0) + more.get('run_s', 0.0)
        timing = {**more, **timing, 'run_s': run_s}  # either may have been repeated
        # A slow run may hit a limit of time that the first did not.
        if other.in_wall_time if rhythm else other.end_reason == 'complete':
            recording = other
    about = {
        'scenario': exam.scenario_digest()[:32],
        'files': files_digest(files),
        'environment': environment_digest(sandbox.ros.python),
        'divided': float(parts),
    }
    return Recording({**recording.header, **about}, recording.events), timing


def _passes(exam: Exam, files: Mapping[str, str], recording: Recording) -> bool:
    try:
        checks = judge(exam, Run(files, recording, exam.facts))
    except GraderError:
        return True  # told when the recording is kept and judged; a mended exam needs no new run
    return all(check.verdict is Verdict.PASSED for check in checks)


def _once_or_twice(scenario: Scenario, once: Callable[[Scenario], Outcome]) -> Outcome:
    """Run once; if our own infrastructure hit its limit, once more, and say so."""
    try:
        recording, timing = once(scenario)
        again = _may_have_been_ended(recording)
    except (ProbeFailed, TooBusy):
        again = True
    if not again:
        return recording, timing
    recording, timing = once(scenario)
    return recording, {**timing, 'repeated': 1.0}


ENDING = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT)
"""What people and systems end a process with; a program's own mistakes send other signals."""


def _may_have_been_ended(recording: Recording) -> bool:
    """
    Tell whether something outside may have ended the program, or a compiler it called.

    A program that does it to itself does it again, and then it is evidence.
    """
    process = recording.process
    if process.get('killed') or not process.get('exit'):
        return False
    if process['exit'] in {sign for one in ENDING for sign in (-one, 128 + one)}:
        return True
    return 'Killed' in process.get('stderr', '') + process.get('stdout', '')


def files_digest(files: Mapping[str, str]) -> str:
    """Return a digest of a student's files, as it stands in a recording's header."""
    return _digest(json.dumps(sorted(files.items())))


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode('utf-8', 'replace')).hexdigest()[:32]


def _one_at_a_time(key: str) -> threading.Lock:
    with _running_guard:
        return _running.setdefault(key, threading.Lock())


def digest(exam: Exam, files: Mapping[str, str], sandbox: Sandbox) -> str:
    """Return the name under which a run is kept."""
    environment = environment_digest(sandbox.ros.python)
    parts = (exam.name, exam.scenario_digest(), sandbox.mode, environment, files_digest(files))
    return _digest('\0'.join(parts))


def _without(exam: Exam, missing: list[str]) -> ExamResult:
    """Return the result when a file is not there: what needs it fails, and says so."""
    checks = tuple(
        CheckResult(
            check=check.name,
            title=check.title,
            verdict=Verdict.FAILED if number == 0 else Verdict.NOT_RUN,
            points=0.0,
            max_points=check.points,
            expected=f'{"the files" if len(missing) > 1 else "the file"} {", ".join(missing)}'
            if number == 0
            else '',
            observed='no such cell in the notebook' if number == 0 else '',
            cause='The cell is missing, empty, or its first line is not the magic line.'
            if number == 0
            else '',
            cause_id='missing_file' if number == 0 else '',
            try_this='Put the cell back as it was released and write your answer in it.'
            if number == 0
            else '',
            read=exam.read,
            waits_for='' if number == 0 else exam.checks[0].name,
        )
        for number, check in enumerate(exam.checks)
    )
    return ExamResult(exam.name, checks, note='Nothing was run: a file is missing.')


def _note(recording: Recording) -> str:
    if recording.in_wall_time:
        return 'Your program keeps its own time, so it was watched for a few real seconds.'
    return ''

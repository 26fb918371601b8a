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
    ProbeFailed,
    RecordingInvalid,
    SandboxUnavailable,
    TooBusy,
)
from autograder.exam.exam import Exam, Run
from autograder.explaining.picture_data import pictures
from autograder.judging.flags import flags_of
from autograder.judging.judge import judge, worth_running
from autograder.recording import Event, header, Recording
from autograder.results import CheckResult, ExamResult, Verdict
from autograder.runs.observe import observe
from autograder.runs.pool import outcome_of, Place, task_of
from autograder.runs.version import environment_digest, made_with
from autograder.sandboxes.isolation import not_protected
from autograder.sandboxes.sandbox import Sandbox

Outcome = tuple[Recording, dict[str, float]]
"""A recording, and times of the run [s]."""
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
    :param sandbox: from :func:`autograder.sandboxes.choose.strongest`, or ``plain()`` for visible
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
        def once() -> Outcome:
            scenario = exam.scenario.to_json()
            if place is None:
                return observe(exam.name, scenario, files, sandbox, told)
            task = task_of(exam.name, scenario, files, sandbox.mode)
            return outcome_of(place.run(task))

        recording, timing = _once_or_twice(once)
        about = {
            'scenario': exam.scenario_digest()[:32],
            'files': files_digest(files),
            'environment': _environment(exam, files, sandbox),
        }
        return Recording({**recording.header, **about}, recording.events), timing

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
        '',
        mode,
        flags_of(recording, exam.scenario),
        {**(timing or _kept_timing(recording)), 'judge_s': time.perf_counter() - began},
        not_protected=not_protected(mode),
        pictures=pictures(exam, run, checks),
    )


def _kept_timing(recording: Recording) -> dict[str, float]:
    """Return what a recording knows of the time of its run, if it was kept."""
    known = recording.header
    timing = {'kept_run_s': known['run_s']} if 'run_s' in known else {}
    return {**timing, **({'repeated': 1.0} if known.get('repeated') else {})}


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
    notes |= {'run_s': timing['run_s']} if 'run_s' in timing else {}
    notes |= {'repeated': True} if timing.get('repeated') else {}
    return Recording({**recording.header, **notes}, recording.events)


def _once_or_twice(once: Callable[[], Outcome]) -> Outcome:
    """Run once; if our own infrastructure hit its limit, once more, and say so."""
    try:
        recording, timing = once()
        again = _may_have_been_ended(recording)
    except (ProbeFailed, TooBusy):
        again = True
    if not again:
        return recording, timing
    recording, timing = once()
    return recording, {**timing, 'repeated': 1.0}


ENDING = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT)
"""What people and systems end a process with; a program's own mistakes send other signals."""


def _may_have_been_ended(recording: Recording) -> bool:
    """
    Return whether something outside may have ended the program, or a compiler it called.

    A program that does it to itself does it again, and then it is evidence.
    """
    process = recording.process
    if process.get('killed') or not process.get('exit'):
        return False
    if process['exit'] in {sign for one in ENDING for sign in (-one, 128 + one)}:
        return True
    return 'Killed' in process.get('stderr', '') + process.get('stdout', '')


def files_digest(files: Mapping[str, str]) -> str:
    """Return a digest of a student's files, as it is written in a recording's header."""
    return _digest(json.dumps(sorted(files.items())))


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode('utf-8', 'replace')).hexdigest()[:32]


def _one_at_a_time(key: str) -> threading.Lock:
    with _running_guard:
        return _running.setdefault(key, threading.Lock())


def digest(exam: Exam, files: Mapping[str, str], sandbox: Sandbox) -> str:
    """Return the name under which a run is kept."""
    environment = _environment(exam, files, sandbox)
    parts = (exam.name, exam.scenario_digest(), sandbox.mode, environment, files_digest(files))
    return _digest('\0'.join(parts))


def _environment(exam: Exam, files: Mapping[str, str], sandbox: Sandbox) -> str:
    texts = (*files.values(), json.dumps(exam.scenario.to_json()))
    return environment_digest(sandbox.ros.python, texts)


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

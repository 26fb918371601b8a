"""
Load the stored recording of some files in a scenario, or run the files and record the run.

A recording depends only on the files, the scenario and the environment.  It is stored under a
digest of these three, so identical files (such as untouched stubs) run once, grading again runs
nothing, and an edited check is judged in milliseconds.
"""

from collections.abc import Callable, Mapping
from contextlib import suppress
import json
from pathlib import Path
from typing import Any

from autograder.errors import RecordingInvalid
from autograder.exam.exam import Exam
from autograder.recording import Event, Recording
from autograder.runs.observe import observe
from autograder.runs.task import parse_outcome, Place, task_of
from autograder.runs.version import digest, environment_digest, made_with
from autograder.sandboxes.sandbox import Sandbox

Outcome = tuple[Recording, dict[str, float]]
"""A recording, and times of the run [s], which are empty for a stored recording."""


def load_or_record(
    exam: Exam,
    files: Mapping[str, str],
    sandbox: Sandbox,
    recordings: Path | None = None,
    *,
    fresh: bool = False,
    on_event: Callable[[Event], None] | None = None,
    place: Place | None = None,
) -> tuple[Outcome, str]:
    """
    Return the recording of some files in the scenario of an exam.

    :param files: text by relative path
    :param recordings: folder for stored recordings; None to store nothing
    :param fresh: run even if a recording is stored
    :param on_event: called with each event as it happens; not called for runs on workers
    :param place: the workers that run the program; None to run it in this thread
    :returns: the outcome, and the file name of the recording, empty if it is not stored
    :raises GraderError: if the grader failed
    """
    texts = (*files.values(), json.dumps(exam.scenario.to_json()))
    about = {
        'scenario': exam.scenario_digest(),
        'files': files_digest(files),
        'environment': environment_digest(sandbox.ros.python, texts),
    }

    def run() -> Outcome:
        scenario = exam.scenario.to_json()
        if place is None:
            recording, timing = observe(exam.name, scenario, files, sandbox, on_event)
        else:
            task = task_of(exam.name, scenario, files, sandbox.mode)
            recording, timing = parse_outcome(place.run(task))
        notes: dict[str, Any] = {**about, 'scenario': about['scenario'][:32]}
        notes['made_with'] = dict(made_with())
        notes |= {'run_s': timing['run_s']} if 'run_s' in timing else {}
        return Recording({**recording.header, **notes}, recording.events), timing

    if recordings is None:
        return run(), ''
    parts = (exam.name, about['scenario'], sandbox.mode, about['environment'], about['files'])
    path = recordings / exam.name / f'{digest(chr(0).join(parts).encode(), 32)}.jsonl'
    return _load_or_run(path, fresh, run), path.name


def _load_or_run(path: Path, fresh: bool, run: Callable[[], Outcome]) -> Outcome:
    if path.exists() and not fresh:
        with suppress(RecordingInvalid):  # a damaged file or an older format: record again
            return Recording.load(path), {}
    recording, timing = run()
    recording.save(path)
    return recording, timing


def files_digest(files: Mapping[str, str]) -> str:
    """Return the digest of a student's files, as stored in a recording's header."""
    return digest(json.dumps(sorted(files.items())).encode(), 32)

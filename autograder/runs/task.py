"""
Run programs on other machines; tasks and answers are JSON, encoded as bytes.

A task contains the scenario and the student's files, and its answer contains the recording.  So no
object made from a submission is ever pickled, and a worker receives neither the checks nor the
course secret.
"""

from collections.abc import Mapping
import json
from typing import Any

from autograder import errors
from autograder.errors import GraderError, SandboxUnavailable
from autograder.recording import Recording
from autograder.runs.version import difference, version


def task_of(exam: str, scenario: Mapping[str, Any], files: Mapping[str, str], mode: str) -> bytes:
    """Return one run, with a scenario from ``Scenario.to_json``, as a task for a worker."""
    task = {'exam': exam, 'scenario': scenario, 'files': dict(files), 'mode': mode}
    return json.dumps({'version': version(), **task}).encode()


def parse_outcome(answer: bytes) -> tuple[Recording, dict[str, float]]:
    """
    Read the answer of :func:`run_task`.

    :returns: the recording, and times of the run [s]
    :raises GraderError: if the worker reported a fault; a class from ``errors.py`` is preserved
    """
    found = json.loads(answer)
    if 'fault' in found:
        kind, what, fix = found['fault']
        raise getattr(errors, kind, GraderError)(what, fix)
    return Recording.from_bytes(found['recording'].encode('utf-8')), found['timing']


def run_task(task: bytes) -> bytes:
    """
    Run a student's program in a sandbox on this machine and return the recording.

    :param task: made by :func:`task_of`
    :returns: the answer for :func:`parse_outcome`; a fault of the grader is also returned, not
        raised
    """
    try:
        recording, timing = _run(json.loads(task))
        answer = {'recording': recording.to_bytes().decode('utf-8'), 'timing': timing}
    except GraderError as error:
        answer = _fault(error)
    except Exception as error:  # noqa: BLE001 - a defect in the grader, reported for review
        answer = _fault(errors.defect(error, 'A worker'))
    return json.dumps(answer).encode()


def _fault(error: GraderError) -> dict[str, Any]:
    kind = type(error).__name__
    known = kind if getattr(errors, kind, None) is type(error) else 'GraderError'
    return {'fault': (known, error.what, error.fix)}


def _run(task: Mapping[str, Any]) -> tuple[Recording, dict[str, float]]:
    from autograder.runs.observe import observe
    from autograder.sandboxes.choose import strongest

    if unlike := difference(task['version'], version()):
        raise GraderError(
            f'A worker refused the task: {unlike}.', 'Try: update the worker and restart it.'
        )
    try:
        sandbox, wanted = strongest(), task['mode']
    except SandboxUnavailable as error:  # its advice is for a command, not for a worker
        raise SandboxUnavailable(error.what, 'Try: make doctor on the worker') from error
    if sandbox.mode != wanted:
        raise GraderError(
            f"A worker refused the task: isolation {wanted} does not work for the worker's user.",
            'Try: start all workers as root, or all as an ordinary user.',
        )
    return observe(task['exam'], task['scenario'], task['files'], sandbox)

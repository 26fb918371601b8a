"""
Runs on other machines: a task and its answer are JSON as bytes.

A task holds the scenario and the student's files, its answer the recording.  So no object made
from a submission ever passes between processes, and a worker knows neither checks nor the course's
secret.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
import json
import os
from typing import Any, Protocol, TYPE_CHECKING

from autograder import errors
from autograder.errors import GraderError
from autograder.recording import Recording
from autograder.runs.version import difference, version

if TYPE_CHECKING:
    from autograder.sandboxes.sandbox import Sandbox


class Place(Protocol):
    """
    A place with workers, in which tasks run.

    :param width: how many at a time
    """

    width: int

    def run(self, task: bytes) -> bytes:
        """
        Run one task; several threads may call this at the same time.

        :raises GraderError: if the place failed, whatever the task is
        """


def task_of(exam: str, scenario: Mapping[str, Any], files: Mapping[str, str], mode: str) -> bytes:
    """
    Return one run as bytes.

    :param scenario: what the probe is told, :meth:`autograder.exam.scenario.Scenario.to_json`
    :param files: of the student, relative path to text
    :param mode: the isolation to use
    """
    task = {
        'version': version(),
        'exam': exam,
        'scenario': scenario,
        'files': dict(files),
        'mode': mode,
    }
    return json.dumps(task).encode()


def outcome_of(answer: bytes) -> tuple[Recording, dict[str, float]]:
    """
    Read the result of :func:`run_task`.

    :returns: the recording, and times of the run [s]
    :raises GraderError: of the kind that there was on the other side
    """
    found = json.loads(answer)
    if 'fault' in found:
        kind, what, fix = found['fault']
        fault = getattr(errors, kind, GraderError)
        raise fault(what, fix)
    return Recording.from_bytes(found['recording'].encode('utf-8')), found['timing']


def run_task(task: bytes) -> bytes:
    """
    Run a student's program in a sandbox of this machine and return the recording.

    :param task: made by :func:`task_of`
    :returns: for :func:`outcome_of`; our own fault is an answer too, never an exception
    """
    try:
        recording, timing = _run(json.loads(task))
        answer = {'recording': recording.to_bytes().decode('utf-8'), 'timing': timing}
    except GraderError as error:
        answer = _fault(error)
    except Exception as error:  # noqa: BLE001 - a defect of ours, for a person to look at
        answer = _fault(errors.defect(error, 'A worker'))
    return json.dumps(answer).encode()


def _fault(error: GraderError) -> dict[str, Any]:
    kind = type(error).__name__
    known = kind if getattr(errors, kind, None) is type(error) else 'GraderError'
    return {'fault': (known, error.what, error.fix)}


def _run(task: Mapping[str, Any]) -> tuple[Recording, dict[str, float]]:
    from autograder.runs.observe import observe

    if unlike := difference(task['version'], version()):
        raise GraderError(
            f'A worker refused the task: {unlike}.', 'Try: update the worker and restart it.'
        )
    return observe(task['exam'], task['scenario'], task['files'], _sandbox(task['mode']))


@lru_cache(maxsize=2)
def _sandbox(mode: str) -> Sandbox:
    """Return the sandbox that was tried on this machine before."""
    from autograder.sandboxes.isolation import full
    from autograder.sandboxes.sandbox import Sandbox

    if mode != full(os.geteuid() == 0):
        raise GraderError(
            f'A worker refused the task: isolation {mode} does not work for its user.',
            'Start all workers as the same kind of user.',
        )
    return Sandbox(mode)

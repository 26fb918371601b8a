"""
Run exams on the workers of a Dask scheduler, as ``docs/cluster.md`` describes.

Dask uses pickle to call functions in other processes.  Workers call only :func:`about` and
:func:`autograder.runs.task.run_task`, whose arguments and results are JSON bytes.  So no object
made from a submission is ever pickled or unpickled.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from concurrent.futures import CancelledError
from contextlib import closing, contextmanager
import json
import socket
from typing import Any, TYPE_CHECKING

from autograder.errors import GraderError, SandboxUnavailable
from autograder.layout import Layout
from autograder.runs.task import run_task
from autograder.runs.version import difference, version
from autograder.sandboxes.isolation import MODES

if TYPE_CHECKING:
    from autograder.grading.examine import Engine

INSTALL = 'Try: .venv/bin/python -m pip install --no-deps -r environment/requirements-cluster.txt'
CONNECT_S = 20
TRY_OUT_S = 120


class ClusterUnavailable(GraderError):
    """Report that a scheduler or its workers cannot be used."""


class Cluster:
    """All workers of a scheduler, which run tasks; several threads may use it at the same time."""

    def __init__(self, client: Any) -> None:
        """Count the workers' threads, each of which runs one task at a time."""
        self.width = max(1, sum(client.nthreads().values()))
        self._executor = client.get_executor(pure=False)

    def run(self, task: bytes) -> bytes:
        """
        Run a task on any worker; the scheduler chooses another worker if the first is lost.

        :raises GraderError: if several workers died during the task, or the cluster was lost
        """
        from distributed.scheduler import KilledWorker

        try:
            return self._executor.submit(run_task, task).result()
        except KilledWorker as error:
            raise GraderError(
                'The workers that ran this submission died (killed, or out of memory).',
                'Try: grade again. Finished runs are kept.',
            ) from error
        except CancelledError as error:
            raise GraderError('The run was stopped, or the cluster disconnected.') from error

    def close(self) -> None:
        """Cancel the tasks that have not started."""
        self._executor.shutdown(wait=False)


@contextmanager
def cluster_engine(
    address: str, layout: Layout, fresh: bool = False
) -> Iterator[tuple[Engine, int]]:
    """
    Yield an engine for graded runs on a cluster, and how many tasks can run at the same time.

    :param address: address of the scheduler, such as ``tcp://10.0.0.5:8786``
    :raises ClusterUnavailable: if the scheduler or a worker cannot be used, with the reason
    """
    from autograder.grading.examine import Engine
    from autograder.sandboxes.sandbox import Sandbox

    with _connected(address) as client:
        mode = mode_of_all(_ask_all(client, address))
        with closing(Cluster(client)) as cluster:
            engine = Engine(Sandbox(mode), layout.recordings, fresh, remote=cluster.run)
            yield engine, cluster.width


@contextmanager
def _connected(address: str) -> Iterator[Any]:
    try:
        from distributed import Client
    except ModuleNotFoundError as error:
        raise ClusterUnavailable(
            '--cluster needs Dask, which is not installed.', INSTALL
        ) from error
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise ClusterUnavailable(
            f'--cluster {address}: expected a Dask scheduler, got no answer in {CONNECT_S} s '
            f'({type(error).__name__}).',
            'Try: start it as docs/cluster.md describes, and use the address that it prints',
        ) from error
    with closing(client):
        yield client


def _ask_all(client: Any, address: str) -> dict[str, Mapping[str, Any]]:
    """Return the answer of :func:`about` from every worker process, by the worker's address."""
    workers = list(client.scheduler_info(n_workers=-1)['workers'])
    if not workers:
        raise ClusterUnavailable(
            f'--cluster {address}: the scheduler has no workers.',
            'Try: start workers as docs/cluster.md describes',
        )
    asked = {
        worker: client.submit(about, workers=[worker], pure=False, allow_other_workers=False)
        for worker in workers
    }
    answers = {}
    for worker, future in asked.items():
        try:
            answers[worker] = json.loads(future.result(timeout=TRY_OUT_S))
        except Exception as error:
            raise ClusterUnavailable(
                f'Worker {worker} cannot run this project: {type(error).__name__}: {error}.',
                'Try: start the worker in the folder of the project, with the Python of its .venv',
            ) from error
    return answers


def about() -> bytes:
    """Return the version and isolation mode of this worker as JSON; called on each worker."""
    from autograder.sandboxes import choose

    mode = refusal = ''
    try:
        mode = choose.strongest().mode
    except SandboxUnavailable as error:
        refusal = str(error)
    found = {'version': dict(version()), 'mode': mode, 'refusal': refusal}
    return json.dumps({**found, 'host': socket.gethostname()}).encode()


def mode_of_all(answers: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the mode of all workers; refuse unequal modes or versions, and unprotected exams."""
    first = ''
    for worker, found in answers.items():
        where = f'Worker {worker} on {found["host"]}'
        if unlike := difference(version(), found['version']):
            raise ClusterUnavailable(
                f'{where} has a different version of the project: {unlike}.',
                'Try: check out the same commit on both machines, then run make doctor on both',
            )
        if not found['mode'] or not MODES[found['mode']].keeps_secrets:
            raise ClusterUnavailable(
                f'{where} has no sandbox for hidden exams: {found["refusal"] or found["mode"]}'
            )
        first = first or found['mode']
        if found['mode'] != first:
            raise ClusterUnavailable(
                f'{where} uses isolation {found["mode"]}, other workers use {first}.',
                'Try: start all workers as root, or all as an ordinary user',
            )
    return first

"""
Run tasks: in this process, in a pool of processes, or on a cluster.

A task and its answer are JSON as bytes: the scenario and the student's files, and their recording.
So no object made from a submission ever passes between processes, and a worker knows neither
checks nor the course's secret.  The same function, :func:`run_task`, does the work in every place,
so the verdicts are the same.

If a worker dies (killed, out of memory), its runs are lost.  Each is repeated once, alone in a new
process; if that dies too, the submission is for review.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import CancelledError, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
import fcntl
from functools import lru_cache
import json
import multiprocessing
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
import os
from pathlib import Path
import shutil
import signal
import tempfile
import threading
from typing import Any, Protocol, TYPE_CHECKING

from autograder import errors
from autograder.errors import GraderError
from autograder.recording import Recording
from autograder.runs.version import difference, version

if TYPE_CHECKING:
    from autograder.sandboxes.sandbox import Sandbox

FOLDERS = 'grading-'
"""How the names of the temporary folders of a grading begin."""
LOOK_S = 1.0
"""How often the states of the processes are looked at."""
STOPPED_LOOKS = 3
"""A process that is stopped in so many looks does not go on by itself."""


class Place(Protocol):
    """
    A place in which tasks run.

    :param width: how many at a time
    """

    width: int

    def run(self, task: bytes) -> bytes:
        """
        Run one task; several threads may call this at the same time.

        :raises GraderError: if the place failed, whatever the task is
        """


class WorkerDied(GraderError):
    """A process of the grader ended during a run, twice."""


class Stopped(GraderError):
    """The grading was stopped before this run."""


# -- a task, from both sides -----------------------------------------------------------------


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
    from autograder.sandboxes.sandbox import Sandbox

    sandbox, as_root = Sandbox(mode), os.geteuid() == 0
    if sandbox.isolated and sandbox.facts.root != as_root:
        # bubblewrap's user namespace started by root would still be uid 0 for the kernel.
        who = 'root' if as_root else 'a plain user'
        raise GraderError(
            f'A worker refused the task: isolation {mode} does not work for {who}.',
            'Start all workers as the same kind of user.',
        )
    return sandbox


# -- a pool of processes on this machine -----------------------------------------------------


def processors() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0))


class Pool:
    """
    Worker processes on this machine; a context manager that ends them.

    :param width: how many
    :param on_stopped: called with the number of a process that was stopped and does not go on
    """

    def __init__(self, width: int, on_stopped: Callable[[int], None] = lambda pid: None) -> None:
        """Start no process yet."""
        self.width = width
        self._on_stopped = on_stopped
        self._ended = threading.Event()
        self._guard = threading.Lock()
        self._pool: ProcessPoolExecutor | None = None
        self._single: set[ProcessPoolExecutor] = set()
        self._stopped = False

    def __enter__(self) -> Pool:
        """Watch the processes, of which there are none yet."""
        threading.Thread(target=self._watch, daemon=True).start()
        return self

    def _watch(self) -> None:
        """Report each stopped process: its run would wait forever."""
        looks: Counter[int] = Counter()
        while not self._ended.wait(LOOK_S):
            stopped = {pid for pid in self._pids() if state_of(pid) == 'T'}
            looks = Counter({pid: looks[pid] + 1 for pid in stopped})
            for pid in sorted(pid for pid, count in looks.items() if count == STOPPED_LOOKS):
                self._on_stopped(pid)

    def _pids(self) -> list[int]:
        with self._guard:
            pools = [pool for pool in (self._pool, *self._single) if pool is not None]
        return [process.pid for pool in pools for process in processes(pool) if process.pid]

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """End the processes, at once if there was an error."""
        self._ended.set()
        with self._guard:
            self._stopped = True
            pools = [pool for pool in (self._pool, *self._single) if pool is not None]
        ending = [process for pool in pools for process in processes(pool)]
        for pool in pools:
            if kind is not None:
                kill(pool)
            pool.shutdown(wait=True, cancel_futures=True)
        for process in ending:  # a pool that a thread has just given up waits for nobody
            process.join()

    def run(self, task: bytes) -> bytes:
        """
        Run a task in one of the processes.

        :raises WorkerDied: if its process died, and a second one of its own as well
        :raises Stopped: if the pool is being ended
        """
        pool = self._current()
        try:
            return pool.submit(run_task, task).result()
        except (BrokenProcessPool, CancelledError, RuntimeError):
            # It broke under this task or another one, or between the two lines above.
            self._forget(pool)
        return self._alone(task)

    def _current(self) -> ProcessPoolExecutor:
        with self._guard:
            if self._stopped:
                raise Stopped('The grading was stopped.')
            if self._pool is None:
                self._pool = self._new(self.width)
            return self._pool

    def _forget(self, pool: ProcessPoolExecutor) -> None:
        with self._guard:
            if self._pool is pool:
                self._pool = None
        pool.shutdown(wait=False, cancel_futures=True)

    def _alone(self, task: bytes) -> bytes:
        """Run a task in a separate process, so that a failure affects no other task."""
        with self._guard:
            if self._stopped:
                raise Stopped('The grading was stopped.')
            pool = self._new(1)
            self._single.add(pool)
        try:
            return pool.submit(run_task, task).result()
        except (BrokenProcessPool, CancelledError, RuntimeError) as error:
            if self._stopped:
                raise Stopped('The grading was stopped.') from error
            raise WorkerDied(
                'The process that ran this submission died twice (killed, or out of memory).',
                'Try: grade again. Finished runs are kept.',
            ) from error
        finally:
            with self._guard:
                self._single.discard(pool)
            pool.shutdown(wait=True, cancel_futures=True)

    def _new(self, width: int) -> ProcessPoolExecutor:
        # Not "fork": this process has threads. Not "forkserver": killed, it leaves its socket.
        context = multiprocessing.get_context('spawn')
        folder = tempfile.gettempdir()  # which grading_folder() may have chosen
        return ProcessPoolExecutor(
            width, mp_context=context, initializer=_begin, initargs=(folder,)
        )


def processes(pool: ProcessPoolExecutor) -> list[BaseProcess]:
    """Return the processes of a pool."""
    return list((getattr(pool, '_processes', None) or {}).values())


def state_of(pid: int) -> str:
    """Return the kernel's state of a process, empty if it has ended: proc(5)."""
    try:
        stat = Path(f'/proc/{pid}/stat').read_text(encoding='utf-8', errors='replace')
    except OSError:
        return ''
    return stat.rpartition(')')[2].split()[0]


def kill(pool: ProcessPoolExecutor) -> None:
    """End a pool's processes at once; their sandboxes end with them."""
    for process in processes(pool):
        process.kill()


def _begin(folder: str) -> None:
    """Set up a new worker process: it ignores Ctrl-C, and ends with its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tempfile.tempdir = folder
    parent = multiprocessing.parent_process()
    if parent is not None:
        watch = threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True)
        watch.start()


def _end_with(sentinel: int) -> None:
    # A pool's process holds its own end of the queue, so it would wait for ever for a parent that
    # was killed. With it end its sandboxes: they die with the thread that started them.
    wait([sentinel])
    os._exit(1)


@contextmanager
def grading_folder() -> Iterator[Path]:
    """
    Yield a folder for all temporary files of this process, and remove it afterwards.

    A killed grading cannot remove its folder, so folders of killed gradings are removed first.
    """
    above = Path(tempfile.gettempdir())
    for left in above.glob(f'{FOLDERS}*'):
        _remove_if_left(left)
    folder, lock = _made(above)
    before, tempfile.tempdir = tempfile.tempdir, str(folder)
    try:
        yield folder
    finally:
        tempfile.tempdir = before
        os.close(lock)
        shutil.rmtree(folder, ignore_errors=True)


def _made(above: Path) -> tuple[Path, int]:
    """Create a folder and lock it; the kernel releases the lock when the process ends."""
    while True:
        folder = Path(tempfile.mkdtemp(prefix=FOLDERS, dir=above))
        folder.chmod(0o711)  # the sandboxes' throw-away users pass through
        lock = os.open(folder / 'lock', os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        fcntl.flock(lock, fcntl.LOCK_EX)
        if os.fstat(lock).st_nlink:
            return folder, lock
        os.close(lock)  # another grading was quicker, and treated it as a leftover


def _remove_if_left(folder: Path) -> None:
    try:
        if folder.lstat().st_uid != os.geteuid() or folder.is_symlink():
            return
        lock = os.open(folder / 'lock', os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC)
    except OSError:
        return  # being made or removed by another one
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        shutil.rmtree(folder, ignore_errors=True)
    except BlockingIOError:
        pass  # in use
    finally:
        os.close(lock)

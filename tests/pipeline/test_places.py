"""The same runs here and in a pool of processes, whatever happens to the processes."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
import json
import os
from pathlib import Path
import shutil
import signal
import subprocess
import sys
import tempfile

from places_world import class_of_talkers, exam_of_a_talker, told
import psutil
import pytest

from autograder.errors import GraderError, TooBusy
from autograder.grading.examine import examine
from autograder.runs import pool as workers
from autograder.runs.pool import grading_folder, outcome_of, Pool, run_task, task_of
from autograder.runs.version import difference, version
from autograder.sandboxes.choose import strongest

ROOT = Path(__file__).resolve().parents[2]
SCENARIO = exam_of_a_talker().scenario.to_json()


@pytest.mark.pipeline
@pytest.mark.ros
@pytest.mark.slow
def test_verdicts_of_a_pool_are_those_of_one_by_one():
    """The judge sees the same, whichever process runs the submission."""
    exam, sandbox = exam_of_a_talker(), strongest()
    alone = [told(examine(exam, files, sandbox=sandbox)) for files in class_of_talkers()]

    with grading_folder(), Pool(2) as pool, ThreadPoolExecutor(3) as threads:
        runs = [
            threads.submit(examine, exam, files, sandbox=sandbox, place=pool)
            for files in class_of_talkers()
        ]
        pooled = [told(run.result()) for run in runs]

    assert pooled == alone
    assert [sum(check['points'] for check in one['checks']) for one in alone] == [2, 1, 0]


class TestTask:
    """Bytes in, bytes out."""

    def test_a_task_is_json_and_says_nothing_but_what_the_probe_is_told(self):
        """No check, no secret, no object."""
        task = json.loads(task_of('talker', SCENARIO, {'talker.py': 'x'}, 'bwrap-user'))

        assert set(task) == {'version', 'exam', 'scenario', 'files', 'mode'}
        assert task['scenario'] == json.loads(json.dumps(SCENARIO))

    def test_a_worker_of_another_version_refuses(self, monkeypatch):
        """Its recordings would be of something else."""
        task = task_of('talker', SCENARIO, {}, strongest().mode)
        other = {**version(), 'Python': '2.7.18'}
        monkeypatch.setattr(workers, 'version', lambda: other)

        with pytest.raises(GraderError, match=r'Python: expected 3\.\S+, got 2\.7\.18'):
            outcome_of(run_task(task))

    def test_our_own_fault_keeps_its_kind(self, monkeypatch):
        """It is told on this side as if it had happened here."""

        def refuse(*_):
            raise TooBusy('The machine was too busy.')

        monkeypatch.setattr('autograder.runs.observe.observe', refuse)
        task = task_of('talker', SCENARIO, {}, strongest().mode)

        with pytest.raises(TooBusy, match='The machine was too busy'):
            outcome_of(run_task(task))

    def test_a_defect_of_ours_is_no_crash_of_the_worker(self, monkeypatch):
        """It is an answer that asks for a person."""
        monkeypatch.setattr('autograder.runs.observe.observe', lambda *_: 1 / 0)
        task = task_of('talker', SCENARIO, {}, strongest().mode)

        with pytest.raises(GraderError, match='ZeroDivisionError'):
            outcome_of(run_task(task))

    def test_a_version_differs_by_name(self):
        """What is missing counts, too."""
        assert difference({'a': '1', 'b': '2'}, {'a': '1', 'b': '2'}) == ''
        assert difference({'a': '1'}, {'a': '2', 'c': '3'}) == (
            'a: expected 1, got 2; c: expected nothing, got 3'
        )


@dataclass(frozen=True)
class Killers:
    """Counts in a folder how often a task was begun, over all processes."""

    folder: Path

    def begun(self) -> int:
        """Return how often."""
        return len(list(self.folder.iterdir()))


def dies_each_time(task: bytes) -> bytes:
    """Note that it began, then die as if there were no memory left."""
    (Path(task.decode()) / str(os.getpid())).touch()
    os.kill(os.getpid(), signal.SIGKILL)
    return b''


def dies_once(task: bytes) -> bytes:
    """Die at the first time only."""
    folder = Path(task.decode())
    again = any(folder.iterdir())
    (folder / str(os.getpid())).touch()
    if not again:
        os.kill(os.getpid(), signal.SIGKILL)
    return b'done'


def hangs(task: bytes) -> bytes:
    """Say who it is and never end."""
    with open(task, 'w', encoding='ascii') as told:
        told.write(str(os.getpid()))
    signal.pause()
    return b''


def stops_itself(task: bytes) -> bytes:
    """Stop, as after SIGSTOP from outside."""
    os.kill(os.getpid(), signal.SIGSTOP)
    return b'went on'


@pytest.fixture
def fifo(tmp_path):
    """Return the path of a named pipe: reading from it blocks until something is written."""
    path = tmp_path / 'fifo'
    os.mkfifo(path)
    return path


class TestPool:
    """A process that dies costs a run, not a verdict."""

    def test_a_run_whose_process_died_is_done_again(self, tmp_path, monkeypatch):
        """The others in the pool as well."""
        monkeypatch.setattr(workers, 'run_task', dies_once)

        with Pool(1) as pool:
            assert pool.run(str(tmp_path).encode()) == b'done'
            assert pool.run(str(tmp_path).encode()) == b'done'

    def test_a_run_that_kills_its_process_twice_is_for_review(self, tmp_path, monkeypatch):
        """It is our fault until somebody has looked; and nobody tries for ever."""
        monkeypatch.setattr(workers, 'run_task', dies_each_time)

        with Pool(2) as pool, pytest.raises(workers.WorkerDied, match='died twice'):
            pool.run(str(tmp_path).encode())

        assert Killers(tmp_path).begun() == 2

    def test_a_process_that_was_stopped_is_named(self, monkeypatch):
        """Its run waits, and nothing else would say why the grading does not go on."""
        monkeypatch.setattr(workers, 'run_task', stops_itself)
        named = []

        def wake(pid):
            named.append(pid)
            os.kill(pid, signal.SIGCONT)

        with Pool(1, wake) as pool:
            assert pool.run(b'') == b'went on'
            pids = [process.pid for process in workers.processes(pool._current())]

        assert named == pids

    def test_a_pool_that_is_left_with_an_exception_ends_its_processes(self, fifo, monkeypatch):
        """Ctrl-C does not wait for a run, and nobody begins another one."""
        monkeypatch.setattr(workers, 'run_task', hangs)

        def interrupt(threads):
            with Pool(1) as pool:
                began.append(threads.submit(pool.run, str(fifo).encode()))
                pids.append(int(fifo.read_text('ascii')))
                raise KeyboardInterrupt

        began: list[Future[bytes]] = []
        pids: list[int] = []
        with ThreadPoolExecutor(1) as threads:
            with pytest.raises(KeyboardInterrupt):
                interrupt(threads)
            with pytest.raises(workers.Stopped):
                began[0].result(60)

        assert not psutil.pid_exists(pids[0])

    def test_processes_end_with_a_parent_that_was_killed(self, fifo):
        """A pool of the standard library would wait for ever."""
        code = (
            'import sys; sys.path[:0] = sys.argv[2:]; '
            'import test_places; from autograder.runs import pool as workers; '
            'workers.run_task = test_places.hangs; '
            'workers.Pool(1).run(sys.argv[1].encode())'
        )
        here = str(Path(__file__).parent)
        parent = subprocess.Popen([sys.executable, '-c', code, str(fifo), str(ROOT), here])
        worker = psutil.Process(int(fifo.read_text('ascii')))

        parent.kill()
        parent.wait()

        worker.wait(60)


class TestFolder:
    """Temporary files of runs."""

    def test_what_a_killed_grading_has_left_goes_with_the_next(self, tmp_path, monkeypatch):
        """What lives stays."""
        monkeypatch.setattr('tempfile.tempdir', str(tmp_path))
        left = tmp_path / 'grading-left'
        (left / 'run-x').mkdir(parents=True)
        (left / 'lock').touch()

        with grading_folder() as one, grading_folder() as two:
            assert tempfile.gettempdir() == str(two)
            assert not left.exists()
            assert one.is_dir()
            assert two.is_dir()

        assert list(tmp_path.iterdir()) == []
        assert tempfile.gettempdir() == str(tmp_path)

    def test_a_folder_that_another_grading_takes_for_left_is_made_again(
        self, tmp_path, monkeypatch
    ):
        """It has its lock a moment after it is there."""
        monkeypatch.setattr('tempfile.tempdir', str(tmp_path))
        lock, taken = workers.fcntl.flock, []

        def late(file, how):
            if not taken:
                taken.extend(tmp_path.iterdir())
                shutil.rmtree(taken[0])
            lock(file, how)

        monkeypatch.setattr(workers.fcntl, 'flock', late)
        with grading_folder() as folder:
            assert folder.is_dir()
            assert folder not in taken

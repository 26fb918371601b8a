"""Run tasks one by one, in parallel and as a worker does, and stop them."""

from concurrent.futures import ThreadPoolExecutor
import json
import shutil
import tempfile
import threading

from places_world import class_of_talkers, exam_of_a_talker, stable_facts, TALKER
import pytest

from autograder.errors import GraderError, SandboxUnavailable, TooBusy
from autograder.grading.examine import Engine
from autograder.grading.pipeline import end_runs, THREADS
from autograder.runs import grading_folder as folders
from autograder.runs import task as tasks
from autograder.runs.grading_folder import grading_folder
from autograder.runs.task import parse_outcome, run_task, task_of
from autograder.runs.version import difference, version
from autograder.sandboxes.choose import strongest

SCENARIO = exam_of_a_talker().scenario.to_json()


@pytest.mark.pipeline
@pytest.mark.ros
@pytest.mark.slow
def test_verdicts_of_parallel_runs_are_those_of_one_by_one():
    """The recording is the same, whichever thread or worker (here: run_task) runs the program."""
    exam, sandbox = exam_of_a_talker(), strongest()
    alone = [stable_facts(Engine(sandbox).run(exam, files)) for files in class_of_talkers()]

    with grading_folder(), ThreadPoolExecutor(3) as threads:
        runs = [
            threads.submit(Engine(sandbox, remote=remote).run, exam, files)
            for files in class_of_talkers()
            for remote in (None, run_task)
        ]
        together = [stable_facts(run.result()) for run in runs]

    assert together[::2] == together[1::2] == alone
    assert [sum(check['points'] for check in one['checks']) for one in alone] == [2, 1, 0]


class TestTask:
    def test_a_task_is_json_and_contains_only_what_the_probe_needs(self):
        """A task contains no check, no secret and no pickled object."""
        task = json.loads(task_of('talker', SCENARIO, {'talker.py': 'x'}, 'bwrap-user'))

        assert set(task) == {'version', 'exam', 'scenario', 'files', 'mode'}
        assert task['scenario'] == json.loads(json.dumps(SCENARIO))

    def test_a_worker_of_another_version_refuses(self, monkeypatch):
        """Its recordings would belong to a different version."""
        task = task_of('talker', SCENARIO, {}, strongest().mode)
        other = {**version(), 'Python': '2.7.18'}
        monkeypatch.setattr(tasks, 'version', lambda: other)

        with pytest.raises(GraderError, match=r'Python: expected 3\.\S+, got 2\.7\.18'):
            parse_outcome(run_task(task))

    def test_our_own_fault_keeps_its_kind(self, monkeypatch):
        """The error is raised again in this process, as if it had happened here."""

        def refuse(*_):
            raise TooBusy('The machine was too busy.')

        monkeypatch.setattr('autograder.runs.observe.observe', refuse)
        task = task_of('talker', SCENARIO, {}, strongest().mode)

        with pytest.raises(TooBusy, match='The machine was too busy'):
            parse_outcome(run_task(task))

    def test_a_worker_without_a_sandbox_does_not_name_options_of_commands(self, monkeypatch):
        """An option such as --allow-weak has no effect on a worker."""
        task = task_of('talker', SCENARIO, {}, strongest().mode)

        def refuse():
            raise SandboxUnavailable('bubblewrap refused.', 'Try: --allow-weak=landlock')

        monkeypatch.setattr('autograder.sandboxes.choose.strongest', refuse)

        with pytest.raises(SandboxUnavailable) as caught:
            parse_outcome(run_task(task))
        assert caught.value.what == 'bubblewrap refused.'
        assert caught.value.fix == 'Try: make doctor on the worker'

    def test_a_defect_of_ours_is_no_crash_of_the_worker(self, monkeypatch):
        """The worker answers, and the submission is for review."""
        monkeypatch.setattr('autograder.runs.observe.observe', lambda *_: 1 / 0)
        task = task_of('talker', SCENARIO, {}, strongest().mode)

        with pytest.raises(GraderError, match='ZeroDivisionError'):
            parse_outcome(run_task(task))

    def test_a_version_differs_by_name(self):
        """A missing entry is a difference too."""
        assert difference({'a': '1', 'b': '2'}, {'a': '1', 'b': '2'}) == ''
        assert difference({'a': '1'}, {'a': '2', 'c': '3'}) == (
            'a: expected 1, got 2; c: expected nothing, got 3'
        )


BUSY = TALKER.format(word='right').replace(
    'node.create_timer', 'node.create_timer(1.5, lambda: sum(range(10**9)))\nnode.create_timer'
)
"""Computes for many seconds after its first message."""


@pytest.mark.pipeline
@pytest.mark.ros
@pytest.mark.slow
def test_a_grading_that_is_stopped_ends_its_runs_and_records_nothing(tmp_path):
    """Ctrl-C does not wait for a run, and a run that it ends is never recorded."""
    seen = threading.Event()
    with ThreadPoolExecutor(1, thread_name_prefix=THREADS) as threads:
        run = threads.submit(
            Engine(
                strongest(),
                tmp_path,
                on_event=lambda event: event['event'] == 'message' and seen.set(),
            ).run,
            exam_of_a_talker(),
            {'talker.py': BUSY},
        )
        assert seen.wait(60)
        threads.shutdown(wait=False)
        assert end_runs(60)

    assert isinstance(run.exception(), GraderError)
    assert list(tmp_path.rglob('*.jsonl')) == []


class TestFolder:
    """Temporary files of runs."""

    def test_what_a_killed_grading_has_left_goes_with_the_next(self, tmp_path, monkeypatch):
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
        """A new folder is locked a moment after it is created."""
        monkeypatch.setattr('tempfile.tempdir', str(tmp_path))
        lock, taken = folders.fcntl.flock, []

        def late(file, how):
            if not taken:
                taken.extend(tmp_path.iterdir())
                shutil.rmtree(taken[0])
            lock(file, how)

        monkeypatch.setattr(folders.fcntl, 'flock', late)
        with grading_folder() as folder:
            assert folder.is_dir()
            assert folder not in taken

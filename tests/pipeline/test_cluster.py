"""Test that a cluster, here a scheduler and two local workers, gives the same verdicts."""

from concurrent.futures import ThreadPoolExecutor
import json
import os
import signal

from places_world import class_of_talkers, exam_of_a_talker, stable_facts
import pytest

from autograder import __main__ as command
from autograder.errors import GraderError
from autograder.grading import cluster
from autograder.grading.cluster import (
    about,
    Cluster,
    cluster_engine,
    ClusterUnavailable,
    mode_of_all,
)
from autograder.grading.examine import Engine
from autograder.layout import Layout
from autograder.runs.version import version
from autograder.sandboxes.choose import strongest

pytestmark = [
    pytest.mark.cluster,
    pytest.mark.filterwarnings('ignore::DeprecationWarning:distributed.*'),
    pytest.mark.filterwarnings('ignore::ResourceWarning'),
]


@pytest.fixture(scope='module')
def address():
    """Return the address of a scheduler with two workers, on loopback."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=2, threads_per_worker=1, host='127.0.0.1', dashboard_address=':0'
    ) as local:
        yield local.scheduler_address


@pytest.mark.ros
def test_verdicts_of_a_cluster_are_those_of_one_by_one(address, tmp_path):
    """Only bytes are sent to workers, and the recordings are judged on this machine."""
    exam, sandbox = exam_of_a_talker(), strongest()
    alone = [stable_facts(Engine(sandbox).run(exam, files)) for files in class_of_talkers()]

    with (
        cluster_engine(address, Layout(tmp_path)) as (engine, width),
        ThreadPoolExecutor(2) as threads,
    ):
        assert width == 2
        runs = [threads.submit(engine.run, exam, files) for files in class_of_talkers()]
        there = [stable_facts(run.result()) for run in runs]

    assert there == alone
    assert len(list(tmp_path.rglob('*.jsonl'))) == 3


def kills_its_worker(task: bytes) -> bytes:
    """End the worker as the out-of-memory killer does."""
    os.kill(os.getpid(), signal.SIGKILL)
    return b''


def test_a_run_that_kills_its_workers_is_for_review(monkeypatch):
    """The scheduler gives up on this run, but not on the others."""
    import dask
    from distributed import Client, LocalCluster

    monkeypatch.setattr(cluster, 'run_task', kills_its_worker)
    with (
        dask.config.set({'distributed.scheduler.allowed-failures': 1}),
        LocalCluster(
            n_workers=1, threads_per_worker=1, host='127.0.0.1', dashboard_address=':0'
        ) as local,
        Client(local.scheduler_address, set_as_default=False) as client,
        pytest.raises(GraderError, match='died'),
    ):
        Cluster(client).run(b'')


class TestRefusals:
    """A cluster whose verdicts could differ from those of this machine is not used."""

    def said(self, **changes):
        own = {'version': dict(version()), 'mode': 'bwrap-user', 'refusal': '', 'host': 'lab7'}
        return {**own, **changes}

    def test_workers_that_are_alike_are_used(self):
        assert mode_of_all({'tcp://a': self.said(), 'tcp://b': self.said()}) == 'bwrap-user'

    def test_another_version_is_named(self):
        other = {**version(), 'grader': 'abc'}

        with pytest.raises(ClusterUnavailable, match=r'tcp://b on lab7.*grader: expected .*abc'):
            mode_of_all({'tcp://a': self.said(), 'tcp://b': self.said(version=other)})

    def test_a_worker_without_isolation_is_named(self):
        bare = self.said(mode='', refusal='bubblewrap is not installed.')

        with pytest.raises(ClusterUnavailable, match='bubblewrap is not installed'):
            mode_of_all({'tcp://a': bare})

    def test_weak_isolation_is_refused(self):
        """Weak isolation would have to be accepted on each machine."""
        with pytest.raises(ClusterUnavailable, match='no sandbox for hidden exams: none'):
            mode_of_all({'tcp://a': self.said(mode='none')})

    def test_two_kinds_of_users_are_refused(self):
        """A recording names only one isolation mode."""
        with pytest.raises(ClusterUnavailable, match='bwrap-root, other workers use bwrap-user'):
            mode_of_all({'tcp://a': self.said(), 'tcp://b': self.said(mode='bwrap-root')})

    def test_a_worker_says_what_it_is(self):
        assert json.loads(about())['version'] == dict(version())

    def test_nobody_at_the_address_is_one_line(self, monkeypatch, tmp_path, capsys):
        monkeypatch.setattr(cluster, 'CONNECT_S', 1)
        wanted = ['grade', '--submitted', str(tmp_path), '--cluster', 'tcp://127.0.0.1:9']

        assert command.main(wanted) == command.USAGE
        line = capsys.readouterr().err.strip().splitlines()[-1]
        assert line.startswith(
            'autograder: --cluster tcp://127.0.0.1:9: expected a Dask scheduler'
        )

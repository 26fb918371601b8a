"""Steps of the set-up resume, explain failures and wait for one another."""

import dataclasses
import io
import os
import subprocess
import sys
from types import SimpleNamespace

from collect_sources import laid
import pytest

from environment import prepare, system
from environment.places import Places
from environment.plan import make_plan
from environment.steps import locked, run_steps, Screen, Step, StepError


class FakeSetUp:
    """
    A set-up with three steps, whose stamps contain the same digest.

    :param folder: folder of the set-up
    """

    def __init__(self, folder):
        self.folder = folder
        self.out = io.StringIO()
        self.ran = []
        self.fail_in = None
        self.digest = 'inputs'

    def steps(self):
        return [
            Step(
                name,
                f'Step {name}',
                lambda: False,
                lambda job, name=name: self.run(name, job),
                digest=lambda: self.digest,
                try_this=f'mend {name}',
            )
            for name in ('one', 'two', 'three')
        ]

    def run(self, name, job):
        self.ran.append(name)
        print(f'working on {name}', file=job.log, flush=True)
        if self.fail_in == name:
            raise StepError(f'{name} broke')

    def go(self, **screen):
        self.ran.clear()
        return run_steps(self.steps(), self.folder, Screen(self.out, **screen))


@pytest.fixture
def fake(tmp_path):
    return FakeSetUp(tmp_path)


def test_run_steps_all_needed_runs_in_order(fake):
    assert fake.go()
    assert fake.ran == ['one', 'two', 'three']
    assert '[2/3] Step two ...' in fake.out.getvalue()


def test_run_steps_second_time_does_nothing(fake):
    fake.go()
    fake.out.truncate(0)

    assert fake.go()
    assert fake.ran == []
    assert '[' not in fake.out.getvalue()

    fake.digest = 'other inputs'
    assert fake.go()
    assert fake.ran == ['one', 'two', 'three']


def test_run_steps_failure_explains_stops_and_goes_on_there(fake):
    fake.fail_in = 'two'

    assert not fake.go()
    assert fake.ran == ['one', 'two']
    text = fake.out.getvalue()
    assert '[2/3] Step two: FAILED: two broke' in text
    assert '| working on two' in text
    assert 'try: mend two' in text

    fake.fail_in = None
    assert fake.go()
    assert fake.ran == ['two', 'three']


def test_run_steps_killed_step_runs_again(fake):
    fake.run = lambda name, job: (_ for _ in ()).throw(KeyboardInterrupt)
    with pytest.raises(KeyboardInterrupt):
        fake.go()
    del fake.run

    assert fake.go()
    assert fake.ran == ['one', 'two', 'three']


def test_run_steps_edited_while_running_is_stamped_as_before(fake):
    """A file that was edited during a step counts as changed."""
    fake.run = lambda name, job: setattr(fake, 'digest', 'edited')
    fake.go()
    del fake.run

    assert fake.go()
    assert fake.ran == ['one']


def test_run_steps_on_ci_says_one_line_a_step(fake):
    fake.go(quiet=True)

    lines = fake.out.getvalue().splitlines()
    assert len(lines) == 3
    assert all('done in' in line for line in lines)


@pytest.mark.parametrize(
    ('command', 'said'),
    [
        (
            [sys.executable, '-S', '-c', 'print("some words"); raise SystemExit(3)'],
            ['tool ended with code 3', '| some words'],
        ),
        (['/no/such/tool'], ['tool did not start']),
    ],
)
def test_job_run_explains_a_command_that_fails_or_is_missing(tmp_path, command, said):
    step = Step('x', 'X', lambda: True, lambda job: job.run(command, os.environ, 'tool'))
    out = io.StringIO()

    assert not run_steps([step], tmp_path, Screen(out))
    assert all(words in out.getvalue() for words in said)


def test_locked_second_holder_waits(tmp_path):
    lock = tmp_path / 'venv.lock'
    code = (
        'import sys, pathlib; from environment.steps import locked, Screen\n'
        'with locked(pathlib.Path(sys.argv[1]), Screen()): print("in")'
    )
    with locked(lock, Screen(io.StringIO())):
        other = subprocess.Popen(
            [sys.executable, '-S', '-c', code, str(lock)],
            cwd=Places.of('.venv').project,
            env={'PATH': os.environ['PATH'], 'PYTHONPATH': '.'},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        with other.stderr:
            assert 'waiting' in other.stderr.readline()
        assert other.poll() is None

    with other.stdout:
        assert other.stdout.readline() == 'in\n'
    assert other.wait(10) == 0


def test_clear_venv_foreign_folder_is_refused(tmp_path):
    laid(tmp_path, {'.venv/thesis.txt': b''})

    with pytest.raises(StepError, match='not a virtual environment'):
        prepare.clear_venv(Places.of('.venv', tmp_path))
    assert (tmp_path / '.venv' / 'thesis.txt').exists()


def test_clear_venv_leaves_the_one_that_a_link_leads_to(tmp_path):
    """The environment behind a link belongs to another copy of the course."""
    other = laid(tmp_path / 'other', {'pyvenv.cfg': b''})
    (tmp_path / '.venv').symlink_to(other)

    with pytest.raises(StepError, match='this is a link to'):
        prepare.clear_venv(Places.of('.venv', tmp_path))
    assert (other / 'pyvenv.cfg').exists()


def test_clear_venv_half_made_is_emptied_without_its_logs(tmp_path):
    places = Places.of('.venv', tmp_path)
    laid(places.venv, {'lib/x.py': b'', 'pyvenv.cfg': b''})
    laid(places.notes, {'logs/venv.log': b'', 'packages.stamp': b''})
    (places.venv / 'lib64').symlink_to('lib')

    prepare.clear_venv(places)

    assert sorted(path.name for path in places.venv.rglob('*')) == [
        'logs',
        'ros2_course',
        'venv.log',
    ]


def test_make_plan_existing_venv_keeps_its_python(tmp_path):
    subprocess.run([sys.executable, '-m', 'venv', '--without-pip', tmp_path / 'v'], check=True)
    environ = {'PATH': '/nowhere', 'HOME': '/nowhere'}

    plan = make_plan(Places.of('v', tmp_path), environ)

    assert plan.kind == 'wheels'
    assert plan.interpreter.base_prefix == sys.base_prefix


@pytest.mark.parametrize(
    ('source', 'said'),
    [
        ('apt', 'expected wheels or sourced'),
        # Without a sourced ROS 2, the error says which file to source.
        ('sourced', 'setup.bash'),
    ],
)
def test_make_plan_source_that_cannot_be_used_is_refused(tmp_path, source, said):
    with pytest.raises(StepError) as caught:
        make_plan(Places.of('.venv', tmp_path), {'ROS_SOURCE': source})
    assert said in f'{caught.value} {caught.value.try_this}'


def test_make_plan_closed_shared_memory_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(system.os, 'access', lambda *_: False)
    with pytest.raises(StepError, match='/dev/shm: ROS 2 needs shared memory') as caught:
        make_plan(Places.of('.venv', tmp_path), {})
    assert 'mount -o remount,rw' in caught.value.try_this


def test_run_steps_optional_failure_is_reported_and_the_rest_goes_on(fake):
    """A failed step must not print "done", because users would believe the message."""
    one, two, three = fake.steps()
    fake.fail_in = 'two'
    steps = [one, dataclasses.replace(two, optional=True), three]

    assert run_steps(steps, fake.folder, Screen(fake.out))
    assert fake.ran == ['one', 'two', 'three']
    assert 'Step two: FAILED: two broke' in fake.out.getvalue()
    assert 'Step two: done' not in fake.out.getvalue()


def test_a_grader_that_fails_its_proof_is_reported(tmp_path, monkeypatch):
    plan = make_plan(Places(tmp_path / 'venv'), {**os.environ, 'ROS_SOURCE': 'wheels'})
    monkeypatch.setattr(plan, 'description', lambda: SimpleNamespace(python='/bin/false'))
    last = dataclasses.replace(prepare.steps_of(plan)[-1], needed=lambda: True)
    out = io.StringIO()

    assert run_steps([last], tmp_path, Screen(out))
    assert 'FAILED: self-check ended with code 1' in out.getvalue()
    assert 'done in' not in out.getvalue()

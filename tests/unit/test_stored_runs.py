"""A recording is complete or missing, and the grader runs a program only if it is missing."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from autograder.errors import ProbeFailed
from autograder.exam.exam import Exam
from autograder.exam.scenario import Scenario
from autograder.grading import examine
from autograder.grading.examine import Engine
from autograder.recording import header, Recording

SANDBOX = SimpleNamespace(mode='bwrap-user', keeps_secrets=True, ros=SimpleNamespace(python=''))
FILES = {'talker.py': 'x = 1'}
EVENTS = (
    {'event': 'mark', 'clock_ns': None, 'name': 'a'},
    {'event': 'end', 'clock_ns': None, 'reason': 'complete'},
    {'event': 'process', 'exit': 0, 'killed': ''},
)


@pytest.fixture
def exam():
    """Return an exam that any program passes."""
    made = Exam(
        'talker',
        title='Talker',
        assignment='01',
        part=1,
        cells=('talker',),
        requires=('talker.py',),
        scenario=Scenario(file='talker.py'),
    )

    @made.check(points=1)
    def runs(run):
        """It runs."""

    return made


@pytest.fixture
def runs(monkeypatch):
    """Replace each run of a program by a recording of 1.25 s; return the list of runs."""
    made = []

    def observe(*given):
        made.append(given)
        recording = Recording(header('talker', 'bwrap-user'), EVENTS)
        return recording, {'run_s': 1.25, 'ready_s': 0.5}

    monkeypatch.setattr(examine, 'observe', observe)
    monkeypatch.setattr(examine, 'environment_digest', lambda *_: 'e' * 32)
    monkeypatch.setattr(examine, 'made_with', lambda: {'grader': '79c8bf8'})
    return made


@pytest.fixture
def engine(runs, tmp_path):
    return Engine(SANDBOX, tmp_path)


@pytest.fixture
def path(engine, exam, runs, tmp_path):
    """Return the file of a stored recording, and empty the list of runs."""
    name = engine.run(exam, FILES).recording
    runs.clear()
    return tmp_path / 'talker' / name


def test_a_kept_recording_is_read_and_nothing_is_run(engine, exam, runs, path):
    before = path.read_bytes()

    for _ in range(2):
        assert engine.run(exam, FILES).recording == path.name

    assert runs == []
    assert path.read_bytes() == before


def test_a_run_is_repeated_if_anything_that_affects_it_differs(
    engine, exam, runs, path, monkeypatch
):
    names = {path.name, engine.run(exam, {'talker.py': 'x = 2'}).recording}
    root = SimpleNamespace(mode='bwrap-root', keeps_secrets=True, ros=SANDBOX.ros)
    names.add(replace(engine, sandbox=root).run(exam, FILES).recording)
    monkeypatch.setattr(examine, 'environment_digest', lambda *_: 'f' * 32)
    names.add(engine.run(exam, FILES).recording)
    exam.scenario = Scenario(file='other.py')
    names.add(engine.run(exam, FILES).recording)

    assert len(names) == 5
    assert len(runs) == 4


def test_a_run_is_repeated_or_not_stored_on_request(engine, exam, runs, path):
    assert replace(engine, fresh=True).run(exam, FILES).recording == path.name
    assert replace(engine, recordings=None).run(exam, FILES).recording == ''
    assert len(runs) == 2


DAMAGES = {
    'empty': lambda data: b'',
    'a byte': lambda data: data[:1],
    'a piece': lambda data: data[:40],
    'all but one': lambda data: data[:-1],
    # Missing messages would cost points.
    'without an event': lambda data: b'\n'.join(data.split(b'\n')[:1] + data.split(b'\n')[2:]),
    # The times of an older format are from a different clock.
    'older': lambda data: data.replace(b'"version": 3', b'"version": 1'),
}


@pytest.mark.parametrize('damage', DAMAGES.values(), ids=DAMAGES)
def test_a_recording_that_is_damaged_or_old_is_made_again(engine, exam, runs, path, damage):
    path.write_bytes(damage(path.read_bytes()))

    engine.run(exam, FILES)

    assert len(runs) == 1
    assert Recording.load(path).process['exit'] == 0
    assert Recording.load(path).header['version'] == 3


def test_how_long_a_run_took_is_kept_with_it(engine, exam, tmp_path):
    first = engine.run(exam, FILES)
    again = engine.run(exam, FILES)

    stored = Recording.load(tmp_path / 'talker' / first.recording)
    assert stored.header['run_s'] == first.timing['run_s'] == 1.25
    assert stored.header['made_with'] == {'grader': '79c8bf8'}
    assert set(again.timing) == {'kept_run_s', 'judge_s'}
    assert again.ran_s == first.ran_s == 1.25
    assert replace(again, timing={}) == replace(first, timing={})


@pytest.mark.parametrize('error', [ProbeFailed('The probe failed.'), KeyboardInterrupt()])
def test_a_failed_run_is_neither_repeated_nor_stored(engine, exam, tmp_path, monkeypatch, error):
    runs = []

    def fails(*given):
        runs.append(given)
        raise error

    monkeypatch.setattr(examine, 'observe', fails)
    with pytest.raises(type(error)):
        engine.run(exam, FILES)

    assert len(runs) == 1
    assert not list(tmp_path.rglob('*.jsonl'))

"""A recording is complete or missing, and the grader runs a program only if it is missing."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from autograder.errors import ProbeFailed
from autograder.exam.exam import Exam
from autograder.exam.scenario import Scenario
from autograder.grading.examine import Engine
from autograder.recording import header, Recording
from autograder.runs import stored_runs as module
from autograder.runs.stored_runs import _load_or_run

WHOLE = Recording(
    {**header('talker', 'bwrap-user'), 'files': 'a'},
    (
        {'event': 'mark', 'clock_ns': None, 'name': 'a'},
        {'event': 'end', 'clock_ns': None, 'reason': 'complete'},
        {'event': 'process', 'exit': 0, 'killed': ''},
    ),
)


class Runs:
    def __init__(self):
        self.count = 0

    def __call__(self):
        self.count += 1
        return WHOLE, {}


@pytest.fixture
def path(tmp_path):
    return tmp_path / 'talker' / 'abc.jsonl'


def test_a_kept_recording_is_read_and_nothing_is_run(path):
    """A stored recording is read any number of times."""
    runs = Runs()

    first, _ = _load_or_run(path, False, runs)
    second, _ = _load_or_run(path, False, runs)

    assert runs.count == 1
    assert first.to_bytes() == second.to_bytes()


@pytest.mark.parametrize('left', [0, 1, 40, -1], ids=['empty', 'a byte', 'a piece', 'all but one'])
def test_a_recording_that_was_cut_off_is_made_again(path, left):
    """A power cut can leave a truncated recording, so the program is run again."""
    runs = Runs()
    WHOLE.save(path)
    path.write_bytes(path.read_bytes()[:left])

    _load_or_run(path, False, runs)

    assert runs.count == 1
    assert Recording.load(path).process['exit'] == 0


def test_lines_that_were_lost_are_noticed_though_the_rest_is_sound(path):
    """A recording that lost a line is not reused, because missing messages would cost points."""
    runs = Runs()
    WHOLE.save(path)
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b''.join([lines[0], *lines[2:]]))

    _load_or_run(path, False, runs)

    assert runs.count == 1


def test_a_recording_of_an_older_format_is_made_again(path):
    """The times of an older format are from a different clock."""
    runs = Runs()
    path.parent.mkdir()
    path.write_bytes(WHOLE.to_bytes().replace(b'"version": 3', b'"version": 1'))

    _load_or_run(path, False, runs)

    assert runs.count == 1
    assert Recording.load(path).header['version'] == 3


def test_a_run_that_was_killed_leaves_nothing_under_its_name(path):
    def dies():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        _load_or_run(path, False, dies)

    assert not path.exists()


@pytest.fixture
def exam(monkeypatch):
    """Return an exam that any program passes in 1.25 s."""
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

    recording = Recording(header('talker', 'bwrap-user'), WHOLE.events)
    monkeypatch.setattr(module, 'observe', lambda *_: (recording, {'run_s': 1.25, 'ready_s': 0.5}))
    monkeypatch.setattr(module, 'environment_digest', lambda *_: 'e' * 32)
    monkeypatch.setattr(module, 'made_with', lambda: {'grader': '79c8bf8'})
    return made


SANDBOX = SimpleNamespace(mode='bwrap-user', keeps_secrets=True, ros=SimpleNamespace(python=''))
FILES = {'talker.py': 'x = 1'}


def test_how_long_a_run_took_is_kept_with_it(exam, tmp_path):
    """A recording contains its duration and versions, and a rerun does not change them."""
    first = Engine(SANDBOX, tmp_path).run(exam, FILES)
    again = Engine(SANDBOX, tmp_path).run(exam, FILES)

    stored = Recording.load(tmp_path / 'talker' / first.recording)
    assert stored.header['run_s'] == first.timing['run_s'] == 1.25
    assert stored.header['made_with'] == {'grader': '79c8bf8'}
    assert set(again.timing) == {'kept_run_s', 'judge_s'}
    assert again.ran_s == first.ran_s == 1.25
    assert replace(again, timing={}) == replace(first, timing={})


def test_a_failed_run_is_neither_repeated_nor_stored(exam, tmp_path, monkeypatch):
    """A run takes place once; without a recording, the next grading runs the program again."""
    runs = []

    def fails(*given):
        runs.append(given)
        raise ProbeFailed('The probe failed.')

    monkeypatch.setattr(module, 'observe', fails)
    with pytest.raises(ProbeFailed):
        Engine(SANDBOX, tmp_path).run(exam, FILES)

    assert len(runs) == 1
    assert not list(tmp_path.rglob('*.jsonl'))

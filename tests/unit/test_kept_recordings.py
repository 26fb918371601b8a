"""Recordings as the journal of a class: complete or absent, and whoever is absent is run."""

from __future__ import annotations

import pytest

from autograder.runs.examine import _kept_or_run, _made_now
from autograder.runs.recording import header, Recording

WHOLE = Recording(
    {**header('talker', 'bwrap-user'), 'files': 'a'},
    (
        {'event': 'mark', 'clock_ns': None, 'name': 'a'},
        {'event': 'end', 'clock_ns': None, 'reason': 'complete'},
        {'event': 'process', 'exit': 0, 'killed': ''},
    ),
)


class Runs:
    """Runs something, and counts."""

    def __init__(self, killed: str = ''):
        self.count = 0
        self.killed = killed

    def __call__(self):
        """Return a recording that says which run it was."""
        self.count += 1
        *events, last = WHOLE.events
        return Recording(WHOLE.header, (*events, {**last, 'killed': self.killed})), {}


@pytest.fixture
def path(tmp_path):
    """Return where a recording is to be kept."""
    return tmp_path / 'talker' / 'abc.jsonl'


def test_a_kept_recording_is_read_and_nothing_is_run(path):
    """Any number of times."""
    runs = Runs()

    first, _ = _kept_or_run(path, False, runs)
    second, _ = _kept_or_run(path, False, runs)

    assert runs.count == 1
    assert list(first.lines()) == list(second.lines())


@pytest.mark.parametrize('left', [0, 1, 40, -1], ids=['empty', 'a byte', 'a piece', 'all but one'])
def test_a_recording_that_was_cut_off_is_made_again(path, left):
    """As a power cut leaves it, on a file system that tells lies."""
    runs = Runs()
    WHOLE.save(path)
    path.write_bytes(path.read_bytes()[:left])

    _kept_or_run(path, False, runs)

    assert runs.count == 1
    assert Recording.load(path).process['exit'] == 0


def test_lines_that_were_lost_are_noticed_though_the_rest_is_sound(path):
    """Fewer messages would be fewer points."""
    runs = Runs()
    WHOLE.save(path)
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b''.join([lines[0], *lines[2:]]))

    _kept_or_run(path, False, runs)

    assert runs.count == 1


def test_a_run_that_took_too_long_is_tried_again_the_next_time(path):
    """The machine may have been the reason; until then it is the evidence of the verdict."""
    runs = Runs(killed='wall_time_limit')

    for _ in range(2):
        _kept_or_run(path, False, runs)
        _made_now.clear()  # another grading

    assert runs.count == 2
    assert Recording.load(path).process['killed'] == 'wall_time_limit'


def test_a_run_that_was_killed_leaves_nothing_under_its_name(path):
    """Absent is better than half."""

    def dies():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        _kept_or_run(path, False, dies)

    assert not path.exists()

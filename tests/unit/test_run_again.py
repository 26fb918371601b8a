"""Who has not passed and may keep its own time is run again: a clock stands still, or we wait."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from autograder.errors import GraderError
from autograder.judging.exam import Exam, Failed
from autograder.judging.late_answers import GRADED
from autograder.runs import examine as module
from autograder.runs.examine import AGAIN, examine
from autograder.runs.recording import header, Recording
from autograder.runs.scenario import Advance, Await, Feed, Scenario

SANDBOX = SimpleNamespace(mode='bwrap-user', keeps_secrets=True, ros=SimpleNamespace(python=''))
CLOCK, NO_CLOCK = {'talker.py': 'import threading'}, {'talker.py': 'self.create_timer(1, f)'}
IN_WALL_TIME = {'event': 'wall_time', 'clock_ns': None, 'seconds': 3.0}


class Course:
    """An exam, and a program that is seen to keep its own time or not."""

    def __init__(self, passes: bool, own_time: bool = False, hidden: bool = True):
        self.own_time = own_time
        self.runs: list[float] = []
        self.exam = Exam(
            'talker',
            title='Talker',
            assignment='01',
            part=1,
            cells=('talker',),
            requires=('talker.py',),
            scenario=Scenario(file='talker.py', steps=(Advance(1.0),)),
        )
        self.exam.hidden = hidden

        @self.exam.check(points=1)
        def is_right(run):
            """It is right."""
            if not passes and not run.recording.in_wall_time and not run.recording.of('message'):
                raise Failed(expected='simulated time', observed='luck')

    def observe(self, _name, scenario, *_):
        """Run nothing; note how."""
        self.runs.append(scenario.stand_still_s)
        seen = [IN_WALL_TIME] if self.own_time and scenario.stand_still_s else []
        end = {'event': 'end', 'clock_ns': None, 'reason': 'complete'}
        process = {'event': 'process', 'exit': None, 'killed': ''}
        whole = Recording(header('talker', 'bwrap-user'), (*seen, end, process))
        return whole, {'run_s': 2.0, 'ready_s': 0.5}


@pytest.fixture
def graded(monkeypatch):
    """Return a function that grades files in a course, by a hidden way of running them."""
    monkeypatch.setattr(module, 'environment_digest', lambda _: 'e' * 32)

    def grade(course, files, **options):
        monkeypatch.setattr(module, 'observe', course.observe)
        return examine(course.exam, files, sandbox=SANDBOX, **options)

    return grade


def test_what_publishes_while_the_clock_stands_still_is_judged_in_wall_time(graded, tmp_path):
    """The first run, in which luck decided how much came, counts no more."""
    course = Course(passes=False, own_time=True)

    result = graded(course, CLOCK, recordings=tmp_path)

    assert len(course.runs) == 2
    assert result.points == 1
    assert result.note.startswith('Your program keeps its own time')
    assert result.timing['run_s'] == 4.0
    assert Recording.load(tmp_path / 'talker' / result.recording).in_wall_time


def test_what_follows_the_clock_is_judged_as_it_was(graded):
    """A clock in a formula is nothing to hold against anybody."""
    course = Course(passes=False)

    result = graded(course, CLOCK)

    assert len(course.runs) == 2
    assert (result.points, result.note) == (0, '')


@pytest.mark.parametrize(('passes', 'files'), [(True, CLOCK), (False, NO_CLOCK)])
def test_nobody_else_is_run_again(graded, passes, files):
    """What has passed keeps its points, and what names no clock has none of its own."""
    course = Course(passes=passes, own_time=True)

    result = graded(course, files)

    assert course.runs == [0.0]
    assert result.points == passes


def test_a_learner_does_not_wait_for_it(graded):
    """A visible check answers at once; what counts is graded."""
    course = Course(passes=False, own_time=True, hidden=False)

    graded(course, CLOCK)

    assert course.runs == [0.0]


@pytest.mark.parametrize(('reason', 'points'), [('complete', 1), ('wall_time_limit', 0)])
def test_who_answers_late_is_given_time(graded, monkeypatch, reason, points):
    """The second run counts, if it is whole: in the first, luck had a part."""
    course, waits = Course(passes=False), []
    steps = (Feed('/in', [{}]),)
    course.exam.scenario = Scenario(file='talker.py', feed={'/in': 'a/msg/B'}, steps=steps)

    def observe(_name, scenario, *_):
        waits.append([step.seconds for step in scenario.steps if isinstance(step, Await)])
        whole, timing = Course.observe(course, _name, scenario)
        if len(waits) == 1:
            return whole, timing
        end = {'event': 'end', 'clock_ns': None, 'reason': reason}
        came = {'event': 'message', 'clock_ns': None, 'topic': '/out'}
        return Recording(whole.header, (came, end, *whole.events[1:])), timing

    monkeypatch.setattr(course, 'observe', observe)

    result = graded(course, CLOCK)

    assert waits == [[GRADED.still_s], [GRADED.answer_s, GRADED.still_s]]
    assert result.points == points


def test_who_watches_is_told_of_the_second_run(graded):
    """Else nothing would be seen for as long as it takes."""
    seen = []

    graded(Course(passes=False), CLOCK, told=seen.append)

    assert [event['name'] for event in seen] == [AGAIN]


def test_a_kept_recording_is_not_run_again(graded, tmp_path):
    """Once is enough, for both runs."""
    course = Course(passes=False)
    first = graded(course, CLOCK, recordings=tmp_path)
    again = graded(course, CLOCK, recordings=tmp_path)

    assert len(course.runs) == 2
    assert again.checks == first.checks


def test_a_broken_check_loses_no_recording(graded, tmp_path):
    """It is told when the recording is there, so that a mended exam runs nothing again."""
    course = Course(passes=False)

    @course.exam.check(points=1)
    def is_broken(_run):
        """It is broken."""
        raise KeyError('x')

    with pytest.raises(GraderError):
        graded(course, CLOCK, recordings=tmp_path)

    assert course.runs == [0.0]
    assert len(list((tmp_path / 'talker').iterdir())) == 1

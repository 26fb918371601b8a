"""Programs that keep their own time: how long they are watched, and what counts as a rhythm."""

from __future__ import annotations

import pytest

from autograder import exams
from autograder.exams.visible.harbour import lookout_reports_every_second
from autograder.judging import own_time
from autograder.judging.exam import Failed, Run
from autograder.judging.own_time import (
    is_flood,
    is_regular,
    keeps_its_timer,
    least_messages,
    names_another_clock,
    patient,
    STAND_STILL_S,
)
from autograder.runs import inputs
from autograder.runs.recording import header, Recording
from autograder.runs.scenario import Advance, Feed, Look, Scenario


@pytest.fixture
def secret(monkeypatch):
    """Return a function that chooses the course secret."""

    def choose(text: str) -> None:
        monkeypatch.setenv('COURSE_SECRET', text)
        inputs.course_secret.cache_clear()

    yield choose
    inputs.course_secret.cache_clear()


def recording(watched_s: float, end_s: float) -> Recording:
    """Return a recording of a watch in real time."""
    events = (
        {'event': 'wall_time', 'clock_ns': None, 'seconds': watched_s},
        {'event': 'end', 'clock_ns': None, 'reason': 'complete', 'wall_s': end_s},
    )
    return Recording(header('talker', 'none'), events)


def watches(scenario: Scenario) -> list[float]:
    """Return the length of each watch [s]."""
    return [step.watch_s for step in scenario.steps if isinstance(step, Advance)]


SCENARIO = Scenario(steps=(Look('a'), Advance(10), Advance(5)))


class TestHowLongItIsWatched:
    """Nobody can know it, and it is the same each time."""

    def test_the_first_stretch_is_longer_than_three_seconds(self, secret):
        """The others stay short, so that a run stays below its limit."""
        secret('one')

        first, second = watches(own_time.watched_longer('talker', SCENARIO))

        assert own_time.SHORTEST_S <= first <= own_time.LONGEST_S
        assert second == Advance(1).watch_s

    def test_it_is_drawn_from_the_secret_and_the_exam(self, secret):
        """Equal for all, and repeatable."""
        secret('one')
        talker = watches(own_time.watched_longer('talker', SCENARIO))
        again = watches(own_time.watched_longer('talker', SCENARIO))
        other_exam = watches(own_time.watched_longer('harbour', SCENARIO))
        secret('two')
        other_course = watches(own_time.watched_longer('talker', SCENARIO))

        assert talker == again
        assert talker not in (other_exam, other_course)

    def test_nothing_else_of_the_scenario_changes(self, secret):
        """The first step is a feed, and stays as it is."""
        secret('one')

        changed = own_time.watched_longer('talker', SCENARIO)

        assert changed.steps[0] == SCENARIO.steps[0]
        assert changed.steps[1].seconds == 10


class TestRhythm:
    """A period of real time, kept until the end."""

    def test_one_a_second_until_the_end_is_regular(self):
        """Also with the unrest of a busy machine."""
        times = [0.1, 1.2, 2.1, 3.4, 4.2, 5.2, 6.3, 7.2]

        assert is_regular(recording(7.0, 7.6), times, 1.0)

    def test_a_rhythm_that_stops_is_none(self):
        """Four quick ones and then nothing, as the attack sends them."""
        assert not is_regular(recording(7.0, 7.6), [0.1, 0.8, 1.5, 2.2], 1.0)
        assert not is_regular(recording(7.0, 7.6), [0.1, 0.8, 1.5, 2.2, 2.9, 3.6], 1.0)

    def test_twice_a_second_is_another_rhythm(self):
        """And so is one with a hole."""
        assert not is_regular(recording(7.0, 7.2), [number / 2 for number in range(15)], 1.0)
        assert not is_regular(recording(7.0, 7.2), [0.0, 1.0, 2.0, 4.0, 5.0, 6.0, 7.0], 1.0)

    def test_how_many_are_due_depends_on_the_watch(self):
        """Not fewer than three."""
        assert least_messages(recording(6.5, 7.0), 1.0) == 5
        assert least_messages(recording(9.5, 9.9), 1.0) == 7
        assert least_messages(recording(3.0, 3.1), 1.0) == 3

    def test_no_message_is_no_rhythm(self):
        """There is nothing to compare."""
        assert not is_regular(recording(7.0, 7.2), [], 1.0)


@pytest.mark.parametrize(
    ('text', 'found'),
    [
        ('node.create_timer(1.0, node.tick)', False),
        ('self.get_clock().now()', False),
        ('import time\ntime.sleep(1.0)', True),
        ('Clock(clock_type=ClockType.STEADY_TIME)', True),
        ("Parameter('use_sim_time', value=False)", True),
        ('threading.Timer(1.0, tick)', True),
        ('tick()  # better than time.sleep(1.0)', False),
        ('"""It needs no time.sleep()."""', False),
        ("log.info(f'{time.time()}')", True),
    ],
)
def test_another_clock_is_found_in_the_text(text, found):
    """It decides about words only."""
    assert names_another_clock({'a.py': '', 'b.py': text}) is found


@pytest.mark.parametrize(
    ('code', 'times', 'kept'),
    [
        ('node.create_timer(0.5, tick)', [0.5, 1.0, 1.5, 2.0], True),
        ('node.create_timer(0.6, tick)', [0.75, 1.25, 2.0, 2.5], True),
        ('node.create_timer(0.1, tick)', [0.25, 0.5, 0.75, 1.0], True),
        ('node.create_timer(0.5, tick)', [0.5, 1.5, 2.5, 3.5], False),
        ('node.create_timer(0.5, tick)', [0.5, 1.0, 1.5, 4.0], False),
        ('node.create_timer(0.5, tick)', [0.5, 1.0], False),
        ('node.create_timer(period(), tick)', [0.5, 1.0, 1.5, 2.0], False),
    ],
)
def test_messages_in_the_period_of_the_codes_own_timer_are_no_luck(code, times, kept):
    """From the first to the last, to one step of the clock."""
    assert keeps_its_timer({'a.py': code}, times, 0.25) is kept


def test_a_flood_is_far_more_than_was_due():
    """Not only some more."""
    assert is_flood(1000, 20)
    assert not is_flood(200, 20)
    assert not is_flood(8, 0.5)


class TestWhoIsRunAgain:
    """Who has not passed, and may keep its own time although it answers."""

    RUN = Recording(header('talker', 'none'), ({'event': 'end', 'reason': 'complete'},))

    @pytest.mark.parametrize(
        'code',
        [
            'import threading\nthreading.Timer(0.5, speak).start()',
            'from time import sleep as s',
            'node.create_timer(1.0, speak, clock=Clock())',
            'while rclpy.ok():\n    rclpy.spin_once(node, timeout_sec=0.5)\n    speak()',
            'signal.setitimer(signal.ITIMER_REAL, 1, 1)',
            'done.wait(0.5)',
            'rclpy.init(args=[])',
            "super().__init__('a', parameter_overrides=[Parameter('use_sim_time', value=False)])",
        ],
    )
    def test_code_that_may_keep_its_own_time(self, code):
        """Generously: it decides only whether somebody looks."""
        again = patient(SCENARIO, {'a.py': code}, self.RUN)

        assert again is not None
        assert again.stand_still_s == STAND_STILL_S
        assert again.steps == SCENARIO.steps

    def test_code_that_names_no_clock(self):
        """Timers of the node follow the clock that we move; a comment drives nothing."""
        code = 'self.create_timer(0.5, self.speak)  # no time.sleep()'

        assert patient(SCENARIO, {'a.py': code}, self.RUN) is None

    @pytest.mark.parametrize(
        ('scenario', 'run'),
        [
            (Scenario(steps=(Feed('/a', [{}]), Advance(3))), RUN),
            (Scenario(steps=(Look('a'),)), RUN),
            (SCENARIO, recording(3.0, 4.0)),
            (SCENARIO, Recording(header('a', 'none'), ({'event': 'end', 'reason': 'no_node'},))),
        ],
        ids=['answers only', 'no time passes', 'was watched already', 'broken off'],
    )
    def test_nothing_to_find_out(self, scenario, run):
        """Then once is enough."""
        assert patient(scenario, {'a.py': 'import time'}, run) is None


class TestTwoNodesAndTwoClocks:
    """One node of a program follows the clock, and another one does not."""

    @staticmethod
    def lookout_passes(lines: int, clock_s: float) -> bool:
        """Tell whether the lookout passes with so many lines when the clock showed so much."""
        exam = exams.load('harbour')
        log = {'event': 'log', 'name': 'harbour.lookout', 'level': 20, 'text': 'Sea.'}
        events = (
            {'event': 'other_clock', 'clock_ns': None, 'sources': ['harbour.keeper']},
            {'event': 'wall_time', 'clock_ns': None, 'seconds': 8.0},
            *({**log, 'clock_ns': second * 10**9} for second in range(1, lines + 1)),
            {'event': 'end', 'clock_ns': int(clock_s * 1e9), 'reason': 'complete'},
        )
        run = Run({'harbour.py': ''}, Recording(header('harbour', 'none'), events), exam.facts)
        try:
            lookout_reports_every_second(run)
        except Failed:
            return False
        return True

    @pytest.mark.parametrize(('lines', 'clock_s'), [(10, 10.3), (11, 11.0), (10, 11.0)])
    def test_who_follows_the_clock_is_judged_by_it(self, lines, clock_s):
        """The last line may be one that is just due."""
        assert self.lookout_passes(lines, clock_s)

    @pytest.mark.parametrize(('lines', 'clock_s'), [(0, 0.9), (2, 2.1), (9, 11.0), (12, 11.0)])
    def test_who_holds_up_the_clock_has_to_show_as_much(self, lines, clock_s):
        """The clock waits for answers: slow ones are no way to get by with little."""
        assert not self.lookout_passes(lines, clock_s)

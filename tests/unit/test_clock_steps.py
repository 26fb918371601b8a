"""How finely the clock moves for a program, by the periods that its code names."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import pytest

from autograder import exams
from autograder.judging.clock_steps import divided, parts_of, stepped
from autograder.runs.scenario import Advance, Await, Call, Look, Scenario

MINUTE = Advance(60.5, phase_s=0.23)


def code(body):
    """Return a student's files."""
    return {'node.py': body}


def run(scenario, body):
    """Return a scenario as it is run for a program."""
    return stepped(scenario, parts_of(scenario, code(body)))


def moments(advance):
    """Return when the clock ticks in a stretch of time [ns]."""
    ticks = advance.to_json()
    return [ticks['first_ns'] + number * ticks['step_ns'] for number in range(ticks['steps'])]


@pytest.mark.parametrize(
    ('body', 'parts'),
    [
        ('self.create_timer(1.0, self.tick)', Fraction(1, 2)),
        ('PERIOD = 2\nself.create_timer(PERIOD, self.tick)', Fraction(1, 2)),
        ('self.create_timer(timer_period_sec=1.5, callback=tick)', Fraction(1, 2)),
        # Two longer steps a period are not enough, or the period is no whole number of them.
        ('self.create_timer(0.5, self.tick)', 1),
        ('self.create_timer(0.75, self.tick)', 1),
        # Made anew in its callback, it would be rounded up to whole steps.
        ('self.create_timer(1.2, self.tick)', 5),
        ('self.create_timer(0.8, self.tick)', 5),
        ('self.create_timer(1.02, self.tick)', 25),
        ('self.create_timer(1 / 3, self.tick)', 1),
        ('create_timer(1.0, a)\ncreate_timer(0.75, b)', 1),
        ('self.create_timer(0.25, self.tick)', 1),
        # Shorter than a step.
        ('self.create_timer(0.125, self.tick)', 2),
        ('self.create_timer(0.1, self.tick)', 5),
        ('self.create_timer(1 / 10, self.tick)', 5),
        ('RATE = 20\nself.create_timer(1.0 / RATE, self.tick)', 5),
        ('self.create_timer(0.02, self.tick)', 25),
        ('self.create_timer(0.001, self.tick)', 25),
        ('RATE = 50\nPERIOD = 1.0 / RATE\nself.create_timer(PERIOD, self.tick)', 25),
        (
            'period = 0.02\nself.slow = period\ncreate_timer(self.slow)',
            25,
        ),
        ('TICK_MS = 100\nself.create_timer(TICK_MS * 1e-3, self.tick)', 5),
        ('self.create_timer(1e8 / 1e9, self.tick)', 5),
        ('HZ = 10\nself.create_timer(HZ ** -1, self.tick)', 5),
        ('self.create_timer(float(0.1), self.tick)', 5),
        ('self.period, self.every = 0.1, 5\ncreate_timer(self.period, self.tick)', 5),
        ('class C:\n    period: float = 0.1\ncreate_timer(C.period, tick)', 5),
        ('create_timer(1.0, a)\ncreate_timer(0.1, b)', 5),
        ('rate = node.create_rate(10)', 5),
        ('self.get_clock().sleep_for(Duration(seconds=0.125))', 2),
        ('self.get_clock().sleep_for(Duration(nanoseconds=100_000_000))', 5),
    ],
)
def test_shortest_period_decides(body, parts):
    """Each timer has a step of its own at least, and two of a longer one."""
    assert divided(code(body), 0.25) == parts


@pytest.mark.parametrize(
    ('body', 'parts'),
    [
        ("self.declare_parameter('p', 0.1)\nself.create_timer(self.p(), self.tick)", 5),
        ("self.declare_parameter('p', 1.0)\nself.create_timer(self.p(), self.tick)", 1),
        ('def make(period=0.1):\n    create_timer(period, tick)', 5),
        ('hertz = read()\nrate = 10.0\nself.create_timer(1.0 / hertz, self.tick)', 5),
        # Numbers that are no period: without a division ten is the depth of a queue.
        ('self.create_timer(self.p, self.tick)\npublisher(String, "x", 10)', 1),
        ('self.create_timer(self.p, self.tick)\nvalue = gauss(20, 0.001)', 1),
        ('make = self.create_timer\nmake(0.1, self.tick)', 5),
        ("getattr(self, 'create_timer')(0.1, self.tick)", 5),
        ('def __init__(self, period=0.02):\n    create_timer(period, tick)', 25),
        ("self.declare_parameter('ms', 100)\nself.create_timer(self.p() / 1000.0, self.tick)", 5),
        ('self.create_timer(self.p, self.tick)\nvalue = gauss(20, 18.3)', 1),
        # What is given in more ways than one.
        ('period = 1.0\nperiod, every = 0.1, 2\ncreate_timer(period, tick)', 5),
        ('period = 1.0\nfor period in (0.1, 2): pass\ncreate_timer(period, tick)', 5),
        ('period = 1.0\nif (period := 0.1): pass\ncreate_timer(period, tick)', 5),
        ('class C:\n    period: float = 1.0\nc = C(period=0.1)\ncreate_timer(c.period, tick)', 5),
        ('period = 1.0\nsetattr(self, "period", 0.1)\ncreate_timer(self.period, tick)', 5),
        ('value = 1.0\nclass P(Enum):\n    FAST = 0.1\ncreate_timer(P.FAST.value, tick)', 5),
        ('period = 1.0\nperiod = 0.1\nself.create_timer(period, self.tick)', 5),
        ('period = 1.0\nperiod /= 10\nself.create_timer(period, self.tick)', 5),
    ],
)
def test_where_a_period_is_not_readable_the_numbers_of_the_code_are_taken(body, parts):
    """The name of a function, a parameter or a name with two values may hide a short one."""
    assert divided(code(body), 0.25) == parts


@pytest.mark.parametrize(
    'body',
    [
        'import time\ncreate_timer(1.0, tick)',
        'executor = MultiThreadedExecutor()\ncreate_timer(1.0, tick)',
        'async def tick(): pass\ncreate_timer(1.0, tick)',
        'threads = 2\ncreate_timer(1.0, tick)',
        'rate = create_rate(1)',
        'timer = create_timer(1.0, tick)\ntimer.timer_period_ns = 10 ** 8',
        'def broken(',
        '',
    ],
)
def test_longer_steps_are_for_timers_and_nothing_else(body):
    """What another thread or clock may do is looked at as often as the exam says."""
    assert divided(code(body), 0.25) == 1


@pytest.mark.parametrize('period', ['1.0', '0.25', '0.2', '0.1', '0.01'])
@pytest.mark.parametrize('phase_s', [0.02, 0.1, 0.23, 0.25])
@pytest.mark.parametrize('seconds', [0.25, 1.5, 60.5])
def test_stretch_ends_at_the_same_moment(period, phase_s, seconds):
    """Finer steps meet each of the exam's, longer ones each second of them."""
    advance = Advance(seconds, phase_s=phase_s)
    (changed,) = run(Scenario(steps=(advance,)), f'create_timer({period}, f)').steps

    old, new = moments(advance), moments(changed)

    assert new[-1] == old[-1]
    assert set(old[::-1][::2] if period == '1.0' else old) <= set(new)
    assert new[0] > 0
    gaps = {later - earlier for earlier, later in pairwise(new)}
    assert new[0] <= 500_000_000
    assert len(gaps) <= 1


def test_run_does_not_grow_without_end():
    """A whole hour is not cut into hundredths of a second."""
    hour = Scenario(steps=(Advance(900, step_s=0.25),))

    (changed,) = run(hour, 'create_timer(0.01, f)').steps

    assert changed.count == 3600


@pytest.mark.parametrize('name', ['courier', 'milli_reader', 'map_server', 'running_mean'])
def test_who_is_asked_for_answers_may_look_as_often_as_it_likes(name):
    """Where an exam feeds or joins, no rhythm is asked for."""
    scenario = exams.load(name).scenario

    assert parts_of(scenario, code('create_timer(0.01, f)')) == 1


def test_longer_steps_only_where_nobody_is_called():
    """A managed node is looked at as before; finer steps it gets."""
    steps = (Call('/n', 'get_state', 'lifecycle_msgs/srv/GetState'), Look('now'), MINUTE)
    scenario = Scenario(steps=steps)

    assert run(scenario, 'create_timer(1.0, f)').steps == steps
    assert run(scenario, 'create_timer(0.1, f)').steps[2].count > MINUTE.count


@pytest.mark.parametrize(
    'body',
    [
        'create_timer(1e8 / 1e-308, f)',
        'X = 1e8 / 1e-308\ncreate_timer(X, f)',
        'create_timer(Duration(seconds=1, nanoseconds=1e8 / 1e-308), f)',
        'create_timer(1e999, f)',
        'create_rate(5e-324)',
        'create_rate(1e-308)',
        f'create_timer({"9" * 4000}, f)',
        'create_timer(10 ** 10 ** 10, f)',
        'create_timer(1 / 0, f)',
        'create_timer((-1) ** 0.5, f)',
        'create_timer(1j, f)',
        'create_timer(True, f)',
        'create_timer(-1.0, f)',
        f'create_timer({"-" * 500}1.0, f)',
        f'create_timer({"1 + " * 2000}1.0, f)',
        'create_timer(int("x"), f)',
        'create_timer(int(1e999), f)',
        'create_timer()',
        'a = b\nb = a\ncreate_timer(a, f)',
    ],
)
def test_odd_numbers_are_no_periods(body):
    """The grader reads them in its own process, whatever they are."""
    assert divided(code(body), 0.25) in (1, 5)


def test_other_steps_stay():
    """Only the clock moves in another way."""
    wait = Await(logs=1)
    scenario = Scenario(steps=(MINUTE, wait, MINUTE))

    assert run(scenario, 'create_timer(1.0, f)').steps[1] is wait

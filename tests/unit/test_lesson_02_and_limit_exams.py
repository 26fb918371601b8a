"""The exams of lesson 02 and of limit_keeper, without a program: inputs, rules and causes."""

from itertools import combinations

import pytest

from autograder.exam import catalog
from autograder.exam.exam import Failed, Run
from autograder.exam.specification import Specification
from autograder.recording import Recording
from exams.visible import inspector, limit_keeper, pilot
from exams.visible.limit_keeper import LIMIT, Reading
from exams.visible.pilot import joining, PilotInput

SECRETS = [str(number) for number in range(10)]


def beat(at_s):
    """Return a heartbeat."""
    return {'event': 'message', 'topic': '/alive', 'clock_ns': round(at_s * 1e9), 'data': {}}


def result(at_s, text='CAT'):
    return {**beat(at_s), 'topic': '/results', 'data': {'data': text}, 'after_input': 0}


def run_of(exam, *events):
    """Return a run that ended as planned."""
    ends = ({'event': 'end', 'reason': 'complete'}, {'event': 'process'})
    return Run({'n.py': ''}, Recording({}, (*events, *ends)), exam.facts)


class TestJoining:
    rule = staticmethod(joining())

    def test_nothing_is_due_before_all_have_come(self):
        assert self.rule([PilotInput(0, 0.5, 1.0), PilotInput(1, 0.2, 1.0)]) == [(), ((0.5, 0.2),)]

    def test_stop_is_due_while_one_is_old(self):
        inputs = [
            PilotInput(0, 0.5, 0.5),
            PilotInput(1, 0.2, 2.5),
            PilotInput(1, 0.3, 0.5),
            PilotInput(0, 0.0, 0.5),
        ]

        assert self.rule(inputs) == [
            (),
            ((0.5, 0.2), (0.0, 0.0)),
            ((0.0, 0.0),),
            ((0.0, 0.3),),
        ]


def ticked(inputs, begins_s):
    """Return what a pilot's timer publishes after each input."""
    found, sent, now_s = [], [None, None], 0.0
    tick_s = begins_s
    for topic, value, lasts_s in inputs:
        sent[topic] = (now_s, value)
        now_s += lasts_s
        row = []
        while tick_s < now_s:
            if None not in sent:
                old = tick_s - min(sent)[0] > pilot.OLD_S
                row.append(pilot.STOP if old else (sent[0][1], sent[1][1]))
            tick_s += pilot.PERIOD_S
        found.append(pilot.merged(row, lasts_s))
    return found


@pytest.mark.parametrize('secret', SECRETS)
class TestInputsOfThePilot:
    """The exam does not depend on the moment at which the timer was created."""

    def test_any_timer_publishes_all_that_is_due(self, secret):
        """Every command is due long enough for at least one tick."""
        asked = catalog.load_with_secret('pilot', secret).asks['commands']
        for hundredth in range(50):
            assert ticked(asked.inputs, hundredth / 100 + 0.003) == asked.answers

    def test_no_two_inputs_are_whole_periods_apart(self, secret):
        """A timer that is created when one input arrives never ticks when another one arrives."""
        times = [0.0]
        for one in catalog.load_with_secret('pilot', secret).asks['commands'].inputs[:-1]:
            times.append(times[-1] + one.lasts_s)
        gaps = [(later - earlier) / pilot.PERIOD_S for earlier, later in combinations(times, 2)]

        assert min(abs(gap - round(gap)) for gap in gaps) > 0.01


def test_command_before_both_have_come_is_reported():
    early = {
        'event': 'message',
        'topic': '/cmd_vel',
        'clock_ns': 500_000_000,
        'after_input': None,
        'data': {},
    }
    end = {'kind': 'publisher', 'topic': '/cmd_vel', 'type': pilot.TWIST, 'node': '/pilot'}
    graph = {'event': 'graph', 'when': 'end', 'nodes': ['/pilot'], 'endpoints': [end]}

    with pytest.raises(Failed) as failed:
        pilot.waits_for_both(run_of(pilot.exam, early, graph))
    assert failed.value.why == pilot.WHY['begins_early']


class TestHeartbeat:
    quiet = tuple(beat(half / 2) for half in range(1, 7))

    def test_timer_that_waits_for_each_picture_is_reported(self):
        run = run_of(inspector.exam, *self.quiet, result(4.4), beat(4.4), beat(4.5))

        assert inspector.why_starved(run).cause_id == 'starved'

    @pytest.mark.parametrize(
        'events',
        [
            (*quiet, beat(3.5), beat(4.0), result(4.4)),
            (beat(3.2), result(4.4), beat(5.7), result(6.9)),
            quiet,
        ],
        ids=['goes on', 'beats with the pictures', 'no result'],
    )
    def test_other_heartbeats_are_not(self, events):
        assert inspector.why_starved(run_of(inspector.exam, *events)) is None


@pytest.mark.parametrize(
    ('ends_s', 'cause_id'),
    [((5.6, 8.0), 'inspects_twice'), ((4.4, 5.6, 7.6), 'remembers'), ((3.3,), 'not_inspected')],
)
def test_picture_that_is_not_inspected_once_is_reported(ends_s, cause_id):
    """In the visible exam, the third picture equals an earlier one."""
    sent = [
        {'event': 'input', 'index': place, 'clock_ns': round(at_s * 1e9)}
        for place, at_s in enumerate((3.2, 4.4, 7.5))
    ]
    run = run_of(inspector.exam, *sent, *map(result, ends_s))

    with pytest.raises(Failed) as failed:
        inspector.inspects_one_at_a_time(run)

    assert failed.value.why.cause_id == cause_id


class TestLimits:
    def test_node_is_judged_by_the_limits_that_it_accepts(self):
        """A node that accepts NaN never warns again, and loses points only once."""
        changes = [(LIMIT, 35.0), (LIMIT, float('nan')), ('place', 'pump')]
        sent = [Reading(50.0, '', 28.0, 28.0, 28.0, number) for number in range(4)]
        rule = limit_keeper.warns()
        asked = Specification(sent, rule)

        def due(*accepted):
            return limit_keeper.in_force(asked, changes, accepted).answers

        assert due(True, False, True) == [1, 1, 1, 1]
        assert due(True, True, True) == [1, 1, 0, 0]
        assert due() == [1, 1, 1, 1]

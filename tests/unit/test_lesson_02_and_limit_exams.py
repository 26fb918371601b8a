"""The exams of lesson 02 and of limit_keeper, without a program: inputs, rules and causes."""

from itertools import combinations

from handmade_runs import graph, message, publisher, run_of, sent, why
import pytest

from autograder.exam import catalog
from autograder.exam.specification import Specification
from exams.visible import inspector, limit_keeper, pilot
from exams.visible.limit_keeper import LIMIT, Reading
from exams.visible.pilot import joining, PilotInput

SECRETS = [str(number) for number in range(10)]


def test_nothing_is_due_before_all_have_come_and_a_stop_while_one_is_old():
    stop = (0.0, 0.0)
    rows = [
        (PilotInput(0, 0.5, 0.5), ()),
        (PilotInput(1, 0.2, 2.5), ((0.5, 0.2), stop)),
        (PilotInput(1, 0.3, 0.5), (stop,)),
        (PilotInput(0, 0.0, 0.5), ((0.0, 0.3),)),
    ]
    inputs, due = zip(*rows)

    assert joining()(inputs) == list(due)
    both = [PilotInput(0, 0.5, 1.0), PilotInput(1, 0.2, 1.0)]
    assert joining()(both) == [(), ((0.5, 0.2),)]


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
    early = message(0.5, '/cmd_vel', after_input=None)
    seen = graph(publisher('/cmd_vel', '/pilot', pilot.TWIST))

    found = why(pilot.waits_for_both, run_of(early, seen, facts=pilot.exam.facts))

    assert found == pilot.WHY['begins_early']


@pytest.mark.parametrize(
    ('ends_s', 'cause_id'),
    [((5.6, 8.0), 'inspects_twice'), ((4.4, 5.6, 7.6), 'remembers'), ((3.3,), 'not_inspected')],
)
def test_picture_that_is_not_inspected_once_is_reported(ends_s, cause_id):
    """In the visible exam, the third picture equals an earlier one."""
    results = [message(one, '/results', {'data': 'CAT'}, after_input=0) for one in ends_s]
    run = run_of(*sent(3.2, 4.4, 7.5), *results, facts=inspector.exam.facts)

    assert why(inspector.inspects_one_at_a_time, run).cause_id == cause_id


@pytest.mark.parametrize(
    ('accepted', 'due'),
    [((True, False, True), [1, 1, 1, 1]), ((True, True, True), [1, 1, 0, 0]), ((), [1, 1, 1, 1])],
)
def test_node_is_judged_by_the_limits_that_it_accepts(accepted, due):
    """A node that accepts NaN never warns again, and loses points only once."""
    changes = [(LIMIT, 35.0), (LIMIT, float('nan')), ('place', 'pump')]
    readings = [Reading(50.0, '', 28.0, 28.0, 28.0, number) for number in range(4)]
    asked = Specification(readings, limit_keeper.warns())

    assert limit_keeper.in_force(asked, changes, accepted).answers == due

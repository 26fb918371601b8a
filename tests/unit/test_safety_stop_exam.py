"""The exam of the safety stop, without a program: its rule, its inputs and its causes."""

from handmade_runs import at, message, run_of, why
import pytest

from autograder.exam import catalog
from autograder.exam.patterns import why_burst_cut
from exams.visible import safety_stop
from exams.visible.safety_stop import (
    Command,
    guarding,
    LIMIT,
    LONG_S,
    losing,
    places,
    SHORT_S,
    STOP,
)


def test_command_is_limited_and_a_silence_has_one_stop():
    drive = [Command(0.3, 0.2, 0.3), Command(-0.8, 0.9, 0.4), Command(0.5, 0.1, 1.6)]

    assert guarding()(drive) == [((0.3, 0.2),), ((-0.5, 0.9),), ((0.5, 0.1), (0.0, 0.0))]


@pytest.mark.parametrize('secret', [str(number) for number in range(10)])
def test_drawn_commands_are_as_the_exam_needs_them(secret):
    asked = catalog.load_with_secret('safety_stop', secret).asks['commands']
    silent = places(asked, silent=True)
    before_silence = [one for place in silent for one in asked.row(place)]
    fast = [asked.inputs[place].speed for place in places(asked, silent=False, fast=True)]

    zeros = [one for one in asked.inputs if one[:2] == STOP]
    assert zeros == [(*STOP, SHORT_S[0]), (*STOP, LONG_S)]
    assert all(max(one[:2]) <= LIMIT for one in before_silence)
    assert min(fast) < -LIMIT
    assert max(fast) > 1.0
    assert len(silent) == 5


@pytest.mark.parametrize('at_first', [False, True])
def test_command_lost_after_a_stop_is_the_cause(at_first):
    asked = safety_stop.exam.facts['commands']
    came = asked.of(losing(lambda one, after: after, at_first))

    assert asked.cause(came).cause_id == 'first_after_stop'


def test_stop_between_two_commands_is_explained_by_a_timer_that_is_not_reset():
    """If no slip gives all answers, the stop itself is the evidence."""
    events = []
    for index, (speed, turn, _) in enumerate(safety_stop.exam.facts['commands'].inputs):
        data = {'linear': {'x': speed}, 'angular': {'z': turn}}
        events.append(at(index, 'input', data=data, after_input=index))
        messages = [data] if index else [data, {'linear': {'x': 0.0}, 'angular': {'z': 0.0}}]
        events += [message(index, '/cmd_vel', one, after_input=index) for one in messages]

    run = run_of(*events, facts=safety_stop.exam.facts)

    assert why(safety_stop.passes_commands_on, run) == safety_stop.WHY['early_stop']


def test_repeated_command_is_skipped_with_its_stop():
    zero, drive = Command(*STOP, 0.3), Command(0.3, 0.2, 1.6)
    skips_equal = safety_stop.SLIPS[0].rules[0]

    assert skips_equal([zero, drive, drive]) == [(STOP,), ((0.3, 0.2), STOP), ()]


def test_words_of_a_late_stop_have_the_times_of_the_exam():
    failed = safety_stop.WHY.failed('other_moment', late_s=0.7)

    assert failed.expected == 'a stop 0.5 s to 0.6 s after the command'


@pytest.mark.parametrize(
    ('kept', 'cause_id'), [(-1, 'only_the_last'), (0, 'drops_while_busy'), (1, None)]
)
def test_burst_of_which_one_command_is_left_is_explained(kept, cause_id):
    asked = safety_stop.exam.facts['commands']
    one = asked.inputs[-safety_stop.BURST :][kept]

    found = why_burst_cut(asked, (STOP, (one.speed, one.turn)))

    assert (found and found.cause_id) == cause_id

"""Where answers are asked for, who names a clock gets time for them, and then must be silent."""

from __future__ import annotations

import pytest

from autograder.judging.checks import refuse_unasked
from autograder.judging.exam import Failed, Run
from autograder.judging.own_time import (
    LEARNERS_PAUSE_S,
    STAND_STILL_S,
    STILL,
    STILL_AT_FIRST,
    unhurried,
)
from autograder.runs.recording import header, Recording
from autograder.runs.scenario import (
    Advance,
    Await,
    AwaitAnswer,
    Feed,
    Join,
    Leave,
    Mark,
    Offer,
    Scenario,
)

INT = 'std_msgs/msg/Int32'
ONE, TWO = {'data': 1}, {'data': 2}
CLOCK, NO_CLOCK = {'node.py': 'time.sleep(1)'}, {'node.py': "self.say('time.sleep(1)')  # time"}
FEED = Scenario(watch={'/out': INT}, feed={'/in': INT}, steps=(Feed('/in', [ONE, TWO]),))
JOIN = Scenario(steps=(Join('one', '/out', INT), Advance(1), Join('two', '/out', INT)))


def kinds(scenario: Scenario) -> list[type]:
    """Return what the steps are, in order."""
    return [type(step) for step in scenario.steps]


@pytest.mark.parametrize(
    ('scenario', 'files'),
    [
        (FEED, NO_CLOCK),
        (Scenario(steps=(Advance(1),)), CLOCK),
        (Scenario(program='build', steps=FEED.steps), CLOCK),
        (Scenario(steps=(Offer('one', '/in', INT), Feed('one', [ONE]))), CLOCK),
    ],
    ids=['no clock', 'a rhythm', 'our own program', 'offers with deadlines'],
)
def test_all_others_run_as_they_did(scenario, files):
    """Who names no clock, and who is asked for no answers, has nothing to wait for."""
    assert unhurried(scenario, files, hidden=True) is scenario


def test_each_input_is_followed_by_time_for_its_answer():
    """The same messages, in the same order, and in the end a phase in which nothing is due."""
    found = unhurried(FEED, CLOCK, hidden=True)

    assert found.steps == (
        Feed('/in', [ONE]),
        AwaitAnswer(messages=1, seconds=STAND_STILL_S),
        Feed('/in', [TWO]),
        AwaitAnswer(messages=1, seconds=STAND_STILL_S),
        Mark(STILL),
        Await(messages=100_000, seconds=STAND_STILL_S),
    )


def test_a_burst_stays_one():
    """What is sent at once is answered as often."""
    burst = Feed('/in', [ONE, TWO], burst=True)

    found = unhurried(Scenario(watch={'/out': INT}, steps=(burst,)), CLOCK, hidden=True)

    assert found.steps[:2] == (burst, AwaitAnswer(messages=2, seconds=STAND_STILL_S))


@pytest.mark.parametrize('watch', [{}, {'/node/transition_event': INT}], ids=['nothing', 'rclpy'])
def test_where_nothing_of_its_own_is_watched_lines_are_answers(watch):
    """A node that is not asked to publish answers in its log."""
    found = unhurried(Scenario(watch=watch, steps=FEED.steps), CLOCK, hidden=True)

    assert found.steps[1] == AwaitAnswer(logs=1, seconds=STAND_STILL_S)


def test_only_the_first_who_joins_is_waited_for():
    """Those who come later are often owed nothing."""
    assert kinds(unhurried(JOIN, CLOCK, hidden=True)) == [
        *(Join, AwaitAnswer, Advance, Join, Mark, Await)
    ]


def test_who_has_joined_hears_what_comes_before_any_input():
    """It is told apart from what comes in the end."""
    steps = (Join('one', '/out', INT), *FEED.steps, Leave('one'))

    found = unhurried(Scenario(watch={'/out': INT}, steps=steps), CLOCK, hidden=True)

    marks = [step.name for step in found.steps if isinstance(step, Mark)]
    assert marks == [STILL_AT_FIRST, 'inputs', STILL]


def test_a_learner_waits_less():
    """An answer within five seconds is worth more than each last pause."""
    found = unhurried(FEED, CLOCK, hidden=False)

    waits = {step.seconds for step in found.steps if isinstance(step, Await)}
    assert waits == {LEARNERS_PAUSE_S}


def test_what_came_unasked_fails():
    """The words tell no count: it is luck."""
    run = Run(CLOCK, Recording(header('running_mean', 'none'), ()), {})
    refuse_unasked(run, [], 'message')
    with pytest.raises(Failed) as caught:
        refuse_unasked(run, [{'event': 'message'}] * 3, 'message on mean')

    assert caught.value.expected == 'no message on mean when nothing has arrived'
    assert not any(letter.isdigit() for letter in caught.value.observed)
    assert caught.value.why.cause_id == 'other_clock'

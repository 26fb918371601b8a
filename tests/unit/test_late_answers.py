"""Where answers are asked for, who names a clock must be silent in the end, and may be late."""

from __future__ import annotations

import pytest

from autograder.judging.exam import Failed, Run
from autograder.judging.late_answers import (
    CHECKED,
    first_run,
    GRADED,
    MORE_THAN_COME,
    refuse_unasked,
    second_run,
    SOON_S,
    STILL,
    STILL_AT_FIRST,
)
from autograder.runs.recording import header, Recording
from autograder.runs.scenario import Advance, Await, Feed, Join, Leave, Mark, Offer, Scenario

INT = 'std_msgs/msg/Int32'
ONE, TWO = {'data': 1}, {'data': 2}
CLOCK, NO_CLOCK = {'node.py': 'time.sleep(1)'}, {'node.py': "self.say('time.sleep(1)')  # time"}
SINGLES = Feed('/in', [ONE, TWO])
BURST = Feed('/in', [ONE, TWO], burst=True)
EARLY, LATE = Join('early', '/out', INT), Join('late', '/out', INT)
END = {'event': 'end', 'clock_ns': None, 'reason': 'complete'}


def fed(*steps) -> Scenario:
    """Return a scenario that watches an answer."""
    return Scenario(watch={'/out': INT}, feed={'/in': INT}, steps=steps or (SINGLES,))


def recorded(*events) -> Recording:
    """Return a recording of some events."""
    return Recording(header('running_mean', 'none'), (*events, END))


def pause(seconds: float) -> Await:
    """Return a pause that nothing shortens."""
    return Await(messages=MORE_THAN_COME, seconds=seconds)


@pytest.mark.parametrize(
    ('scenario', 'files'),
    [
        (fed(), NO_CLOCK),
        (Scenario(steps=(Advance(1),)), CLOCK),
        (Scenario(program='build', steps=(SINGLES,)), CLOCK),
        (Scenario(steps=(Offer('one', '/in', INT), Feed('one', [ONE]))), CLOCK),
    ],
    ids=['no clock', 'a rhythm', 'our own program', 'offers with deadlines'],
)
def test_all_others_run_as_they_did_and_once(scenario, files):
    """Who names no clock, and who is asked for no answers, has nothing to wait for."""
    assert first_run(scenario, files, hidden=True) is scenario
    assert second_run(scenario, files, recorded(), hidden=True) is None


class TestFirstRun:
    """As the exam says, and then silence."""

    def test_in_the_end_nothing_is_due(self):
        """Right programs pay for a clock in their code with this, and no more."""
        found = first_run(fed(SINGLES, BURST), CLOCK, hidden=True)

        assert found.steps == (SINGLES, BURST, Mark(STILL), pause(GRADED.still_s))

    def test_who_has_joined_hears_what_comes_before_any_input(self):
        """What is repeated then is told apart from what comes in the end."""
        found = first_run(fed(EARLY, SINGLES, LATE, BURST), CLOCK, hidden=False)

        marks = [step.name for step in found.steps if isinstance(step, Mark)]
        assert marks == [STILL_AT_FIRST, 'inputs', STILL]

    def test_a_phase_of_the_exam_goes_on_after_that(self):
        """A check that asks for it finds its inputs in it."""
        found = first_run(fed(Mark('mine'), EARLY, SINGLES), CLOCK, hidden=True)

        marks = [step.name for step in found.steps if isinstance(step, Mark)]
        assert marks == ['mine', STILL_AT_FIRST, 'mine', STILL]

    def test_without_inputs_it_is_slow_at_once(self):
        """Who sends blindly after seconds is through before anybody joins; others have time."""
        steps = (Advance(4, watch_s=7.5), EARLY, Advance(3), LATE, Leave('early'), Leave('late'))

        found = first_run(Scenario(steps=(*steps, Advance(3))), CLOCK, hidden=True)

        time = pause(GRADED.answer_s)
        assert found.steps == (
            *(Advance(4, watch_s=7.5), pause(7.5), EARLY, time, Advance(3), LATE, time),
            *(Leave('early'), Leave('late'), time, Advance(3), Mark(STILL), pause(GRADED.still_s)),
        )

    @pytest.mark.parametrize('step', [SINGLES, EARLY])
    def test_a_learner_waits_less(self, step):
        """An answer within five seconds is worth more than each last pause."""
        found = first_run(fed(step), CLOCK, hidden=False)

        assert found.steps == (step, Mark(STILL), pause(CHECKED.still_s))


class TestSecondRun:
    """The same inputs in the same order, with time for an answer to each."""

    def test_each_input_is_followed_by_time(self):
        """A burst stays one, and may be answered one by one."""
        found = second_run(fed(SINGLES, BURST), CLOCK, recorded(), hidden=True)

        assert found.steps == (
            *(Feed('/in', [ONE]), pause(GRADED.answer_s)),
            *(Feed('/in', [TWO]), pause(GRADED.answer_s)),
            *(BURST, pause(2 * GRADED.answer_s)),
            *(Mark(STILL), pause(GRADED.still_s)),
        )

    @pytest.mark.parametrize(
        'event',
        [
            {'event': 'wall_time', 'clock_ns': None, 'seconds': 3.0},
            {**END, 'reason': 'student_exited'},
        ],
        ids=['keeps its own time', 'is gone'],
    )
    def test_not_for_what_is_known(self, event):
        """Such a program is judged by the first."""
        events = (event,) if event['event'] == 'end' else (event, END)
        seen = Recording(header('running_mean', 'none'), events)

        assert second_run(fed(), CLOCK, seen, hidden=True) is None

    def test_not_for_a_clock_in_a_formula(self):
        """Who drops what comes quickly is not forgiven for the name of a clock."""
        files = {'node.py': 'import time\nnow = time.time()'}

        scenario = fed()

        assert first_run(scenario, files, hidden=True) is not scenario
        assert second_run(scenario, files, recorded(), hidden=True) is None

    def test_who_leaves_is_noticed_before_another_joins(self):
        """Each change of who is there is followed by time."""
        steps = (EARLY, SINGLES, Leave('early'), LATE)

        found = second_run(fed(*steps), CLOCK, recorded(), hidden=True)

        time = pause(GRADED.answer_s)
        assert found.steps[-6:-2] == (Leave('early'), time, LATE, time)

    def test_what_the_exam_awaits_after_a_feed_has_been_waited_for(self):
        """It would ask for the answers to all inputs after the last."""
        found = second_run(fed(SINGLES, Await(logs=2)), CLOCK, recorded(), hidden=True)

        assert Await(logs=2) not in found.steps

    def test_many_inputs_share_the_time_of_a_run(self):
        """A run that hits the limit of time tells nothing."""
        many = Feed('/in', [ONE] * 110)

        found = second_run(fed(many), CLOCK, recorded(), hidden=True)

        assert found.steps[1] == pause(0.5)

    def test_a_feed_of_nothing_stays(self):
        """It still finds out whether somebody listens."""
        found = second_run(fed(Feed('/in', [])), CLOCK, recorded(), hidden=True)

        assert found.steps[0] == Feed('/in', [])

    def test_not_if_the_first_was_slow(self):
        """Without inputs there is no other way to run it."""
        assert second_run(Scenario(steps=(Advance(1), EARLY)), CLOCK, recorded(), True) is None

    @pytest.mark.parametrize(
        ('came', 'answer_s'),
        [('message', CHECKED.answer_s), ('log', CHECKED.answer_s), ('awaited', SOON_S)],
    )
    def test_a_learner_waits_long_only_for_what_was_heard(self, came, answer_s):
        """Who was silent in the end is hardly late."""
        mark = {'event': 'mark', 'clock_ns': None, 'name': STILL}
        seen = recorded(mark, {'event': came, 'clock_ns': None})

        found = second_run(fed(), CLOCK, seen, hidden=False)

        assert found.steps[1] == pause(answer_s)


def test_what_came_unasked_fails():
    """The words tell no count: it is luck."""
    run = Run(CLOCK, recorded(), {})
    refuse_unasked(run, [], 'message')
    with pytest.raises(Failed) as caught:
        refuse_unasked(run, [{'event': 'message'}] * 3, 'message on mean')

    assert caught.value.expected == 'no message on mean when nothing arrives'
    assert not any(letter.isdigit() for letter in caught.value.observed)
    assert caught.value.why.cause_id == 'speaks_unasked'

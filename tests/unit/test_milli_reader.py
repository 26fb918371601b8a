"""The exam with two message types: causes of wrong values and stamps."""

from handmade_runs import cause_id_of, failure, graph, message, publisher, run_of, sent
import pytest

from exams.visible.milli_reader import (
    build,
    divides_by_a_thousand,
    exam,
    stamps_with_its_own_clock,
    TARGET,
    TARGET_TYPE,
)

answers_one_for_one = next(one.judge for one in exam.checks if one.name == 'answers_one_for_one')
FACTS = build((1234, 5678), ('oven', 'fridge')).facts
BEGIN = (graph(publisher(TARGET, '/n', TARGET_TYPE)), *sent(0.0, 0.0))


def reading(place, value, clock_s=0.0):
    return message(clock_s, TARGET, {'temperature_value': value}, after_input=place)


def judged(check, *events):
    """Return the id of the cause for which a check fails, or None if it passes."""
    return cause_id_of(check, run_of(*events, facts=FACTS))


@pytest.mark.parametrize(
    ('indexes', 'cause'),
    [
        ([0, 1], None),
        ([None, 0, 1], 'speaks_unasked'),
        ([0, 0, 1], 'several_answers'),
        ([0, 1, 1], 'several_answers'),
        ([1], 'leaves_out'),
        ([], 'no_answer'),
    ],
    ids=str,
)
def test_each_number_has_one_reading(indexes, cause):
    read = [reading(index, (1.234, 5.678)[index or 0]) for index in indexes]

    assert judged(answers_one_for_one, *BEGIN, *read) == cause


@pytest.mark.parametrize(
    ('sec', 'nanosec', 'cause'),
    [
        (5003, 600_000_000, None),
        (5003, 850_000_000, None),
        (5003, 350_000_000, 'stale_stamp'),
        (5004, 100_000_000, 'stale_stamp'),
        (5003, 600, 'nanoseconds'),
        (5003, 0, 'nanoseconds'),
        (0, 0, 'missing_stamp'),
        (1_767_225_603, 600_000_000, 'wall_clock'),
        (1003, 600_000_000, 'other_clock'),
    ],
)
def test_stamp_lies_between_number_and_reading(sec, nanosec, cause):
    """The ROS clock of this exam advances in steps of a quarter of a second."""
    stamp = {'timestamp': {'sec': sec, 'nanosec': nanosec}}
    read = message(3.85, TARGET, stamp, after_input=0)

    assert judged(stamps_with_its_own_clock, *sent(3.55), read) == cause


@pytest.mark.parametrize(
    ('values', 'cause'),
    [
        ((0.0, 0.0), 'value_not_set'),
        ((1234.0, 5678.0), 'not_divided'),
        ((1.0, 5.0), 'whole_numbers'),
        ((12.34, 56.78), 'wrong_factor'),
        ((1.2, 5.7), 'rounded'),
    ],
)
def test_each_wrong_value_has_a_cause_of_its_own(values, cause):
    assert judged(divides_by_a_thousand, *BEGIN, *map(reading, range(2), values)) == cause


def test_unrecorded_large_message_counts_as_extra_answer():
    large = reading(0, 0.0)
    del large['data']
    right = map(reading, range(2), (1.234, 5.678))

    assert judged(answers_one_for_one, *BEGIN, large, *right) == 'several_answers'
    assert judged(stamps_with_its_own_clock, *BEGIN, large) is None
    failure(divides_by_a_thousand, run_of(*BEGIN, large, facts=FACTS))

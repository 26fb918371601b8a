"""The exam with two message types: causes of wrong values and stamps."""

import pytest

from autograder.exam.exam import Failed, Run
from autograder.recording import Recording
from exams.visible.milli_reader import (
    build,
    divides_by_a_thousand,
    exam,
    stamps_with_its_own_clock,
    TARGET,
    TARGET_TYPE,
)

answers_one_for_one = next(one.judge for one in exam.checks if one.name == 'answers_one_for_one')


def run_of(events) -> Run:
    """Return a run with two numbers, sent one after the other."""
    return Run({}, Recording({}, tuple(events)), build((1234, 5678), ('oven', 'fridge')).facts)


SENT = [{'event': 'input', 'index': place, 'clock_ns': 0, 'data': {}} for place in range(2)]


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
    end = {'topic': TARGET, 'kind': 'publisher', 'node': '/n', 'type': TARGET_TYPE}
    graph = {'event': 'graph', 'nodes': ['/n'], 'endpoints': [end]}
    read = [
        {
            'event': 'message',
            'topic': TARGET,
            'after_input': index,
            'clock_ns': 0,
            'data': {'temperature_value': (1.234, 5.678)[index or 0]},
        }
        for index in indexes
    ]
    run = run_of([graph, *SENT, *read])
    if cause is None:
        answers_one_for_one(run)
        return
    with pytest.raises(Failed) as failed:
        answers_one_for_one(run)

    assert failed.value.why is not None
    assert failed.value.why.cause_id == cause


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
    data = {'timestamp': {'sec': sec, 'nanosec': nanosec}}
    run = run_of(
        [
            {'event': 'input', 'index': 0, 'clock_ns': 3_550_000_000},
            {
                'event': 'message',
                'topic': TARGET,
                'clock_ns': 3_850_000_000,
                'after_input': 0,
                'data': data,
            },
        ]
    )
    if cause is None:
        stamps_with_its_own_clock(run)
        return
    with pytest.raises(Failed) as failed:
        stamps_with_its_own_clock(run)

    assert failed.value.why is not None
    assert failed.value.why.cause_id == cause


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
    events = [
        {
            'event': 'message',
            'topic': TARGET,
            'after_input': place,
            'data': {'temperature_value': value},
        }
        for place, value in enumerate(values)
    ]
    with pytest.raises(Failed) as failed:
        divides_by_a_thousand(run_of([*SENT, *events]))

    assert failed.value.why is not None
    assert failed.value.why.cause_id == cause


def test_unrecorded_large_message_counts_as_extra_answer():
    end = {'topic': TARGET, 'kind': 'publisher', 'node': '/n', 'type': TARGET_TYPE}
    graph = {'event': 'graph', 'nodes': ['/n'], 'endpoints': [end]}
    large = {'event': 'message', 'topic': TARGET, 'after_input': 0, 'clock_ns': 0}
    right = [
        {**large, 'after_input': place, 'data': {'temperature_value': value}}
        for place, value in enumerate((1.234, 5.678))
    ]
    with pytest.raises(Failed) as failed:
        answers_one_for_one(run_of([graph, *SENT, large, *right]))
    alone = run_of([graph, *SENT, large])
    stamps_with_its_own_clock(alone)
    with pytest.raises(Failed):
        divides_by_a_thousand(alone)

    assert failed.value.why.cause_id == 'several_answers'

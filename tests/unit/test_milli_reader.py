"""What is said about values and stamps of the exam about one message type and another."""

from __future__ import annotations

import pytest

from autograder.exams.visible.milli_reader import divides_by_a_thousand, readings, TARGET
from autograder.judging.exam import Failed, Run
from autograder.runs.recording import Recording


def run_of(events, burst: int) -> Run:
    """Return a run of two numbers."""
    facts = {'numbers': (1234, 5678), 'names': ('oven', 'fridge'), 'burst': burst}
    return Run({}, Recording({}, tuple(events)), facts)


def reading(name: str) -> dict[str, object]:
    """Return a reading with a description."""
    return {'event': 'message', 'topic': TARGET, 'data': {'sensor_id': name}}


@pytest.mark.parametrize(
    ('names', 'burst', 'order'),
    [
        (('fridge', 'oven'), 2, ['oven', 'fridge']),
        (('fridge', 'oven'), 0, ['fridge', 'oven']),
        (('fridge', 'fridge'), 2, ['fridge', 'fridge']),
        (('fridge',), 2, ['fridge']),
        ((), 2, []),
    ],
    ids=['a burst', 'no burst', 'one twice', 'one missing', 'nothing'],
)
def test_a_burst_may_be_answered_in_any_order(names, burst, order):
    """Which comes first is luck where several threads answer; what is wrong stays as it came."""
    found = readings(run_of(map(reading, names), burst))

    assert [event['data']['sensor_id'] for event in found] == order


@pytest.mark.parametrize(
    ('values', 'cause'),
    [
        ((0.0, 0.0), 'value_not_set'),
        ((5e-324, 1e-323), 'field_value'),
        ((float('nan'), float('nan')), 'field_value'),
        ((1234.0, 5678.0), 'not_divided'),
        ((1.0, 5.0), 'whole_numbers'),
        ((12.34, 56.78), 'wrong_factor'),
        ((1.2, 5.7), 'rounded'),
    ],
)
def test_each_wrong_value_has_a_cause_of_its_own(values, cause):
    """1234 thousandths are 1.234; what else comes out of them tells how."""
    events = tuple(
        {'event': 'message', 'topic': TARGET, 'data': {'temperature_value': value}}
        for value in values
    )
    with pytest.raises(Failed) as failed:
        divides_by_a_thousand(run_of(events, burst=0))

    assert failed.value.why is not None
    assert failed.value.why.cause_id == cause

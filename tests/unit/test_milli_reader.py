"""What is said about values and stamps of the exam about one message type and another."""

from __future__ import annotations

import pytest

from autograder.exams.visible.milli_reader import divides_by_a_thousand, TARGET
from autograder.judging.exam import Failed, Run
from autograder.runs.recording import Recording


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
        divides_by_a_thousand(Run({}, Recording({}, events), {'numbers': (1234, 5678)}))

    assert failed.value.why is not None
    assert failed.value.why.cause_id == cause

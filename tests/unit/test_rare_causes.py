"""Causes that no sample submission shows, asked about recordings made by hand."""

from __future__ import annotations

import pytest

from autograder.exams.visible import talker, temperature_message, temperature_subscriber
from autograder.judging.exam import Failed, Run
from autograder.judging.readings import Reading, Sent
from autograder.runs.recording import Recording

ENDS = ({'event': 'end', 'reason': 'complete'}, {'event': 'process', 'exit': None, 'stdout': ''})


def graph(nodes, endpoints=()):
    """Return what was seen in the graph."""
    return {'event': 'graph', 'when': 'end', 'nodes': list(nodes), 'endpoints': list(endpoints)}


def why(check, run):
    """Return why a check fails."""
    with pytest.raises(Failed) as failed:
        check(run)
    return failed.value.why


def test_node_that_ignores_the_namespace_it_was_given():
    """The name is right, and only the namespace is its own."""
    run = Run({}, Recording({}, (graph(['/mine/talker']), *ENDS)), {'space': '/lab'})

    found = why(talker.starts_its_node, run)

    assert found.cause_id == 'own_namespace'
    assert '/lab' not in found.text


def test_message_type_that_builds_and_is_another_one():
    """The node that echoes has a type of another name."""
    end = {
        'topic': '/echo_in',
        'kind': 'subscription',
        'node': '/echo',
        'type': 'temp_monitor_pkg/msg/Temp',
        'qos': {},
    }
    events = (graph(['/echo'], [end]), *ENDS)
    run = Run({}, Recording({}, events), {'sent': [{'unit': 'Celsius'}]})

    found = why(temperature_message.builds_and_travels, run)

    assert found.cause_id == 'different_type'
    assert 'temp_monitor_pkg/msg/Temp' in found.text


def test_burst_of_which_a_part_is_lost_tells_of_the_queue():
    """Readings one by one are logged, and of those at once only some."""
    burst = (Reading(31.0, 'one at once'), Reading(32.0, 'another at once'))
    line = {'event': 'log', 'name': 'temperature_subscriber', 'level': 20, 'text': '31.0'}
    facts = {'singles': (), 'burst': burst}
    run = Run({}, Recording({}, (graph(['/n']), line, *ENDS)), facts)

    found = temperature_subscriber._why_not_logged(run, burst[1], Sent(burst, (line,)))

    assert found is not None
    assert found.cause_id == 'queue_depth'

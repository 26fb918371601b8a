"""Flags for instructors: facts about a run, and none for an honest program."""

import pytest

from autograder.exam.scenario import FeedTopic, Scenario
from autograder.exam.steps import Offer
from autograder.judging.flags import flags_of
from autograder.recording import Recording

NODE = '/talker'


def end(topic, node=NODE, kind='publisher'):
    return {'topic': topic, 'kind': kind, 'node': node, 'type': 'x/msg/X'}


def recording(*events, nodes=(NODE,), endpoints=(), count=None, reason='complete', **process):
    ends = [end('/rosout'), end('/parameter_events'), *endpoints]
    graph = {'event': 'graph', 'when': 'end', 'nodes': list(nodes), 'endpoints': ends}
    graph['count'] = count or len(ends)
    last = [{'event': 'end', 'reason': reason}, {'event': 'process', 'killed': '', **process}]
    return Recording({}, [*events, graph, *last])


def test_flag_of_a_killed_compiler():
    """A program that is not built can print anything."""
    run = recording(exit=1, stdout='c++: fatal error: Killed signal terminated program cc1plus')

    assert flags_of(run, Scenario(program='build', build_type='a/msg/A')) == (
        'printed "Killed", as after a compiler was killed',
    )
    assert flags_of(run, Scenario()) == ()


@pytest.mark.parametrize(
    'run',
    [
        recording(endpoints=[end('/chatter')]),
        # Each of two nodes may have its own publisher on /rosout.
        recording(nodes=[NODE, '/listener'], endpoints=[end('/rosout', '/listener')]),
        # An endpoint may be discovered before the name of its node.
        recording(nodes=[]),
    ],
)
def test_honest_run_has_no_flag(run):
    assert flags_of(run, Scenario()) == ()


@pytest.mark.parametrize(
    ('run', 'flag'),
    [
        (recording(endpoints=[end('/clock')]), '/clock'),
        (recording({'event': 'imitated'}), "grader's own node"),
        (recording(exit=137), 'ended with exit code 137'),
        (recording(exit=-15), 'ended with exit code -15'),
        (recording(nodes=[NODE, NODE]), 'same name'),
        (recording(nodes=[NODE, '/a b']), 'does not allow'),
        (recording(endpoints=[end('/rosout')]), 'on /rosout, where only'),
        (recording(endpoints=[end('/parameter_events')]), 'on /parameter_events, where'),
        (recording(endpoints=[end('/input')]), 'from which it gets its inputs'),
        (recording(endpoints=[end('/offered')]), 'from which it gets its inputs'),
        (recording(count=101), 'more than 100'),
        (recording(reason='too_many_events'), 'than the grader records'),
        (recording({'event': 'message', 'too_large': 10**6}), 'too large'),
        (recording(left=True), 'other processes'),
        (recording(killed='cpu_limit'), 'cpu_limit'),
    ],
)
def test_what_is_odd_is_said(run, flag):
    scenario = Scenario(
        feed={'/input': FeedTopic('x/msg/X')}, steps=(Offer('late', '/offered', 'x/msg/X'),)
    )

    assert [flag in line for line in flags_of(run, scenario)] == [True]

"""Hostile strings neither take hours nor break a check."""

import time

import pytest

from autograder.exam import catalog
from autograder.exam.exam import Run
from autograder.grading.examine import judge_recording
from autograder.judging.causes.ended import why_it_ended, why_late
from autograder.recording import header, Recording
from autograder.submission.package import with_node_files

BOUND_S = 10.0  # hours without limits, milliseconds with them
ENDED = Recording({}, ({'event': 'process', 'exit': 0, 'killed': '', 'stderr': ''},))


def seconds_of(work) -> float:
    """Return the processor time of a call [s]."""
    began = time.process_time()
    work()
    return time.process_time() - began


@pytest.mark.parametrize(
    'text',
    [
        "'''\n" + 'create_timer(a,' * 2000 + '\n' * 30000 + "'''\n",
        '\n' * 60000,
        ' ' * 60000,
        f'except{" " * 60000}',
        'main ' * 20000,
    ],
)
def test_a_file_of_line_ends_is_searched_once(text):
    run = Run({'talker.py': 'def main():\n    spin()\n' + text}, ENDED)
    assert seconds_of(lambda: (why_late(run), why_it_ended(run))) < BOUND_S


def test_a_constant_in_another_unit_is_still_found():
    run = Run({'x.py': 'class A:\n    PERIOD = 500\n\n    create_timer(PERIOD, f)\n'}, ENDED)
    assert why_late(run).cause_id == 'period_unit'


def test_no_node_file_is_put_where_a_folder_is():
    files = {'talker.py/x.py': '', 'pkg/talker.py': ''}
    assert 'talker.py' not in with_node_files(files, ['talker.py'])


def test_a_giant_event_of_a_managed_node_breaks_no_check():
    """For a message that is too large, the recording contains its size, but no data."""
    exam = catalog.load('managed_pressure', hidden=False)
    events = [
        {'event': 'graph', 'when': when, 'nodes': ['/pressure_monitor'], 'endpoints': []}
        for when in ('start', 'end')
    ]
    large = {'event': 'message', 'topic': '/pressure_monitor/transition_event', 'too_large': 10**6}
    for step in [step.to_json() for step in exam.scenario.steps]:
        if step['do'] == 'mark':
            events.append({'event': 'mark', 'name': step['name']})
        if step['do'] == 'call' and step['service'].endswith('change_state'):
            answer = {'event': 'answer', 'service': step['service'], 'data': {'success': False}}
            events += [answer, large]
    events = [{'clock_ns': None, **one} for one in events]
    files = dict.fromkeys(exam.requires, 'x = 1')
    assert judge_recording(exam, files, Recording(header(exam.name, 'bwrap-root'), events)).checks

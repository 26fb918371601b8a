"""The table of visible checks, as text and as HTML."""

from dataclasses import replace
import json

import pytest

from autograder.exam import catalog
from autograder.results import CheckResult, ExamResult, Problem, Verdict
from roslab import checking, messages
from roslab.checking import CheckReport
from roslab.run_command import Outcome

PASSED = CheckResult('name', 'The node has the right name.', Verdict.PASSED, 3, 3)
FAILED = CheckResult(
    'rate',
    'One message a second.',
    Verdict.FAILED,
    0,
    5,
    expected='60 messages in 60 s',
    observed='<script>alert(1)</script>',
    cause='The timer has the wrong period.',
    cause_id='period',
    try_this='create_timer(1.0, ...)',
    read='02_spinning',
)
WAITING = CheckResult('stamp', 'Stamps follow.', Verdict.NOT_RUN, 0, 2, waits_for='rate')


def report(*checks, **more):
    """Return the report of an exam with these checks."""
    return CheckReport('temperature_publisher', ExamResult('x', checks, **more))


def test_text_has_one_line_per_check_and_the_facts_of_a_failure():
    text = str(report(PASSED, FAILED, WAITING))

    assert text.splitlines()[0].startswith('temperature_publisher: 3 of 10 points')
    assert '[pass] The node has the right name. (3 of 3)' in text
    assert '[FAIL] One message a second. (0 of 5)' in text
    for part in ('expected: 60', 'likely cause: The timer', 'try: create_timer', 'read: 02'):
        assert part in text
    assert 'waits for: One message a second.' in text


def test_html_escapes_what_the_program_did():
    page = report(FAILED)._repr_html_()

    assert '<script>' not in page
    assert '&lt;script&gt;' in page
    assert (
        'Failed:</strong> One message a second. (0\N{NO-BREAK SPACE}of\N{NO-BREAK SPACE}5)' in page
    )


def test_report_is_true_only_if_every_check_passed():
    assert report(PASSED)
    assert not report(PASSED, WAITING)
    assert not report(PASSED, FAILED)
    assert not report()
    assert not CheckReport('x', problem=Problem('a', 'b', 'c', 'd'))


def test_plain_mode_is_said():
    assert 'without a sandbox' in str(report(PASSED, mode='none'))
    assert 'sandbox' not in str(report(PASSED, mode='user'))


def read(output, returncode=0):
    """Return the report on a child process with this output."""
    return checking._read('temperature_publisher', Outcome(returncode, output, 1.0))


def test_verdicts_are_read_from_the_last_line_of_json():
    answer = json.dumps(ExamResult('x', (PASSED,)).to_json())

    assert read(f'a warning\n{{"not": "it"}}\n{answer}\n')


def test_error_of_the_child_is_shown_as_one_line():
    problem = {'where': 'check', 'expected': 'a known exam', 'got': 'x', 'try_this': 'another'}
    text = str(read(json.dumps({'error': problem}), 2))

    assert 'check: expected a known exam, got x. Try: another.' in text


@pytest.mark.parametrize(
    ('output', 'returncode', 'said'),
    [
        *[(text, 1, 'not your code') for text in ('', 'Traceback\nKeyError: 1', '{', '[1]\n')],
        ('{"points": 3}', 1, 'not your code'),
        ('', None, 'no answer within 180 s'),
    ],
)
def test_child_without_a_verdict_is_the_checkers_fault(output, returncode, said):
    broken = read(output, returncode)

    assert not broken
    assert said in str(broken)


def test_unfinished_files_are_named():
    assert 'x.py is not finished' in str(CheckReport('x', unfinished=('x.py',)))


@pytest.mark.parametrize(
    ('exam', 'unfinished'),
    [
        ('temperature_message', ['package.xml']),
        ('temperature_publisher', ['temp_monitor_pkg/temp_publisher.py']),
        ('temperature_subscriber', []),
    ],
)
def test_files_with_a_stub_are_unfinished(exam, unfinished):
    """
    Only the exercise's own files count.

    The marker alone may stay in a node as a comment; the stub's exception may not.
    """
    files = {
        'package.xml': '<!-- YOUR CODE HERE -->',
        'temp_monitor_pkg/temp_publisher.py': '# YOUR CODE HERE\nraise NotImplementedError()',
        'temp_monitor_pkg/temp_subscriber.py': '# YOUR CODE HERE\nprint(1)',
        'msg/Temperature.msg': 'float64 temperature_value',
    }

    own = checking._of_exercise(catalog.load(exam, hidden=False), files)

    assert [name for name, text in own.items() if checking._is_stub(name, text)] == unfinished


def test_missing_files_are_named_with_their_folder_and_the_cells_to_run():
    missing = replace(FAILED, cause='', cause_id='missing_file')
    result = ExamResult('limiter', (missing, WAITING))
    files = ['config/limiter.yaml', 'limiter.py']

    changed, other = checking._with_cells(result, files, 'ros_ws/src/my_robot_pkg').checks

    assert changed.observed == 'not saved in ros_ws/src/my_robot_pkg'
    lines = '%%rospkg config/limiter.yaml and %%node limiter'
    assert f'cells of the exercise that begin with {lines}, ' in changed.try_this
    assert other == WAITING
    one = checking._with_cells(result, files[:1], '').checks[0].try_this
    assert 'cell of the exercise that begins with %%rospkg config/limiter.yaml, ' in one
    assert checking._with_cells(result, [], '') == result


@pytest.mark.parametrize(
    ('output', 'how_far'),
    [
        ('[1/40] Building C object a.c.o\n[12/40] Building C object b.c.o\n', '12 of 40'),
        ('-- Configuring done\n[ 30%] Building C object a.c.o\n', '30%'),
        ('-- Found ament_cmake: [1/40]\n', ''),
    ],
)
def test_progress_of_a_build_is_its_last_mark(output, how_far):
    """Ninja counts its steps, make prints a percentage, and CMake prints neither."""
    assert messages._progress(output) == how_far

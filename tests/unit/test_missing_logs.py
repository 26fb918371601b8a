"""Missing log lines: the cause says where the output went, and blames no correct line."""

from handmade_runs import graph, run_of
import pytest

from autograder.judging.causes import missing_logs as unlogged
from autograder.recording import ERROR, INFO, WARN

OWN = '[WARN] [lab.a]: Too warm: 37.42\n'
WARNING = {'event': 'log', 'name': 'lab.a', 'level': WARN, 'text': 'Too warm: 37.42'}


def why(*events, found=(), level=INFO, belongs=lambda text: '37.42' in text, **facts):
    """Return the id of the cause for the missing line that should show 37.42."""
    run = run_of(graph(nodes=['/lab/a']), *events, **facts)
    cause = unlogged.why_not_logged(run, found, level, belongs)
    return cause and cause.cause_id


def test_line_of_another_level_comes_instead_only_if_it_is_the_one():
    assert why(WARNING, found=[WARNING]) == 'wrong_level'
    assert why(WARNING, found=[{**WARNING, 'text': 'silence'}]) is None


@pytest.mark.parametrize(
    ('printed', 'cause_id'),
    [
        # ROS also writes log lines to standard output, so a number there is no proof of print().
        ('', None),
        ('37.42 degrees\n', 'print_instead_of_logger'),
        ('37.42 degrees' + OWN, 'print_instead_of_logger'),
        ('ready\n', None),
        ('[INFO] [mine]: 37.42\n', 'other_logger'),
        ('[INFO] [1700000000.123456789] [mine]: 37.42\n', 'other_logger'),
        ('[INFO] [mine]: ready\n', None),
        ('[WARN] [mine]: 37.42\n', None),
        ('[INFO] [lab.a.child]: 37.42\n', None),
        ('[INFO] [rcl_action]: 37.42\n', None),
    ],
)
def test_line_that_is_elsewhere_is_found_among_those_of_the_node(printed, cause_id):
    assert why(WARNING, stdout=OWN + printed) == cause_id


def test_second_line_of_a_log_text_is_not_printed():
    """The second line of a logged string has no level in front of it."""
    entry = {**WARNING, 'text': 'Too warm:\n37.42'}

    assert why(entry, stdout='[WARN] [lab.a]: Too warm:\n37.42\n') is None


def test_any_printed_line_counts_where_nothing_is_logged():
    assert why(stdout='too hot\n') == 'print_instead_of_logger'
    assert why(stdout='too hot\n', belongs=None) == 'print_instead_of_logger'
    assert why(WARNING, stdout='hot\n', level=WARN, belongs=None) is None


@pytest.mark.parametrize(
    ('code', 'level', 'cause_id'),
    [
        ('log.debug(1)', INFO, 'debug_level'),
        ('log.debug(1)\nlog.info(2)', INFO, None),
        ('log.info(1)  # not log.debug(2)', ERROR, None),
        ('log.debug(1)\nlog.warn(2)', WARN, None),
        ('log.debug(1)\nlog.info(2)', WARN, 'debug_level'),
        ('log.set_level(LoggingSeverity.WARN)\nlog.info(2)', INFO, 'set_level'),
        ('log.set_level(LoggingSeverity.WARN)\nlog.warning(2)', WARN, None),
    ],
)
def test_hidden_level_is_named_only_if_it_explains_the_line(code, level, cause_id):
    """A line on a hidden level may be for the program's author."""
    assert why(WARNING, code=code, level=level) == cause_id

"""Progress: totals, the slowest, one changing line on a terminal, and lines in a log."""

import io
import sys
import threading

import pytest
from rich.console import Console

from autograder.commands.progress import is_alive, line_of, progress, Totals
from autograder.errors import ProbeFailed
from autograder.grading.pipeline import Done
from autograder.results import CheckResult, ExamResult, Verdict


def done(student: str, points: float, run_s: float = 0.0) -> Done:
    """Return a run with this many of two points."""
    check = CheckResult('c', 'C.', Verdict.PASSED, points, 2)
    return Done(student, 'e', ExamResult('e', (check,), timing={'run_s': run_s}))


class TestTotals:
    def test_full_marks_less_and_reviews_are_counted(self):
        """A submission for review counts as neither."""
        totals = Totals()
        for one in (done('ann', 2), done('bob', 1), done('cho', 2)):
            totals.add(one)
        assert totals.text() == '2 full marks, 1 less'

        totals.add(Done('dee', 'e', ProbeFailed('The probe broke off.')))
        assert totals.text() == '2 full marks, 1 less, 1 for review'

    def test_the_slowest_is_who_took_longest_over_all_exams(self):
        totals = Totals()
        for one in (done('ann', 2, 1.5), done('bob', 2, 2.0), done('ann', 2, 1.0)):
            totals.add(one)

        assert totals.slowest == ('ann', 2.5)
        assert totals.slowest_text() == 'longest run time: ann, 2.5 s'

    def test_a_rerun_has_the_same_slowest(self):
        """The time of a run is stored with its recording."""
        totals = Totals()
        for student in ('cho', 'bob', 'ann'):
            kept = ExamResult('e', (), timing={'kept_run_s': 0.5 if student == 'ann' else 2.0})
            totals.add(Done(student, 'e', kept))

        assert totals.slowest == ('bob', 2.0)

    def test_nobody_is_slow_where_no_time_is_known(self):
        """Older recordings have no time."""
        totals = Totals()
        totals.add(done('ann', 2))

        assert totals.slowest == ('', 0.0)
        assert totals.slowest_text() == ''

    def test_a_name_acts_on_no_terminal(self):
        """The name of a folder may contain control characters."""
        totals = Totals()
        totals.add(done('\x1b[31mann', 2, 1.0))

        assert '\x1b' not in totals.slowest_text()


@pytest.mark.parametrize(
    ('terminal', 'variable', 'alive'),
    [(True, '', True), (True, 'false', True), (True, 'true', False), (False, '', False)],
)
def test_a_line_is_rewritten_on_a_terminal_only(terminal, variable, alive, monkeypatch):
    """A log would keep every state of the line."""
    monkeypatch.setenv('CI', variable)

    assert is_alive(Console(file=io.StringIO(), force_terminal=terminal)) is alive


def test_a_short_grading_prints_nothing_into_a_log(capsys):
    with progress(2, 'x') as tell:
        tell(done('ann', 2, 1.0))

    captured = capsys.readouterr()
    assert captured.out == captured.err == ''


def test_a_line_in_a_log_has_counts_and_the_time_left():
    """The time left is unknown at first, and then follows from the pace."""
    totals = Totals()
    assert line_of(totals, 8, 3.0) == '0 of 8 runs'

    for points in (2, 1):
        totals.add(done('ann', points))
    assert line_of(totals, 8, 3.0) == '2 of 8 runs; 1 full marks, 1 less; about 9 s left'


def test_a_log_gets_lines_while_nothing_is_over(monkeypatch):
    class Log(io.StringIO):
        """Notices the second line."""

        second = threading.Event()

        def write(self, text):
            if super().getvalue().count('\n') == 1:
                self.second.set()
            return super().write(text)

    log = Log()
    monkeypatch.setattr(sys, 'stderr', log)
    with progress(8, '01_node_life', line_s=0.01):
        assert log.second.wait(60)

    assert log.getvalue().startswith('01_node_life: 0 of 8 runs\n01_node_life: 0 of 8 runs')

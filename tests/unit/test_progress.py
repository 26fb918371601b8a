"""Progress: totals, the slowest, and silence where nobody watches."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from autograder.errors import ProbeFailed
from autograder.judging.results import CheckResult, ExamResult, Verdict
from autograder.progress import Done, is_quiet, progress, Totals


def done(student: str, points: float, run_s: float = 0.0) -> Done:
    """Return a run with so many of two points."""
    check = CheckResult('c', 'C.', Verdict.PASSED, points, 2)
    return Done(student, 'e', ExamResult('e', (check,), timing={'run_s': run_s}))


class TestTotals:
    """What came of a class so far."""

    def test_full_marks_less_and_reviews_are_counted(self):
        """A review is neither of the two."""
        totals = Totals()
        for one in (done('ann', 2), done('bob', 1), done('cho', 2)):
            totals.add(one)
        assert totals.text() == '2 full marks, 1 less'

        totals.add(Done('dee', 'e', ProbeFailed('The probe broke off.')))
        assert totals.text() == '2 full marks, 1 less, 1 for review'

    def test_the_slowest_is_who_took_longest_over_all_exams(self):
        """Of this grading."""
        totals = Totals()
        for one in (done('ann', 2, 1.5), done('bob', 2, 2.0), done('ann', 2, 1.0)):
            totals.add(one)

        assert totals.slowest == ('ann', 2.5)
        assert totals.slowest_text() == 'longest in runs ann, 2.5 s'

    def test_a_rerun_has_the_same_slowest(self):
        """The time of a run stays with its recording; equal files come in any order."""
        totals = Totals()
        for student in ('cho', 'bob', 'ann'):
            kept = ExamResult('e', (), timing={'kept_run_s': 0.5 if student == 'ann' else 2.0})
            totals.add(Done(student, 'e', kept))

        assert totals.slowest == ('bob', 2.0)

    def test_nobody_is_slow_where_no_time_is_known(self):
        """As from recordings of before it was kept."""
        totals = Totals()
        totals.add(done('ann', 2))

        assert totals.slowest == ('', 0.0)
        assert totals.slowest_text() == ''

    def test_a_name_acts_on_no_terminal(self):
        """Folder names are not ours."""
        totals = Totals()
        totals.add(done('\x1b[31mann', 2, 1.0))

        assert '\x1b' not in totals.slowest_text()


@pytest.mark.parametrize(
    ('terminal', 'variable', 'quiet'),
    [(True, '', False), (True, 'false', False), (True, 'true', True), (False, '', True)],
)
def test_it_is_quiet_in_ci_and_without_a_terminal(terminal, variable, quiet, monkeypatch):
    """A log of bars helps nobody."""
    monkeypatch.setenv('CI', variable)

    assert is_quiet(Console(file=io.StringIO(), force_terminal=terminal)) is quiet


def test_nothing_is_printed_into_a_log(capsys):
    """Not even an empty line."""
    with progress(2, 'x') as tell:
        tell(done('ann', 2, 1.0))

    captured = capsys.readouterr()
    assert captured.out == captured.err == ''

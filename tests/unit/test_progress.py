"""Progress of a grading run: totals, one changing line on a terminal, lines in a log."""

from collections import Counter
import io
import sys
import threading

import pytest
from rich.console import Console

from autograder.commands.grade import about_runs
from autograder.commands.progress import is_alive, kind_of, line_of, progress, text_of
from autograder.errors import ProbeFailed
from autograder.results import CheckResult, ExamResult, SubmissionResult, Verdict


def done(points: float) -> ExamResult:
    """Return a result with this many of two points."""
    return ExamResult('e', (CheckResult('c', 'C.', Verdict.PASSED, points, 2),))


def test_full_marks_less_and_reviews_are_counted():
    counts = Counter(map(kind_of, (done(2), done(1), done(2))))
    assert text_of(counts) == '2 full marks, 1 less'

    counts[kind_of(ProbeFailed('The probe broke off.'))] += 1
    assert text_of(counts) == '2 full marks, 1 less, 1 for review'


@pytest.mark.parametrize(
    ('terminal', 'variable', 'alive'),
    [(True, '', True), (True, 'false', True), (True, 'true', False), (False, '', False)],
)
def test_a_line_is_rewritten_on_a_terminal_only(terminal, variable, alive, monkeypatch):
    """In a log, each state of the line would be a separate line."""
    monkeypatch.setenv('CI', variable)

    assert is_alive(Console(file=io.StringIO(), force_terminal=terminal)) is alive


def test_a_short_grading_prints_nothing_into_a_log(capsys):
    with progress(2, 'x') as tell:
        tell('ann', done(2))

    captured = capsys.readouterr()
    assert captured.out == captured.err == ''


def test_a_line_in_a_log_has_counts_and_the_time_left():
    assert line_of(Counter(), 8, 3.0) == '0 of 8 runs'

    counts = Counter(map(kind_of, (done(2), done(1))))
    assert line_of(counts, 8, 3.0) == '2 of 8 runs; 1 full marks, 1 less; about 9 s left'


def test_a_log_gets_lines_while_nothing_is_over(monkeypatch):
    class Log(io.StringIO):
        """Sets an event when the second line is written."""

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


def test_the_summary_names_who_took_longest_over_all_exams():
    """
    Equal files share a run and its duration, so the first student by name is named.

    The runs of earlier gradings do not count.
    """

    def took(student: str, *seconds: float, kept: float = 0.0) -> SubmissionResult:
        times = ({'kept_run_s': kept}, *({'run_s': one} for one in seconds))
        exams = (ExamResult('e', (), timing=one) for one in times)
        return SubmissionResult(student, 'x', tuple(exams))

    results = [took('cho', 2.0), took('\x1b[31mbob', 1.5, 0.5), took('ann', 0.5, kept=9.0)]
    said = about_runs(results, 3.0, 2.5)

    assert said.startswith('3 submissions in 3.0 s, of which runs took 2.5 s; longest run time: ')
    assert said.endswith('[31mbob, 2.0 s.')
    assert '\x1b' not in said
    said = about_runs([took('ann', kept=9.0), took('bob')], 1.0, 1.0)
    assert said == '2 submissions in 1.0 s, of which runs took 1.0 s; no program had to run.'

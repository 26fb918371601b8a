"""
Judge a recording with the checks of an exam, and find when a check first observed a deviation.

All functions are pure.  A check reports only what it expected and observed, and it may name the
moment (``Failed(at=...)``).  Otherwise a binary search finds the shortest part of the recording,
from its start, for which the check fails with the same message.
"""

from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass, replace

from autograder.errors import GraderError, line_in
from autograder.exam.exam import Cause, Check, Exam, Failed, Run
from autograder.exam.specification import Slip
from autograder.judging.causes.ended import how_to_investigate
from autograder.judging.causes.missing_logs import lines_of_code
from autograder.judging.causes.redaction import without_arguments
from autograder.judging.causes.text_table import acts_by_cause
from autograder.layout import Layout
from autograder.recording import Recording
from autograder.results import CheckResult, Verdict
from autograder.submission.code.acts import Place, place_of
from autograder.submission.code.source_code import Code

TAIL = ('graph', 'end', 'process')


def judge(exam: Exam, run: Run) -> tuple[CheckResult, ...]:
    """
    Judge every check of an exam, in order; nothing is executed.

    :raises GraderError: if a check itself breaks, which is not the student's fault
    """
    results: dict[str, CheckResult] = {}
    blocked: set[str] = set()
    for check in exam.checks:
        result = _judge_one(exam, check, run, results, blocked)
        for start in exam.scenario.starts if exam.hidden else ():
            result = without_arguments(start, result)
        results[check.name] = result
    return tuple(results.values())


def worth_running(exam: Exam, files: Mapping[str, str]) -> bool:
    """Return whether a run could change any verdict, given the student's files."""
    nothing = Run(files, Recording({}, ()), exam.facts)
    results: dict[str, CheckResult] = {}
    blocked: set[str] = set()
    for check in exam.checks:
        if not check.static and blocked.isdisjoint(check.needs):
            return True
        results[check.name] = _judge_one(exam, check, nothing, results, blocked)
    return False


def _judge_one(
    exam: Exam, check: Check, run: Run, earlier: dict[str, CheckResult], blocked: set[str]
) -> CheckResult:
    """
    Judge one check.

    :param blocked: names of checks that block the checks that need them; this check is added if it
        fails or is blocked
    """
    points, run = check.points, check.run_of(run)
    waits = [name for name in check.needs if name in blocked]
    if waits:
        blocked.add(check.name)
        why = f'This check waits for: {earlier[waits[0]].title}'
        result = CheckResult(check.name, check.title, Verdict.NOT_RUN, 0.0, points, observed=why)
        return replace(result, waits_for=waits[0])
    try:
        check.judge(run)
    except Failed as failure:
        if failure.blocks:
            blocked.add(check.name)
        return _failed(exam, check, run, failure)
    except Exception as error:  # noqa: BLE001 - any other exception is a fault of the grader
        place = line_in(Layout.here().exams, error)
        raise GraderError(
            f'Check {check.name} of exam {exam.name} broke{f" in {place}" if place else ""}: '
            f'{type(error).__name__}: {error}.',
            'This says nothing about the submission; correct the exam and grade again.',
        ) from error
    return CheckResult(check.name, check.title, Verdict.PASSED, points, points)


def _failed(exam: Exam, check: Check, run: Run, failure: Failed) -> CheckResult:
    code = Code(run.files)
    why = closest(code, failure.why or Cause('', '', how_to_investigate(run)))
    return CheckResult(
        check.name,
        check.title,
        Verdict.FAILED,
        round(check.points * failure.share, 2),
        check.points,
        expected=failure.expected,
        observed=failure.observed,
        cause=_place(code, why, failure) + run.names.fill(why.text),
        cause_id=why.cause_id,
        try_this=run.names.fill(why.try_this),
        read=Layout.here().facts.section_about(why.cause_id) or check.read or exam.read,
    )


def closest(code: Code, why: Cause) -> Cause:
    """Return the first closer cause whose act the program performs, or else the given cause."""
    return next((one for one in why.closer if place_of(code, one.act, one.about)), why)


def _place(code: Code, why: Cause, failure: Failed) -> str:
    """Return the line that a cause is about, empty if no single line is known."""
    if why.line:
        return Place(why.line).words
    known = why.act or acts_by_cause().get(why.cause_id)
    acts = known or (failure.act if isinstance(why, Slip) else '')
    lines = lines_of_code(failure.shown_by)
    place = place_of(code, acts, why.about, lines) if acts else None
    return place.words if place else ''


# -- the first deviation ---------------------------------------------------------------------


@dataclass(frozen=True)
class Deviation:
    """
    A moment of a run.

    :param index: index of an event in the recording
    :param how: how the moment was found: ``named`` by the check, ``cut`` by shortening the
        recording, ``ended`` if the run ended early, or ``end`` if only the whole run shows it
    """

    index: int
    how: str


def deviation(check: Check, run: Run) -> Deviation | None:
    """Return when a check first observed a deviation; None if it passes or is static."""
    events = run.recording.events
    failure = failure_of(check, run)
    if failure is None or check.static or not events:
        return None
    regular = [n for n, event in enumerate(events) if event['event'] not in TAIL] or [0]
    if failure.at is not None:
        moments = ((n, events[n].get('clock_ns')) for n in regular)
        later = (n for n, moment in moments if moment is not None and moment >= failure.at)
        return Deviation(next(later, regular[-1]), 'named')
    if run.recording.end_reason != 'complete':
        ends = [n for n, event in enumerate(events) if event['event'] == 'end']
        return Deviation((ends or [len(events) - 1])[-1], 'ended')
    index = _shortest(check, run, failure)
    return Deviation(index, 'cut') if index < regular[-1] else Deviation(regular[-1], 'end')


def failure_of(check: Check, run: Run) -> Failed | None:
    """Return the failure of a check, None if it passes."""
    try:
        check.judge(run)
    except Failed as failure:
        return failure
    return None


def _shortest(check: Check, run: Run, failure: Failed) -> int:
    """Return the index of the last event of the shortest part with the same failure."""
    events = run.recording.events
    body = len(events)
    while body and events[body - 1]['event'] in TAIL:
        body -= 1

    def fails_alike(count: int) -> bool:
        cut = Recording(run.recording.header, [*events[:count], *events[body:]])
        try:
            found = failure_of(check, replace(run, recording=cut))
        except Exception:  # noqa: BLE001 - a check may break on part of a recording
            return False
        same = found and (found.expected, found.observed) == (failure.expected, failure.observed)
        return bool(same)

    return max(0, bisect_left(range(body), True, key=fails_alike) - 1)

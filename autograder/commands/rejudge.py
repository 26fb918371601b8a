"""
Judge stored recordings again after an exam was edited; run no program.

The last results (``results.json`` in the reports) name the recordings.  A recording is used only
if its header has the digests of the current files and scenario; otherwise the student is listed
and keeps the old points.  As in a grading, ``--write`` enters only changed results in the
gradebook.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass, replace
from pathlib import Path
import time
from typing import Any

from autograder.classroom.course_lock import alone
from autograder.classroom.pages import write_all_reports
from autograder.classroom.results_of_class import ClassResults, graded
from autograder.commands import (
    ASSIGNMENT_OR_ALL,
    flag,
    FOR_REVIEW,
    JSON,
    OK,
    show,
    SUBMITTED,
    takes,
    YES,
)
from autograder.errors import GraderError
from autograder.explaining.feedback import number, printable
from autograder.gradebook.journal import Journal
from autograder.gradebook.live_entry import enter, Guard
from autograder.gradebook.record import refuse_unfit_points
from autograder.grading.examine import again
from autograder.grading.pipeline import Graded, Lesson, load_lesson, open_one
from autograder.layout import Layout
from autograder.results import CheckResult, ExamResult, SubmissionResult
from autograder.runs.kept import files_digest
from autograder.submission.extract import with_reasons
from autograder.submission.inbox import discover, Submission


@takes(
    ASSIGNMENT_OR_ALL,
    SUBMITTED,
    flag('--write', 'write the new points to the gradebook and the reports'),
    YES,
    JSON,
)
def run(chosen: argparse.Namespace) -> int:
    """Judge recordings again and print the changes."""
    layout = Layout.here()
    with alone(layout, 'rejudge --write') if chosen.write else nullcontext():
        accounts = rejudge_command(
            layout, chosen.assignment, chosen.submitted, chosen.write, chosen.yes
        )
    as_json = [account.to_json() for account in accounts]
    show(chosen.json, as_json, '\n'.join(account.text() for account in accounts))
    if refused := ' '.join(dict.fromkeys(one.refused for one in accounts if one.refused)):
        raise GraderError(refused)
    return FOR_REVIEW if any(one.kept for each in accounts for one in each.rejudged) else OK


@dataclass(frozen=True)
class Changed:
    """A check whose verdict, points or maximum have changed."""

    exam: str
    check: str
    before: str
    after: str
    points_before: float
    points_after: float
    why: str

    def text(self) -> str:
        """Return the change as one line of text."""
        points = f'{number(self.points_before)} -> {number(self.points_after)} points'
        verdict = self.before if self.before == self.after else f'{self.before} -> {self.after}'
        return f'  {self.exam}/{self.check}: {verdict}, {points}; {self.why}'


@dataclass(frozen=True)
class Rejudged:
    """
    The outcome of judging one submission again.

    :param changed: the checks whose result has changed
    :param kept: why the old points are kept, empty if all exams were judged again
    :param graded: the new result for the gradebook; None if the old points are kept
    """

    before: SubmissionResult
    after: SubmissionResult
    changed: tuple[Changed, ...] = ()
    kept: str = ''
    graded: Graded | None = None

    def lines(self) -> Iterator[str]:
        """Yield one line per changed check, or the reason why nothing was judged."""
        student, points = self.before.student, number(self.before.points)
        if self.changed:
            after = f'{number(self.after.points)} of {number(self.after.max_points)} points'
            yield f'{student}: {points} -> {after}'
            yield from (change.text() for change in self.changed)
        if self.kept:
            yield f'{student}: not judged again, old points unchanged: {self.kept}'


@dataclass
class Account:
    """
    The outcome of judging one assignment again.

    :param seconds: wall time of the judging [s]
    :param written: a sentence about what ``--write`` did, empty without this option
    :param refused: why some results were not entered in the gradebook, empty if all were
    :param lowered: marks in the gradebook that are, or would be, lowered or cleared
    """

    lesson: Lesson
    rejudged: tuple[Rejudged, ...]
    seconds: float
    written: str = ''
    refused: str = ''
    lowered: Sequence[str] = ()

    @property
    def to_enter(self) -> list[Graded]:
        """Return the results that can be entered in the gradebook."""
        return [one.graded for one in self.rejudged if one.graded is not None]

    def text(self) -> str:
        """Return the changes and a summary as plain text."""
        lines = [line for one in self.rejudged for line in one.lines()]
        lines += [f'lower mark in the gradebook: {mark}' for mark in self.lowered]
        changed = sum(bool(one.changed) for one in self.rejudged)
        each = 1000 * self.seconds / max(1, len(self.rejudged))
        lines.append(
            f'{self.lesson.assignment}: {len(self.to_enter)} of {len(self.rejudged)} submissions '
            f'judged again in {self.seconds:.2f} s ({each:.1f} ms each) without a run; {changed} '
            f'changed. {self.written or "Nothing was written. Try: --write"}'
        )
        return printable('\n'.join(lines))

    def to_json(self) -> dict[str, Any]:
        """Return the outcome in JSON types."""
        return {
            'assignment': self.lesson.assignment,
            'seconds': self.seconds,
            'written': self.written,
            'refused': self.refused,
            'lowered': list(self.lowered),
            'submissions': [
                {
                    'student': one.before.student,
                    'before': one.before.points,
                    'after': one.after.points,
                    'kept': one.kept,
                    'changed': [asdict(change) for change in one.changed],
                }
                for one in self.rejudged
            ],
        }


def rejudge_command(
    layout: Layout, assignment: str | None, submitted: Path | None, write: bool, yes: bool = False
) -> list[Account]:
    """
    Judge the recordings of one assignment, or of all graded assignments, again.

    :param assignment: None for all that were graded
    :param submitted: the folder of the class; None for the default folder
    :param write: whether to write the new points to the gradebook and the reports; the reports are
        written even if the gradebook refuses some results
    :param yes: whether marks in the gradebook may be lowered or cleared; if not, and some would
        be, nothing is written
    :raises GraderError: if the assignment is unknown or nothing was graded yet; with ``write``,
        also if check cells and exams give different points
    """
    there = [(load_lesson(layout, one.assignment), one) for one in graded(layout, assignment)]
    if write:
        for lesson, _ in there:
            refuse_unfit_points(layout, lesson)
    accounts = [
        rejudge(layout, lesson, last, submitted or layout.submitted) for lesson, last in there
    ]
    if write:
        guard = Guard(layout, yes)
        for account in accounts:
            guard.allowed(account.lesson, Journal(layout, account.lesson).new(account.to_enter))
        for account in accounts:
            _write(layout, account, guard)
    return accounts


def rejudge(layout: Layout, lesson: Lesson, last: ClassResults, submitted: Path) -> Account:
    """Judge the recordings of all students with results; ``submitted`` has their work."""
    began = time.perf_counter()
    class_ = discover(submitted, lesson.assignment, lesson.notebook, layout.assignments())
    there = {one.student: one for one in class_}
    known: Known = {}
    done = tuple(
        _rejudged(layout, lesson, result, there.get(result.student), known)
        for result in last.results
    )
    return Account(lesson, done, time.perf_counter() - began)


Known = dict[tuple[Any, ...], tuple[ExamResult | None, str]]
"""Outcomes of :func:`again`, by exam, digest of the files, and recording with isolation mode."""


def _rejudged(
    layout: Layout,
    lesson: Lesson,
    before: SubmissionResult,
    submission: Submission | None,
    known: Known,
) -> Rejudged:
    """Judge the files of one student again, or return why that is impossible."""
    if submission is None:
        return Rejudged(before, before, kept='the submission no longer exists')
    opened = open_one(submission, lesson)
    files, old = lesson.files(opened), {exam.exam: exam for exam in before.exams}
    results = []
    for exam in lesson.exams:
        theirs, last = files[exam.name].files, old.get(exam.name)
        # Equal files get equal verdicts, so an untouched stub is judged once for the whole class.
        key = exam.name, files_digest(theirs), (last.recording, last.mode) if last else None
        if key not in known:
            known[key] = again(layout.recordings, exam, theirs, last)
        result, kept = known[key]
        if result is None:
            return Rejudged(before, before, kept=f'{exam.name}: {kept}')
        results.append(result)
    after = with_reasons(replace(before, exams=tuple(results), fault=''), lesson.exams)
    changed = [change for result in results for change in changes(old.get(result.exam), result)]
    return Rejudged(before, after, tuple(changed), graded=Graded(submission, opened, after))


def changes(before: ExamResult | None, after: ExamResult) -> Iterator[Changed]:
    """Yield the checks that differ between two results of one exam."""
    old = {check.check: check for check in before.checks} if before else {}
    new = {check.check: check for check in after.checks}
    for name in dict.fromkeys((*old, *new)):
        pair = old.get(name), new.get(name)
        shown = [(one.verdict, one.points, one.max_points) if one else None for one in pair]
        if shown[0] != shown[1]:
            was, now = (one.verdict.value if one else 'no such check' for one in pair)
            points = [one.points if one else 0.0 for one in pair]
            yield Changed(after.exam, name, was, now, points[0], points[1], _why(*pair))


def _why(before: CheckResult | None, after: CheckResult | None) -> str:
    """Return the reason for a change, from the new result or else from the old one."""
    if after is None:
        return 'the exam no longer has this check'
    if before is None:
        return 'the check is new'
    if after.expected or after.observed:
        return f'expected {after.expected or "more"}; observed {after.observed or "less"}'
    if before.max_points != after.max_points and before.verdict == after.verdict:
        most = f'{number(before.max_points)} -> {number(after.max_points)}'
        return f'the points of the check have changed: {most}'
    return f'before: {before.observed or before.expected or before.verdict.value}'


def _write(layout: Layout, account: Account, guard: Guard) -> None:
    """
    Enter new results in the gradebook, write all reports, and describe both in the account.

    Without ``--yes``, write nothing if a mark would be lowered.
    """
    account.lowered = guard.lowered_in(account.lesson.assignment)
    account.refused = guard.refusal('nothing was written')
    if account.refused:
        account.written = 'Nothing was written, because marks would be lowered or cleared.'
        return
    count = len(account.to_enter)
    new, account.refused = enter(layout, account.lesson, account.to_enter, guard)
    results = [one.after for one in account.rejudged]
    summary = f'{count} of {len(results)} submissions were judged again from recordings.'
    write_all_reports(layout, account.lesson.assignment, results, summary)
    in_gradebook = f'{new} were entered in the gradebook, {count - new} were unchanged'
    if account.refused:
        in_gradebook = f'the gradebook did not accept all of the {new} that changed'
    account.written = f'The reports show the new points of {count} submissions; {in_gradebook}.'

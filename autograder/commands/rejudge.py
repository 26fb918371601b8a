"""
Judge stored recordings again after an edit to an exam, without running any program.

The last results (``results.json`` in the reports) name the recordings.  A recording is used only
if its header has the digests of the current files and scenario; otherwise the student is listed
and keeps the old points.  Like ``grade``, ``--write`` enters only changed results in the
gradebook.
"""

import argparse
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
import time
from typing import Any

from autograder.classroom.course_lock import lock_course
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
from autograder.exam.inputs import refuse_other_secret
from autograder.explaining.feedback import number, printable
from autograder.gradebook.database import to_grade_by_hand
from autograder.gradebook.journal import Journal
from autograder.gradebook.live_entry import enter, Guard
from autograder.gradebook.record import refuse_unfit_points
from autograder.grading.examine import judge_again
from autograder.grading.pipeline import Graded, Lesson, load_lesson, open_one
from autograder.layout import Layout
from autograder.results import CheckResult, ExamResult, SubmissionResult, Verdict
from autograder.runs.version import files_digest
from autograder.submission.inbox import discover, Submission
from autograder.submission.submission import with_reasons


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
    with lock_course(layout, 'rejudge --write') if chosen.write else nullcontext():
        accounts = rejudge_command(
            layout, chosen.assignment, chosen.submitted, chosen.write, chosen.yes
        )
    show(chosen.json, accounts, '\n'.join(map(account_text, accounts)))
    if refused := ' '.join(dict.fromkeys(one['refused'] for one in accounts if one['refused'])):
        raise GraderError(refused)
    kept = any(one['kept'] for account in accounts for one in account['submissions'])
    return FOR_REVIEW if kept else OK


Account = dict[str, Any]
"""
The outcome of judging one assignment again, as JSON data.

``seconds`` is the wall time of the judging, ``written`` says what ``--write`` did, ``refused``
says why some results were not entered in the gradebook, and ``lowered`` lists the marks in the
gradebook that are, or would be, lowered or cleared.  In each of the ``submissions``, ``changed``
lists the checks whose verdict, points or maximum have changed, and ``kept`` says why the old
points are kept; it is empty if all exams were judged again.
"""
Known = dict[tuple[Any, ...], tuple[ExamResult | None, str]]
"""Outcomes of :func:`judge_again`, by exam, digest of the files, recording and isolation mode."""


def rejudge_command(
    layout: Layout, assignment: str | None, submitted: Path | None, write: bool, yes: bool = False
) -> list[Account]:
    """
    Judge the recordings of one assignment, or of all graded assignments, again.

    :param submitted: the folder of the class; None for the default folder
    :param write: whether to write the new points to the gradebook and the reports; the reports are
        written even if the gradebook refuses some results
    :param yes: whether marks in the gradebook may be lowered or cleared; if not, and some would
        be, nothing is written
    :raises GraderError: if the assignment is unknown, nothing has been graded yet, the course
        secret has changed, or check cells and exams give different points
    """
    refuse_other_secret(layout)
    there = [(load_lesson(layout, one.assignment), one) for one in graded(layout, assignment)]
    for lesson, _ in there:
        refuse_unfit_points(layout, lesson)
    done = [
        (lesson, *rejudge(layout, lesson, last, submitted or layout.submitted))
        for lesson, last in there
    ]
    if write:
        guard = Guard(layout, yes)
        for lesson, _, _, new in done:
            guard.allowed(lesson, Journal(layout, lesson).new(new))
        for lesson, account, results, new in done:
            account |= _write(layout, lesson, results, new, guard)
    return [account for _, account, _, _ in done]


def rejudge(
    layout: Layout, lesson: Lesson, last: ClassResults, submitted: Path
) -> tuple[Account, list[SubmissionResult], list[Graded]]:
    """Judge all recordings; return the account, all results, and those for the gradebook."""
    began = time.perf_counter()
    class_ = discover(submitted, lesson.assignment, lesson.notebook, layout.assignments())
    there = {one.student: one for one in class_}
    known: Known = {}
    rows, results, new = [], [], []
    for before in last.results:
        found = _rejudged(layout, lesson, before, there.get(before.student), known)
        after = before if isinstance(found, str) else found.result
        if isinstance(found, Graded):
            new.append(found)
        results.append(after)
        old = {exam.exam: exam for exam in before.exams}
        rows.append(
            {
                'student': before.student,
                'before': before.points,
                'after': after.points,
                'max_points': after.max_points,
                'kept': found if isinstance(found, str) else '',
                'changed': [row for one in after.exams for row in changes(old.get(one.exam), one)],
            }
        )
    account = {'assignment': lesson.assignment, 'seconds': time.perf_counter() - began}
    account |= {'written': '', 'refused': '', 'lowered': [], 'submissions': rows}
    return account, results, new


def _rejudged(
    layout: Layout,
    lesson: Lesson,
    before: SubmissionResult,
    submission: Submission | None,
    known: Known,
) -> Graded | str:
    """Judge the files of one student again, or return why that is impossible."""
    if submission is None:
        return 'the submission no longer exists'
    opened = open_one(submission, lesson)
    files, old = lesson.files(opened), {exam.exam: exam for exam in before.exams}
    results = []
    for exam in lesson.exams:
        theirs, last = files[exam.name].files, old.get(exam.name)
        # Equal files get equal verdicts, so an untouched stub is judged once for the whole class.
        key = exam.name, files_digest(theirs), (last.recording, last.mode) if last else None
        if key not in known:
            known[key] = judge_again(layout.recordings, exam, theirs, last)
        result, kept = known[key]
        if result is None:
            return f'{exam.name}: {kept}'
        results.append(result)
    after = with_reasons(replace(before, exams=tuple(results), fault=''), lesson.exams)
    return Graded(submission, opened, after)


def changes(before: ExamResult | None, after: ExamResult) -> Iterator[dict[str, Any]]:
    """Yield the checks that differ between two results of one exam."""
    old = {check.check: check for check in before.checks} if before else {}
    new = {check.check: check for check in after.checks}
    for name in dict.fromkeys((*old, *new)):
        pair = old.get(name), new.get(name)
        shown = [(one.verdict, one.points, one.max_points) if one else None for one in pair]
        if shown[0] != shown[1]:
            was, now = (one.verdict.value if one else 'no such check' for one in pair)
            points = [one.points if one else 0.0 for one in pair]
            yield {
                'exam': after.exam,
                'check': name,
                'before': was,
                'after': now,
                'points_before': points[0],
                'points_after': points[1],
                'why': _why(*pair),
            }


def _why(before: CheckResult | None, after: CheckResult | None) -> str:
    """Return the reason for a change, from the new result or else from the old one."""
    if after is None:
        return 'the exam no longer has this check'
    if before is None:
        return 'the check is new'
    if before.max_points != after.max_points and before.verdict == after.verdict:
        most = f'{number(before.max_points)} -> {number(after.max_points)}'
        return f'the points of the check have changed: {most}'
    if after.verdict is Verdict.NOT_RUN:
        return f'it waits for {after.waits_for}'
    if after.expected or after.observed:
        parts = {'expected': after.expected, 'observed': after.observed}
        return '; '.join(f'{word} {text}' for word, text in parts.items() if text)
    return f'previous result: {before.observed or before.expected or before.verdict.value}'


def account_text(account: Account) -> str:
    """Return the students with a changed check, the reasons and a summary as plain text."""
    rows, lines = account['submissions'], []
    for one in rows:
        if one['changed']:
            after = f'{number(one["after"])} of {number(one["max_points"])} points'
            lines.append(f'{one["student"]}: {number(one["before"])} -> {after}')
        for change in one['changed']:
            was, now = change['before'], change['after']
            points = (
                f'{number(change["points_before"])} -> {number(change["points_after"])} points'
            )
            verdict = was if was == now else f'{was} -> {now}'
            head = f'{change["exam"]}/{change["check"]}'
            lines.append(f'  {head}: {verdict}, {points}; {change["why"]}')
        if one['kept']:
            said = f'not judged again, old points unchanged: {one["kept"]}'
            lines.append(f'{one["student"]}: {said}')
    lines += [f'lower mark in the gradebook: {mark}' for mark in account['lowered']]
    judged = sum(not one['kept'] for one in rows)
    changed = sum(bool(one['changed']) for one in rows)
    advice = 'Nothing was written.' + (' Try: --write' if changed else '')
    each = 1000 * account['seconds'] / max(1, len(rows))
    lines.append(
        f'{account["assignment"]}: {judged} of {len(rows)} submissions judged again in '
        f'{account["seconds"]:.2f} s ({each:.1f} ms each) without a run; {changed} changed. '
        f'{account["written"] or advice}'
    )
    return printable('\n'.join(lines))


def _write(
    layout: Layout,
    lesson: Lesson,
    results: Sequence[SubmissionResult],
    new: Sequence[Graded],
    guard: Guard,
) -> Account:
    """
    Enter new results in the gradebook, write all reports, and return what was done.

    Without ``--yes``, write nothing if a mark would be lowered.
    """
    lowered, refused = guard.lowered_in(lesson.assignment), guard.refusal('nothing was written')
    if refused:
        said = 'Nothing was written, because marks would be lowered or cleared.'
        return {'written': said, 'refused': refused, 'lowered': lowered}
    count = len(new)
    entered, refused = enter(layout, lesson, new, guard)
    summary = f'{count} of {len(results)} submissions were judged again from recordings.'
    by_hand = to_grade_by_hand(layout, lesson.assignment, results)
    write_all_reports(layout, lesson.assignment, results, summary, len(by_hand))
    in_gradebook = f'new in the gradebook: {entered}, unchanged: {count - entered}'
    if refused:
        in_gradebook = f'the gradebook did not accept all of the {entered} changed results'
    said = f'The reports show the new points of {count} submissions; {in_gradebook}.'
    return {'written': said, 'refused': refused, 'lowered': lowered}

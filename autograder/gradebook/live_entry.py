"""
Enter finished submissions in the gradebook while others are running, and protect its marks.

nbgrader takes about 30 ms per submission, and seconds to import.  The coordinating process does
this work while it would otherwise only wait for runs.  To find marks that would fall, this module
compares the current mark with the mark after the entry, both with manual grades and late
penalties.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import timedelta
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from autograder.classroom.people import extensions
from autograder.errors import from_os_error, GraderError
from autograder.explaining.feedback import number, printable
from autograder.gradebook import journal
from autograder.gradebook.database import dump_instructions, has_gradebook, load_config, save_copy
from autograder.gradebook.journal import Journal
from autograder.gradebook.record import enter_assignment, record, timestamp_of
from autograder.grading.pipeline import Graded, Lesson
from autograder.layout import Layout
from autograder.results import first_of
from autograder.submission.notebook import is_check, marks_of

if TYPE_CHECKING:
    from nbgrader.api import SubmittedAssignment

BATCH_SIZE = 10
"""Number of submissions entered together; the fixed cost is then a tenth of the entry time."""
MAX_NAMED = 5
"""Maximum number of students that a sentence names."""


def lowered_marks(layout: Layout, lesson: Lesson, graded: Sequence[Graded]) -> dict[str, str]:
    """Return marks that an entry would lower or clear, such as ``ann 40 to 27``, by student."""
    if not has_gradebook(layout):
        return {}  # Opening the gradebook would create it.
    from nbgrader.api import MissingEntry

    from autograder.gradebook.converters import opened_gradebook

    found = {}
    with opened_gradebook(layout) as gradebook:
        for one in graded:
            with suppress(MissingEntry):
                submission = gradebook.find_submission(lesson.assignment, one.result.student)
                if change := _lowered(layout, lesson, one, submission):
                    found[one.result.student] = printable(f'{one.result.student} {change}')
    return found


def _lowered(
    layout: Layout, lesson: Lesson, graded: Graded, submission: SubmittedAssignment
) -> str:
    """Return how the mark of one submission would be lowered or cleared, else empty."""
    from autograder.gradebook.grade_cells import score_of

    new = {
        marks_of(cell)['grade_id']: score_of(cell, graded.result)
        for cell in lesson.release['cells']
        if is_check(cell)
    }
    counted = [
        grade
        for notebook in submission.notebooks
        for grade in notebook.grades
        if grade.name in new and grade.auto_score is not None and grade.manual_score is None
    ]
    gain = sum((new[grade.name] or 0.0) - grade.auto_score for grade in counted)
    score = float(submission.score) + gain
    before, after = mark_of(submission), score - _penalty(layout, graded, submission, score)
    emptied = [grade.name for grade in counted if new[grade.name] is None]
    if after >= before - 1e-6 and not emptied:
        return ''
    empty = f', no score for {", ".join(emptied)}' if emptied else ''
    return f'{number(before)} to {number(after)}{empty}'


def mark_of(submission: SubmittedAssignment) -> float:
    """Return the points of a submission in the gradebook, minus its late penalty."""
    return max(0.0, float(submission.score) - float(submission.late_submission_penalty or 0.0))


def _penalty(
    layout: Layout, graded: Graded, submission: SubmittedAssignment, score: float
) -> float:
    """Return the penalty that the late policy of the course assigns to a score."""
    from nbgrader.preprocessors import AssignLatePenalties
    from nbgrader.utils import parse_utc

    stamp = timestamp_of(graded.submission.folder)
    when = parse_utc(stamp) if stamp else submission.timestamp
    due, more = submission.assignment.duedate, submission.extension
    if (listed := extensions(layout)) is not None:
        more = listed.get((graded.result.student, submission.assignment.name))
    if when is None or due is None:
        return 0.0
    late_s = (when - due - (more or timedelta())).total_seconds()
    if late_s <= 0:
        return 0.0
    policy = AssignLatePenalties(config=load_config(layout))
    policy.init_plugin()
    penalty = policy.plugin_inst.late_submission_penalty(graded.result.student, score, late_s)
    return min(max(0.0, penalty or 0.0), score)


@dataclass
class Guard:
    """
    Prevent a command from lowering marks in the gradebook without permission.

    :param yes: whether marks may be lowered or cleared
    :param lowered: the changes of :func:`lowered_marks`, by assignment and student
    """

    layout: Layout
    yes: bool = False
    lowered: dict[str, dict[str, str]] = field(default_factory=dict)

    @cached_property
    def copy(self) -> Path | None:
        """Return a copy of the gradebook from before the first entry, made on first use."""
        return save_copy(self.layout)

    def allowed(self, lesson: Lesson, new: Sequence[Graded]) -> list[Graded]:
        """Return the submissions that may be entered; store which of them would lower a mark."""
        lowered = lowered_marks(self.layout, lesson, new)
        self.lowered.setdefault(lesson.assignment, {}).update(lowered)
        return [one for one in new if self.yes or one.result.student not in lowered]

    def lowered_in(self, assignment: str) -> list[str]:
        """Return the marks of an assignment that are, or would be, lowered, one line each."""
        return [line for _, line in sorted(self.lowered.get(assignment, {}).items())]

    def refusal(self, done: str) -> str:
        """Return why marks were not changed, and what was done; empty if no mark was protected."""
        marks = {name: self.lowered_in(name) for name, lowered in self.lowered.items() if lowered}
        if self.yes or not marks:
            return ''
        where = ', '.join(
            f'{len(lines)} mark{"s" * (len(lines) != 1)} of {name} ({first_of(lines, MAX_NAMED)})'
            for name, lines in marks.items()
        )
        return (
            f'gradebook: {where} would be lowered or cleared, so they were not changed; {done}. '
            'Try: run the same command with --yes to accept this. '
            f'{dump_instructions(self.layout)}'
        ).rstrip()


class LiveEntry:
    """Enter results while other submissions run; retry a failed entry after all runs."""

    def __init__(self, layout: Layout, lesson: Lesson, guard: Guard) -> None:
        self.layout, self.lesson, self.guard = layout, lesson, guard
        self.journal = Journal(layout, lesson)
        self.begin = cache(lambda: begin_to_enter(layout, lesson.assignment, guard))
        self.waiting: list[Graded] = []
        self.entered: list[str] = []
        self.works = True

    def add(self, graded: Graded) -> None:
        """Queue a submission unless it is in the gradebook; enter the queue when it is full."""
        self.waiting.append(graded)
        if not self.works:
            return
        try:
            if not self.journal.new([graded]):
                self.waiting.pop()
            else:
                self.begin()
            if len(self.waiting) >= BATCH_SIZE:
                self._enter()
        except Exception:  # noqa: BLE001 - A failed entry must not stop the other runs.
            self.works = False

    def finish(self) -> tuple[int, str]:
        """Enter the rest; return the number of new submissions, and why some were not entered."""
        try:
            self.waiting = self.journal.new(self.waiting)
            self._enter()
        except GraderError as error:
            return len(self.entered) + len(self.waiting), str(error)
        except OSError as error:
            why = str(from_os_error(error, str(self.layout.work)))
            return len(self.entered) + len(self.waiting), why
        return len(self.entered), ''

    def counts(self, graded: Sequence[Graded]) -> str:
        """Return how many of the results were entered, and how many were in the gradebook."""
        protected = self.guard.lowered.get(self.lesson.assignment, {})
        changed = {*self.entered, *protected, *(one.result.student for one in self.waiting)}
        unchanged = sum(
            one.submission.recordable and one.result.student not in changed for one in graded
        )
        return f'Gradebook: {len(self.entered)} entered, {unchanged} unchanged.'

    def _enter(self) -> None:
        """Enter the queued submissions, except those that the guard does not allow."""
        new = self.guard.allowed(self.lesson, self.waiting) if self.waiting else []
        if new:
            self.begin()
            record(self.layout, self.lesson, new)
            self.journal.note(new)
        self.entered += [one.result.student for one in new if one.submission.recordable]
        self.waiting = []


def begin_to_enter(layout: Layout, assignment: str, guard: Guard) -> None:
    """Prepare the gradebook for entries; the first call imports nbgrader, which takes seconds."""
    journal.refuse_incomplete(layout)
    _ = guard.copy
    journal.make_gradebook(layout)
    enter_assignment(layout, assignment)


def enter(
    layout: Layout, lesson: Lesson, graded: Sequence[Graded], guard: Guard
) -> tuple[int, str]:
    """Enter new results in the gradebook; return their number, and why some were not entered."""
    entry = LiveEntry(layout, lesson, guard)
    for one in graded:
        entry.add(one)
    return entry.finish()

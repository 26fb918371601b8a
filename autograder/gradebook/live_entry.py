"""
Enter finished submissions in the gradebook while others still run.

nbgrader takes about 30 ms per submission, and seconds to import.  The coordinating process uses
the time in which it would otherwise only wait for runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path

from autograder.errors import GraderError, of_system
from autograder.gradebook import journal
from autograder.gradebook.copies import how_to_dump, keep_copy
from autograder.gradebook.journal import Journal
from autograder.gradebook.lowered import lowered_marks, LoweredMark
from autograder.gradebook.record import enter_assignment, record
from autograder.grading.pipeline import Graded, Lesson
from autograder.layout import Layout

TOGETHER = 10
"""Submissions entered together; the fixed cost is then a tenth of the time for the entry."""


@dataclass
class Guard:
    """
    Prevent a command from lowering marks in the gradebook without permission.

    :param yes: whether marks may be lowered or cleared
    :param lowered: the marks that are, or would be, lowered or cleared, by assignment and student
    """

    layout: Layout
    yes: bool = False
    lowered: dict[str, dict[str, LoweredMark]] = field(default_factory=dict)

    @cached_property
    def copy(self) -> Path | None:
        """Return a copy of the gradebook from before the first entry, made on first use."""
        return keep_copy(self.layout)

    def allowed(self, lesson: Lesson, new: Sequence[Graded]) -> list[Graded]:
        """
        Return the submissions that may be entered; store which of them would lower a mark.

        :raises GraderError: if the gradebook cannot be read
        """
        lowered = {one.student: one for one in lowered_marks(self.layout, lesson, new)}
        self.lowered.setdefault(lesson.assignment, {}).update(lowered)
        return [one for one in new if self.yes or one.result.student not in lowered]

    def lowered_in(self, assignment: str) -> list[str]:
        """Return the marks of an assignment that are, or would be, lowered, one line each."""
        return [one.text() for _, one in sorted(self.lowered.get(assignment, {}).items())]

    def refusal(self, done: str) -> str:
        """
        Return why marks were not changed; empty if no mark was protected.

        :param done: what happened to the other marks, for the message
        """
        counts = {name: len(marks) for name, marks in self.lowered.items() if marks}
        if self.yes or not counts:
            return ''
        where = ', '.join(
            f'{count} mark{"s" * (count != 1)} of {name}' for name, count in counts.items()
        )
        return (
            f'gradebook: {where} would be lowered or cleared, so they were not changed; '
            f'{done}. Try: look at the list, then run the same command with --yes (make grade '
            f'ARGS=--yes). {how_to_dump(self.layout)}'
        ).rstrip()


class Entering:
    """
    Enter results while other submissions run.

    If an entry fails, it is repeated after all runs; only a second failure is reported.
    """

    def __init__(self, layout: Layout, lesson: Lesson, guard: Guard) -> None:
        self.layout, self.lesson, self.guard = layout, lesson, guard
        self.journal = Journal(layout, lesson)
        self.begin = cache(lambda: begin_to_enter(layout, lesson.assignment, guard))
        self.waiting: list[Graded] = []
        self.new, self.works = 0, True

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
            if len(self.waiting) >= TOGETHER:
                self._enter()
        except Exception:  # noqa: BLE001 - A failed entry must not stop the other runs.
            self.works = False

    def finish(self) -> tuple[int, str]:
        """
        Enter the remaining submissions.

        :returns: number of new submissions, and why some were not entered, empty if all were
        """
        try:
            self.waiting = self.journal.new(self.waiting)
            self._enter()
        except GraderError as error:
            return self.new + len(self.waiting), str(error)
        except OSError as error:
            return self.new + len(self.waiting), str(of_system(error, str(self.layout.work)))
        return self.new, ''

    def _enter(self) -> None:
        """Enter the queued submissions, except those that the guard does not allow."""
        new = self.guard.allowed(self.lesson, self.waiting) if self.waiting else []
        if new:
            self.begin()
            record(self.layout, self.lesson, new)
            self.journal.note(new)
        self.new += len(new)
        self.waiting = []


def begin_to_enter(layout: Layout, assignment: str, guard: Guard) -> None:
    """Prepare the gradebook for entries; the first call imports nbgrader, which takes seconds."""
    journal.shown(layout, assignment)  # Reports a failed database more clearly than nbgrader.
    journal.refuse_incomplete(layout)
    _ = guard.copy
    journal.make_gradebook(layout)
    enter_assignment(layout, assignment)


def enter(
    layout: Layout, lesson: Lesson, graded: Sequence[Graded], guard: Guard
) -> tuple[int, str]:
    """Enter new results in the gradebook; return their number, and why some were not entered."""
    entering = Entering(layout, lesson, guard)
    for one in graded:
        entering.add(one)
    return entering.finish()

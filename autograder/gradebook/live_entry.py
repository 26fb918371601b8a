"""
Enter finished submissions in the gradebook while others still run.

nbgrader takes about 30 ms per submission, and seconds to import.  Otherwise the coordinator would
only wait for the runs during that time.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path

from autograder.errors import GraderError, of_system
from autograder.gradebook import journal
from autograder.gradebook.copies import how_to_dump, keep_copy
from autograder.gradebook.lowered import lowered_marks, LoweredMark
from autograder.gradebook.record import enter_assignment, record
from autograder.grading.pipeline import Graded, Lesson
from autograder.layout import Layout

TOGETHER = 10
"""Submissions per entry: the time to begin an entry is then a tenth of the whole."""


@dataclass
class Guard:
    """
    Keep a command from lowering marks in the gradebook.

    :param yes: whether marks may be lowered or emptied
    :param lowered: the marks that are, or would be, by assignment and student
    """

    layout: Layout
    yes: bool = False
    lowered: dict[str, dict[str, LoweredMark]] = field(default_factory=dict)

    @cached_property
    def copy(self) -> Path | None:
        """Return the copy of the gradebook that was made before the command's first entry."""
        return keep_copy(self.layout)

    def allowed(self, lesson: Lesson, new: Sequence[Graded]) -> list[Graded]:
        """
        Return the submissions that may be entered; note which of them would lower a mark.

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
        Return why marks were not changed; empty if all were.

        :param done: the outcome of the command
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

    An entry that fails is tried again, and reported, after all runs.
    """

    def __init__(self, layout: Layout, lesson: Lesson, guard: Guard | None = None) -> None:
        self.layout, self.lesson, self.guard = layout, lesson, guard or Guard(layout)
        self.begin = cache(lambda: begin_to_enter(layout, lesson.assignment, self.guard))
        self.ready: list[Graded] = []
        self.entered: set[str] = set()
        self.new, self.works = 0, True

    def meanwhile(self, ready: Sequence[Graded]) -> None:
        """Prepare the gradebook, and enter the finished submissions if there are enough."""
        self.ready += ready
        if self.works:
            try:
                self.begin()
                if len(self.ready) >= TOGETHER:
                    self._enter_together()
            except Exception:  # noqa: BLE001 - whatever it is, it costs nobody else's run
                self.works = False

    def _enter_together(self) -> None:
        together, self.ready = self.ready, []
        new, refused = enter(self.layout, self.lesson, together, self.begin, self.guard)
        self.works = not refused
        if self.works:
            self.new += new
            self.entered |= {one.result.student for one in together}

    def finish(self, graded: Sequence[Graded]) -> tuple[int, str]:
        """
        Enter the remaining submissions.

        :param graded: the whole class
        :returns: how many of it were new, and what the gradebook refused
        """
        others = [one for one in graded if one.result.student not in self.entered]
        new, refused = enter(self.layout, self.lesson, others, self.begin, self.guard)
        return self.new + new, refused


def begin_to_enter(layout: Layout, assignment: str, guard: Guard | None = None) -> None:
    """Prepare the gradebook during the runs, because nbgrader takes seconds to import."""
    journal.shown(layout, assignment)  # reports errors in plainer words than nbgrader
    journal.refuse_incomplete(layout)
    _ = (guard or Guard(layout)).copy
    journal.make_gradebook(layout)
    enter_assignment(layout, assignment)


def enter(
    layout: Layout,
    lesson: Lesson,
    graded: Sequence[Graded],
    begin: Callable[[], None] = lambda: None,
    guard: Guard | None = None,
) -> tuple[int, str]:
    """
    Enter new results in the gradebook; return how many there were, and what was refused.

    :param begin: prepares the gradebook, which is not needed if nothing is new
    :param guard: decides which marks are not changed; None if every mark may change
    """
    new: Sequence[Graded] = graded
    try:
        new = journal.to_enter(layout, lesson, graded)
        if new and guard is not None:
            new = guard.allowed(lesson, new)
        if not new:
            return 0, ''
        begin()
        record(layout, lesson, new)
        journal.note(layout, lesson, new)
    except GraderError as error:
        return len(new), str(error)
    except OSError as error:
        return len(new), str(of_system(error, str(layout.work)))
    return len(new), ''

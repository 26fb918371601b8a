"""
Enter a class in the gradebook, as far as it is ready, while the rest is still being run.

nbgrader takes some 30 ms for each submission, and seconds to be imported.  All that time the
coordinator would only wait for the runs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

from autograder.errors import GraderError
from autograder.gradebook import entered
from autograder.gradebook.record import enter_assignment, record
from autograder.layout import Layout
from autograder.whole_class.pipeline import Graded, Lesson

TOGETHER = 10
"""Submissions entered at once: what it takes to begin is then a tenth of the whole."""


class Entering:
    """
    Enters results while others are being run.

    What fails meanwhile is tried again, and told, when all is run.
    """

    def __init__(self, layout: Layout, lesson: Lesson) -> None:
        """Enter nothing yet."""
        self.layout, self.lesson = layout, lesson
        self.begin = cache(lambda: begin_to_enter(layout, lesson.assignment))
        self.ready: list[Graded] = []
        self.entered: set[str] = set()
        self.new, self.works = 0, True

    def meanwhile(self, ready: Sequence[Graded]) -> None:
        """Prepare the gradebook, and enter those that are ready if they are enough."""
        self.ready += ready
        if self.works:
            try:
                self.begin()
                self._enter_together()
            except Exception:  # noqa: BLE001 - whatever it is, it costs nobody else's run
                self.works = False

    def _enter_together(self) -> None:
        if len(self.ready) < TOGETHER:
            return
        together, self.ready = self.ready, []
        new, refused = enter(self.layout, self.lesson, together, self.begin)
        self.works = not refused
        if self.works:
            self.new += new
            self.entered |= {one.result.student for one in together}

    def finish(self, graded: Sequence[Graded]) -> tuple[int, str]:
        """
        Enter the others.

        :param graded: the whole class
        :returns: how many of it were new, and what the gradebook refused
        """
        others = [one for one in graded if one.result.student not in self.entered]
        new, refused = enter(self.layout, self.lesson, others, self.begin)
        return self.new + new, refused


def begin_to_enter(layout: Layout, assignment: str) -> None:
    """Prepare the gradebook while the runs take place: nbgrader takes seconds to import."""
    entered.shown(layout, assignment)  # an error here is plainer than nbgrader's
    entered.make_gradebook(layout)
    enter_assignment(layout, assignment)


def enter(
    layout: Layout,
    lesson: Lesson,
    graded: Sequence[Graded],
    begin: Callable[[], None] = lambda: None,
) -> tuple[int, str]:
    """
    Enter what is new in the gradebook; return how many were, and what it refused.

    :param begin: prepares the gradebook, which is not needed if nothing is new
    """
    new: Sequence[Graded] = graded
    try:
        new = entered.to_enter(layout, lesson, graded)
        if not new:
            return 0, ''
        begin()
        record(layout, lesson, new)
        entered.note(layout, lesson, new)
    except GraderError as error:
        return len(new), str(error)
    return len(new), ''

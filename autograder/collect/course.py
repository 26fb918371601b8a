"""The assignments of a course: due dates, and ids and file names that identify a notebook."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime, timedelta, timezone
from functools import cached_property
import re

from sqlalchemy import DateTime, Interval, text

from autograder.classroom.people import extensions
from autograder.collect.deliveries import NOTEBOOK
from autograder.errors import GraderError
from autograder.gradebook.database import query
from autograder.layout import Layout
from autograder.submission.notebook import grade_ids, read_notebook, read_release

# Suffixes that browsers, Canvas and Jupyter add to a name that already exists.
_COPY = re.compile(r'( ?\(\d+\)|-\d+| - Copy|-Copy\d+)+(?=\.ipynb$)')

_NUMBER = re.compile(r'^\d+[_-]')


def _plain(name: str) -> str:
    """Return a name in lower case, with hyphens instead of underscores, for comparisons."""
    return name.replace('_', '-').lower()


@dataclass(frozen=True)
class DueDates:
    """
    Due dates in UTC by assignment, and extra time by student and assignment.

    :param problem: why the gradebook could not be read, empty if it could
    """

    dates: Mapping[str, datetime] = field(default_factory=dict)
    extensions: Mapping[tuple[str, str], timedelta] = field(default_factory=dict)
    problem: str = ''

    def of(self, student: str, assignment: str) -> datetime | None:
        """Return a student's due date, or None if the gradebook has none."""
        date = self.dates.get(assignment)
        more = self.extensions.get((student, assignment), timedelta())
        return None if date is None else date + more


_DATES = 'select name, duedate from assignment where duedate is not null'
_EXTENSIONS = """
select submitted_assignment.student_id, assignment.name, submitted_assignment.extension
from submitted_assignment join assignment on assignment.id = submitted_assignment.assignment_id
where submitted_assignment.extension is not null
"""


def due_dates(layout: Layout) -> DueDates:
    """
    Read the due dates from the gradebook, without creating a gradebook.

    Extra time comes from ``extensions.csv`` if it exists, else from the gradebook.  The database
    is queried directly, because nbgrader takes seconds to import.

    :raises GraderError: if ``extensions.csv`` is wrong
    """
    if not (layout.root / 'nbgrader_config.py').is_file():
        return DueDates()
    dates = text(_DATES).columns(duedate=DateTime())
    granted = text(_EXTENSIONS).columns(extension=Interval())
    given = extensions(layout)
    try:
        found = {
            str(name): date.replace(tzinfo=timezone.utc)
            for name, date in query(layout, dates, 'assignment')
        }
        if given is None:
            rows = query(layout, granted, 'assignment')
            given = {(str(one), str(name)): more for one, name, more in rows}
        return DueDates(found, given)
    except (GraderError, ValueError, ImportError) as error:
        what = ' '.join(str(error).split())[:120]
        return DueDates(problem=f'due dates unknown, because the gradebook cannot be read: {what}')


@dataclass
class Course:
    """The assignments of a course; their files are read on first use."""

    layout: Layout

    @cached_property
    def assignments(self) -> tuple[str, ...]:
        """Return the names of all assignments."""
        return self.layout.assignments()

    @cached_property
    def file_names(self) -> Mapping[str, str]:
        """Return the file name of each assignment's notebook."""
        return {name: self.layout.release(name).name for name in self.assignments}

    @cached_property
    def cells(self) -> Mapping[str, frozenset[str]]:
        """Return the grade ids of every released notebook, by assignment."""
        return {
            name: grade_ids(read_release(self.layout.release(name))) for name in self.assignments
        }

    @cached_property
    def due(self) -> DueDates:
        """Return the due dates in the gradebook."""
        return due_dates(self.layout)

    def of_file(self, name: str) -> str:
        """Return the assignment whose notebook has this name, ignoring suffixes like ``(1)``."""
        plain = _COPY.sub('', NOTEBOOK.sub('.ipynb', name))
        found = [one for one, file in self.file_names.items() if file in (name, plain)]
        return found[0] if len(found) == 1 else ''

    def named(self, parts: Sequence[str]) -> str:
        """Return the assignment that a path names, by its file or else by a folder."""
        folders = [part for part in parts[:-1] if part in self.assignments]
        return self.of_file(parts[-1]) or (folders[-1] if folders else '')

    def beginning(self, name: str) -> str:
        """Return the assignment and separator with which a repository's name begins, or ''."""
        forms = (form for one in self.assignments for form in (one, _NUMBER.sub('', one)))
        fitting = (one for one in forms if _plain(name).startswith(_plain(f'{one}-')))
        begins = (name[: len(one) + 1] for one in fitting)
        return max((one for one in begins if one != name), key=len, default='')

    def shared(self, data: bytes) -> tuple[dict[str, int], str]:
        """
        Count the grade ids in a notebook.

        :returns: the counts by assignment, without zeros; and why the data is not a notebook and
            what to try, empty if it is one
        """
        cells, problems = read_notebook(data, '')
        ids = {cell.grade_id for cell in cells or ()} - {''}
        counts = {name: len(ids & theirs) for name, theirs in self.cells.items() if ids & theirs}
        broken = [f'{one.got}. Try: ask the student to {one.try_this}' for one in problems]
        return counts, broken[0] if cells is None else ''

"""Read times of delivery and due dates, and describe late work."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime, timedelta, timezone
import re

from sqlalchemy import DateTime, Interval, text

from autograder.classroom.people import extensions
from autograder.errors import GraderError
from autograder.gradebook.database import query
from autograder.layout import Layout

_TIME = re.compile(r'(\d{4}-\d\d-\d\d)[ T](\d\d:\d\d)(:\d\d)?(?:\.\d+)? ?(\S.*)?')
_ZONE = re.compile(r'UTC|GMT|Z|([+-]\d\d):?(\d\d)?', re.IGNORECASE)


def read_time(value: object) -> tuple[datetime | None, str]:
    """
    Read a time as nbgrader and Gradescope write it.

    Offsets and UTC are accepted, but no other names of time zones: CST alone has four meanings.

    :param value: a string, the content of a file, a datetime from YAML, or None; without a time
        zone it is in UTC
    :returns: the time in UTC or None, and a note if the value was not understood
    """
    try:
        if isinstance(value, datetime):
            found = value if value.tzinfo else value.replace(tzinfo=timezone.utc)
            return found.astimezone(timezone.utc), ''
        if isinstance(value, bytes):
            value = value[:100].decode('utf-8', 'replace')
        text = value.strip() if isinstance(value, str) else ''
        match = _TIME.fullmatch(text)
        if match is None:
            return None, f'time {text[:40]!r} not understood, ignored' if text else ''
        day, minute, second, name = match.groups()
        zone = _ZONE.fullmatch(name or 'UTC')
        if zone is None:
            return None, f'time zone {name[:20]} not understood, ignored'
        offset = f'{zone[1] or "+00"}:{zone[2] or "00"}'
        found = datetime.fromisoformat(f'{day} {minute}{second or ":00"}{offset}')
        return found.astimezone(timezone.utc), ''
    except (ValueError, OverflowError):  # The date does not exist, or is before the year 1.
        return None, f'time {str(value)[:40]!r} not understood, ignored'


def late_notes(late: str, when: datetime | None, due: datetime | None) -> tuple[str, ...]:
    """Return notes about late work; ``late`` names the platform that marks the work as late."""
    if when and due and when > due:
        minutes = int((when - due).total_seconds()) // 60
        parts = ((minutes // 1440, 'd'), (minutes // 60 % 24, 'h'), (minutes % 60, 'min'))
        length = ' '.join(f'{count} {unit}' for count, unit in parts if count)
        return (f'late by {length or "less than a minute"}',)
    unknown = '' if when else '; the time is unknown, so a late policy cannot apply'
    return (f'late, according to {late}{unknown}',) if late else ()


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

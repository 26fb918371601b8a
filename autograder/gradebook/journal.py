"""
Record which results are in the gradebook, so that unchanged results are not entered again.

nbgrader needs about 30 ms to enter a submission, three times as long as a rerun may take.  So the
journal of an assignment is a JSON file with a digest by student: of the submission, its result and
the values that the gradebook shows.  A gradebook that was deleted, restored or edited is therefore
filled again.  Manual grades are not compared, because nbgrader always keeps them.  But a late
penalty may be a share of the manual grades, so late work is entered again after each manual grade.
"""

from collections.abc import Collection, Mapping, Sequence
from datetime import timedelta
from functools import cached_property
import hashlib
import json
from pathlib import Path
from typing import Any

from sqlalchemy import inspect, text

from autograder.classroom.people import extensions
from autograder.classroom.tables import read_json
from autograder.files import json_bytes, write_atomically
from autograder.gradebook.database import (
    connected,
    gradebook_file,
    load_config,
    query,
    refusal,
    settings_files,
)
from autograder.grading.pipeline import Graded, Lesson
from autograder.layout import Layout
from autograder.submission.inbox import STAMP
from autograder.submission.reading import read_file

Rows = dict[str, dict[str, Any]]
"""Values in the gradebook, by student and by cell."""

SHOWN = """
select submitted_assignment.student_id, base_cell.name, grade.auto_score,
       submitted_assignment.timestamp, submitted_assignment.extension, assignment.duedate,
       submitted_notebook.late_submission_penalty,
       case when submitted_notebook.late_submission_penalty is null then null
            else grade.manual_score end,
       case when submitted_notebook.late_submission_penalty is null then null
            else grade.extra_credit end
from grade
join base_cell on base_cell.id = grade.cell_id
join submitted_notebook on submitted_notebook.id = grade.notebook_id
join submitted_assignment on submitted_assignment.id = submitted_notebook.assignment_id
join assignment on assignment.id = submitted_assignment.assignment_id
where assignment.name = :assignment
"""


def make_gradebook(layout: Layout) -> None:
    """
    Create the gradebook atomically, unless its file exists.

    nbgrader creates its tables and then stores their version.  If it is killed between the two
    steps, a later version of nbgrader cannot upgrade the gradebook.  The journals are removed
    first, because they describe a gradebook that no longer exists.
    """
    from alembic.script import ScriptDirectory
    from nbgrader import api
    from nbgrader.dbutil import ALEMBIC_DIR

    path = gradebook_file(layout)
    if path is None or path.exists():
        return
    unfinished = Path(f'{path}.unfinished')  # A fixed name is safe: the course is locked.
    unfinished.parent.mkdir(parents=True, exist_ok=True)
    for left in (unfinished, Path(f'{unfinished}-journal')):
        left.unlink(missing_ok=True)
    of_nbgrader = api.get_alembic_version  # It starts a separate command, which takes a second.
    api.get_alembic_version = ScriptDirectory(ALEMBIC_DIR).get_current_head
    try:
        course = str(load_config(layout).CourseDirectory.course_id)
        with api.Gradebook(f'sqlite:///{unfinished}', course):
            pass
    finally:
        api.get_alembic_version = of_nbgrader
    for assignment in layout.assignments():
        journal_file(layout, assignment).unlink(missing_ok=True)
        _remove_old_journal(layout, assignment)
    unfinished.replace(path)


def refuse_incomplete(layout: Layout) -> None:
    """Refuse a gradebook with a missing table, because nbgrader would create an empty one."""
    from nbgrader.api import Base

    with connected(layout) as gradebook:
        there = set() if gradebook is None else set(inspect(gradebook).get_table_names())
    missing = sorted(set(Base.metadata.tables) - there)
    if there and missing:
        raise refusal(layout, f'no such table: {", ".join(missing)}')


class Journal:
    """The submissions of one assignment that are already in the gradebook."""

    def __init__(self, layout: Layout, lesson: Lesson) -> None:
        self.layout, self.lesson = layout, lesson

    @cached_property
    def _known(self) -> Mapping[str, str]:
        return read_notes(self.layout, self.lesson.assignment)

    @cached_property
    def _gradebook_values(self) -> Rows:
        """Return the values in the gradebook, which are read on first use."""
        return gradebook_values(self.layout, self.lesson.assignment)

    @cached_property
    def _extensions(self) -> Mapping[tuple[str, str], timedelta]:
        """Return the extra time of individual students."""
        return extensions(self.layout) or {}

    @cached_property
    def _common_digest(self) -> str:
        """Return a digest of the release and the settings, on which all entries depend."""
        settings = b''.join(path.read_bytes() for path in settings_files(self.layout))
        release = json.dumps(self.lesson.release, sort_keys=True)
        return hashlib.sha256(settings + b'\0' + release.encode('utf-8', 'replace')).hexdigest()

    def new(self, graded: Sequence[Graded]) -> list[Graded]:
        """Return the submissions whose results are not in the gradebook yet."""
        return [
            one
            for one in graded
            if self._known.get(one.result.student) != self._digest(one, self._gradebook_values)
            or not autograded(self.layout, self.lesson, one).is_file()
        ]

    def note(self, entered: Sequence[Graded]) -> None:
        """Store the digests of those submissions that nbgrader has entered."""
        rows = gradebook_values(self.layout, self.lesson.assignment)
        digests = {
            one.result.student: self._digest(one, rows)
            for one in entered
            if one.result.student in rows
        }
        known = read_notes(self.layout, self.lesson.assignment)
        path = journal_file(self.layout, self.lesson.assignment)
        write_atomically(path, json_bytes({**known, **digests}))
        _remove_old_journal(self.layout, self.lesson.assignment)

    def _digest(self, graded: Graded, rows: Rows) -> str:
        """Return a digest of a submission, its result, and the gradebook's values."""
        student, result = graded.result.student, graded.result.to_json()
        result.pop('collected')
        for exam in result['exams']:
            exam.pop('timing', None)
            exam.pop('pictures', None)
        stamp, _ = read_file(graded.submission.folder / STAMP, STAMP)
        parts = (
            self._common_digest,
            result,
            graded.opened.notebook,
            (stamp or b'')[:100].decode('latin-1'),
            str(self._extensions.get((student, self.lesson.assignment), '')),
            rows.get(student, {}),
        )
        text = json.dumps(parts, sort_keys=True, default=list)
        return hashlib.sha256(text.encode('utf-8', 'replace')).hexdigest()[:32]


def journal_file(layout: Layout, assignment: str) -> Path:
    """Return the file with the digests of the entered submissions."""
    return layout.work / 'entered' / f'{assignment}.json'


def read_notes(layout: Layout, assignment: str) -> dict[str, str]:
    """Return the digests of the entered submissions by student; none if the file is damaged."""
    found = read_json(journal_file(layout, assignment))
    return found if isinstance(found, dict) else {}


def drop(layout: Layout, assignment: str, students: Collection[str]) -> None:
    """Remove some students from the journal of an assignment."""
    known = read_notes(layout, assignment)
    kept = {student: digest for student, digest in known.items() if student not in students}
    if kept != known:
        write_atomically(journal_file(layout, assignment), json_bytes(kept))
    _remove_old_journal(layout, assignment)


def _remove_old_journal(layout: Layout, assignment: str) -> None:
    """Remove the journal that an earlier version wrote, because it contains ids and scores."""
    journal_file(layout, assignment).with_suffix('.jsonl').unlink(missing_ok=True)


def gradebook_values(layout: Layout, assignment: str) -> Rows:
    """Return the values in the gradebook for an assignment."""
    rows: Rows = {}
    for student, cell, *facts in query(layout, text(SHOWN), assignment=assignment):
        score, *times = facts
        rows.setdefault(str(student), {})[str(cell)] = [score, *map(str, times)]
    return rows


def autograded(layout: Layout, lesson: Lesson, graded: Graded) -> Path:
    """Return the path of the notebook that nbgrader stores for a graded submission."""
    folder = layout.work / 'autograded' / graded.result.student / lesson.assignment
    return folder / lesson.notebook

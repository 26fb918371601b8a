"""
Select one notebook per student and assignment.

A *delivery* is everything that one student handed in at one time.  Notebooks with cells of the
assignment take precedence, then the newest delivery.  Within a delivery, the notebook with the
most grade ids of the assignment is selected, regardless of its file name.  Ties are broken by the
file name, and then by the time: the newest attempt wins.

A notebook without any cell of the course is collected only if no other notebook was handed in for
the assignment: the grader can explain a broken notebook, but private notes must not replace the
answers.

A learning platform exports one assignment at a time.  Without ``--assignment``, ``collect``
chooses the assignment for which most students have a notebook.  So a notebook of lesson 6 that was
uploaded for lesson 7 does not replace a notebook that was handed in for lesson 6.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from statistics import multimode
from typing import NamedTuple

from autograder.collect.course import Course
from autograder.collect.deliveries import Delivery, LEFT, NOTEBOOK, notebooks_in, Row, TAKEN
from autograder.collect.platforms import read_time
from autograder.results import first_of
from autograder.submission.inbox import STAMP
from autograder.submission.reading import File, UnreadableError, UnusableUploadError

MOST_NOTEBOOKS = 50
"""Maximum number of notebooks read from one delivery; a clone of the course has about twelve."""
MOST_BYTES_EACH = 256 << 20
NAMES_SHOWN = 3
ASK = 'ask the student for the .ipynb file'
NO_TIME = (
    '; the time is unknown, so a late policy cannot apply. Try: write the time into timestamp.txt '
    '(docs/gradebook.md)'
)


@dataclass(frozen=True, eq=False)
class NotebookInfo:
    """
    Facts about a notebook, without its content: the notebooks of a class may not fit in memory.

    :param shared: number of grade ids in the notebook, by assignment
    :param named: the assignment that the name of the file or folder suggests
    :param why: why the notebook was not read, empty if it was
    :param broken: why the file is not a notebook and what to try, empty if it is one
    """

    delivery: Delivery
    file: File
    place: str
    turn: int
    shared: Mapping[str, int] = field(default_factory=dict)
    named: str = ''
    why: str = ''
    broken: str = ''

    @property
    def content(self) -> str:
        """Return the assignment to which most cells belong, or an empty string."""
        return max(self.shared, key=lambda name: (self.shared[name], name), default='')

    @property
    def about(self) -> str:
        """Return the assignment that the cells, or else the name, suggest; else empty."""
        return self.content or self.named


class Chosen(NamedTuple):
    """
    A notebook that was selected for collection.

    :param when: time of delivery in UTC, None if it is not known
    :param row: its row in the table, before the notebook is written
    :param turn_there: turn of the notebook that was collected earlier, 0 if it is not known
    """

    notebook: NotebookInfo
    when: datetime | None
    row: Row
    turn_there: int = 0


def read_notebooks(delivery: Delivery, course: Course, wanted: str) -> list[NotebookInfo]:
    """
    Read the notebooks of a delivery within the limits, the most likely ones first.

    :param wanted: the only assignment to collect; empty for all.  It is set in the delivery, and a
        delivery that cannot be collected is refused without reading its files
    """
    delivery.refused = _unusable(delivery, course)
    delivery.assignment = wanted or delivery.assignment
    if delivery.refused:
        return []
    found = _read(delivery, course)
    if any(one.shared or not course.cells.get(one.named, True) for one in found):
        return found
    return _read(delivery, course, zips=True)  # The answers may be in a zip next to other work.


def _read(delivery: Delivery, course: Course, zips: bool = False) -> list[NotebookInfo]:
    """Read the notebooks of a delivery; with ``zips``, zips next to notebooks are opened too."""
    files = [
        found
        for place in delivery.places
        for found in notebooks_in([one for one in delivery.files if one.place == place], zips)
    ]
    files.sort(key=lambda one: (len(one.file.parts), one.file.parts))
    files.sort(key=lambda one: (not course.of_file(one.file.name), -one.turn))
    notebooks, left = [], MOST_BYTES_EACH
    for count, delivered in enumerate(files):
        file = delivered.file
        one = NotebookInfo(
            delivery,
            file=file,
            place=delivered.place,
            turn=delivered.turn,
            named=course.named(file.parts),
        )
        try:
            if count >= MOST_NOTEBOOKS or left <= 0:
                raise UnreadableError(
                    f'not read: only the first {count} notebooks of a delivery are read'
                )
            data = file.read()
            left -= len(data)
            shared, broken = course.shared(data)
            if shared or NOTEBOOK.search(file.name):
                notebooks.append(replace(one, shared=shared, broken=broken))
        except UnreadableError as error:
            notebooks.append(replace(one, why=str(error)))
    return notebooks


def _unusable(delivery: Delivery, course: Course) -> str:
    """Return why a delivery cannot be collected, empty if it can."""
    name = delivery.assignment
    if not delivery.id:
        return 'no letter or digit in the name'
    if delivery.refused:
        return delivery.refused
    if name and name not in course.assignments:
        return f'{name}: not an assignment of this course; name one with --assignment'
    return '' if delivery.files else 'no file that can be read'


def most_common_assignment(
    notebooks: Iterable[Sequence[NotebookInfo]], course: Course, name: str
) -> str:
    """
    Return the assignment that most students handed in, for a source with only one assignment.

    Each student counts once per assignment, even with several notebooks.

    :returns: the assignment, empty if there is no notebook at all
    :raises UnusableUploadError: if no notebook shows an assignment, or if two assignments are
        equally frequent
    """
    students = [one for one in notebooks if one]
    votes = (found for one in students for found in {each.about for each in one} - {''})
    among = sorted(multimode(votes))
    if len(among) == 1 or not students:
        return ''.join(among)
    got = f'as many from {among[1]} as from {among[0]}' if among else 'none is from this course'
    raise UnusableUploadError(
        f'{name}: the notebooks do not show which assignment this is: {got}.',
        f'Try: --assignment NAME, with one of {", ".join(among or course.assignments)}',
    )


def choose(
    deliveries: Mapping[Delivery, Sequence[NotebookInfo]], course: Course, single: bool
) -> tuple[list[Chosen], list[Row]]:
    """
    Select the notebooks to collect, one per student and assignment.

    :param single: whether the source is for one assignment, so that notebooks of others are
        mistakes
    :returns: the selected notebooks, and a row for each entry that was not, or only partly,
        collected
    """
    fitting: dict[tuple[str, str], list[NotebookInfo]] = {}
    for delivery, notebooks in deliveries.items():
        goal = delivery.assignment
        if not delivery.refused:
            for name in [goal] if goal else sorted({one.about for one in notebooks} - {''}):
                found = _fitting(notebooks, name, course, bool(goal))
                fitting.setdefault((delivery.id, name), []).extend(found)
    chosen: dict[str, dict[str, Chosen]] = {}
    reasons: dict[NotebookInfo, str] = {}
    for (student, assignment), candidates in fitting.items():
        names = {one.delivery.called or one.delivery.student for one in candidates}
        if len(names) > 1:  # Two students map to one id: collect neither and report the clash.
            why = f'several names give one student id: {", ".join(map(repr, sorted(names)))}'[:160]
            reasons |= dict.fromkeys(candidates, why)
        elif candidates:
            best = _best(candidates, assignment, course)
            chosen.setdefault(student, {})[assignment] = best
            reasons |= {one: _why_another(one, best.notebook) for one in candidates}
    rows: list[Row] = []
    for delivery, notebooks in deliveries.items():
        mine = chosen.get(delivery.id, {})
        rows += _others(delivery, notebooks, mine, reasons, single)
    return [best for mine in chosen.values() for best in mine.values()], rows


def _fitting(
    notebooks: Sequence[NotebookInfo], assignment: str, course: Course, only: bool
) -> list[NotebookInfo]:
    """
    Return the notebooks of a delivery that may belong to an assignment.

    A notebook without cells of the assignment is returned only if no other notebook qualifies.

    :param only: whether the whole delivery was handed in for this assignment
    """
    if found := [one for one in notebooks if one.content == assignment]:
        return found
    names = ('', assignment) if only else (assignment,)
    if any(one.why and one.named in names for one in notebooks):
        return []  # The unreadable notebook may contain the answers.
    named = [one for one in notebooks if not one.shared and one.named == assignment]
    if not named and only and len(notebooks) == 1:
        return [one for one in notebooks if not one.shared and not one.named]
    # If a lesson has no graded cells, only the name can identify its notebook.
    return named if len(named) == 1 or not course.cells[assignment] else []


def _best(candidates: Sequence[NotebookInfo], assignment: str, course: Course) -> Chosen:
    """Return the notebook to collect, with notes for the table."""

    def merit(one: NotebookInfo) -> tuple[bool, float, int, bool, bool, int, bool, int]:
        file, cells, when = one.file, one.shared.get(assignment, 0), one.delivery.when
        return (
            cells > 0,
            when.timestamp() if when else 0.0,
            cells,
            course.of_file(file.name) == assignment,
            assignment in file.parts,
            one.turn,
            file.name == course.file_names[assignment],
            -len(file.parts),
        )

    # Of two files with the same name, consider only the newer one, regardless of its content.
    by_turn = sorted(candidates, key=lambda one: one.turn)
    newest = {(one.delivery.places, one.file.parts): one for one in by_turn}
    best = max(newest.values(), key=merit)
    file = best.file
    beside = [one for one in newest.values() if one.delivery is best.delivery and one is not best]
    older = [one for one in candidates if one is not best and _is_attempt(one, best)]
    notes = [f'the newest of {len(older) + 1} attempts'] if older else []
    if best.shared and not all(one.shared for one in older):
        notes[0] += ' with a cell of the assignment'
    if beside:
        notes.append(_why_this(best, beside, assignment))
    notes += _said(best.delivery)
    if best.broken:
        notes.append(f'not a notebook, but {best.broken}')
    elif course.cells[assignment] and not best.shared:
        notes.append('it contains no cell of the assignment')
    if file.name != course.file_names[assignment]:
        notes.append(f'the file was called {file.name[:60]!r}')
    when, about_time = _time(best, assignment)
    due = course.due.of(best.delivery.id, assignment) if when else None
    said = (*late_notes(best.delivery.late, when, due), *notes, *about_time)
    return Chosen(best, when, _row(best.delivery, assignment, best.place, TAKEN, said, when))


def _why_this(best: NotebookInfo, beside: Sequence[NotebookInfo], assignment: str) -> str:
    """Return why a notebook was chosen, and not those beside it, and how to change this."""
    others = first_of([one.file.path[:80] for one in beside], NAMES_SHOWN)
    counts = [one.shared.get(assignment, 0) for one in (best, *beside)]
    why = 'it has the most' if counts[0] > max(counts[1:]) else 'they have equally many'
    return (
        f'{best.file.path} was chosen, not {others}: {why} cells of the assignment. Try: if that '
        f'is wrong, unpack the download, delete {best.file.path[:80]} and collect the folder'
    )


def _is_attempt(one: NotebookInfo, best: NotebookInfo) -> bool:
    """Return whether a notebook is a different attempt, not another file of the same attempt."""
    return one.delivery is not best.delivery or one.file.parts == best.file.parts


def _why_another(one: NotebookInfo, best: NotebookInfo) -> str:
    """Return why a notebook for the same assignment was not selected."""
    if not _is_attempt(one, best):
        return f'{one.file.path[:80]}: {best.file.path} was collected'
    odd = best.shared and not one.shared
    return 'a different notebook was collected' if odd else 'a newer notebook was collected'


def late_notes(late: str, when: datetime | None, due: datetime | None) -> tuple[str, ...]:
    """Return notes about late work; ``late`` names the platform that marks the work as late."""
    if when and due and when > due:
        minutes = int((when - due).total_seconds()) // 60
        parts = ((minutes // 1440, 'd'), (minutes // 60 % 24, 'h'), (minutes % 60, 'min'))
        length = ' '.join(f'{count} {unit}' for count, unit in parts if count)
        return (f'late by {length or "less than a minute"}',)
    unknown = '' if when else NO_TIME
    return (f'late, according to {late}{unknown}',) if late else ()


def _time(best: NotebookInfo, assignment: str) -> tuple[datetime | None, tuple[str, ...]]:
    """Return the time of delivery of a notebook, and notes about this time."""
    if not best.delivery.stamped:
        return best.delivery.when, ()
    beside = (assignment, STAMP)  # nbgrader writes the file only here.
    file = next((one.file for one in best.delivery.files if one.file.parts == beside), None)
    if file is None or best.file.parts[:-1] != beside[:-1]:
        return None, ()
    try:
        when, note = read_time(file.read())
    except UnreadableError as error:
        return None, (f'{file.path}: {error}',)
    # Name the file in the note, because a student may have written it.
    return when, (note or f'time from {file.path}',)


def _others(
    delivery: Delivery,
    notebooks: Sequence[NotebookInfo],
    mine: Mapping[str, Chosen],
    reasons: Mapping[NotebookInfo, str],
    single: bool,
) -> Iterator[Row]:
    """Yield one row for every entry that was not, or only partly, collected."""
    goal = delivery.assignment
    taken = {one.row.place for one in mine.values() if one.notebook.delivery is delivery}
    for place in delivery.places:
        there = [one for one in notebooks if one.place == place]
        left = [
            one
            for one in there
            if one.why
            or place not in taken
            or (not goal and one.about not in ('', *mine))
            or (single and one.content not in ('', goal))
        ]
        about = goal or next((one.about for one in left), '')
        said = [reasons.get(one) or _why_not(one, bool(mine), goal) for one in left]
        if not there and place not in taken:
            names = [one.file.name for one in delivery.files if one.place == place]
            said = [f'no notebook, only {first_of(names, NAMES_SHOWN)}'[:160]]
        if delivery.refused or said:
            why = delivery.refused or first_of(said, NAMES_SHOWN, '; ')
            advice = () if there or delivery.refused else (ASK,)
            late = (f'late, according to {delivery.late}',) if delivery.late else ()
            notes = (why, *advice, *late, *_said(delivery))
            yield _row(delivery, about, place, LEFT, notes, delivery.when)


def _why_not(one: NotebookInfo, chosen: bool, goal: str) -> str:
    """Return why a notebook was not selected; ``chosen`` if another one of the student was."""
    path, about = one.file.path[:80], goal or one.named
    if one.why:
        return f'{path}: {one.why}'
    if one.content:
        return f'wrong assignment: {path} belongs to {one.content}'
    if not about and not chosen:
        return f'{path}: not an assignment of this course; name one with --assignment'
    if goal and one.named not in ('', goal):
        return f'{path}: named like {one.named}, but it contains no cell of {goal}'
    if one.broken:
        return f'{path}: not a notebook, but {one.broken}'
    more = '' if chosen and not one.named else ', and it is not the only notebook'
    return f'{path}: it contains no cell of {about or "this course"}{more}'


def _said(delivery: Delivery) -> tuple[str, ...]:
    """Return the notes of a delivery, and a note if the student id differs from the name."""
    renamed = f'the name was {delivery.student[:60]!r}' if delivery.id != delivery.student else ''
    return (*delivery.notes, *filter(None, (renamed,)))


def _row(
    delivery: Delivery,
    assignment: str,
    place: str,
    done: str,
    notes: tuple[str, ...],
    when: datetime | None,
) -> Row:
    person = '' if delivery.person == delivery.id else delivery.person
    handed_in = f'{when:%Y-%m-%d %H:%M}' if when else ''
    return Row(delivery.id, assignment, place, done, notes, person, handed_in)

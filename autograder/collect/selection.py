"""
Select one notebook per student and assignment.

A *delivery* is everything that one student handed in at one time.  Notebooks with cells of the
assignment take precedence, then the newest delivery.  Within a delivery, the notebook with the
most grade ids of the assignment is selected, regardless of its file name.  Ties
are broken by the file name, and then by the time: the newest attempt is selected.

A notebook without any cell of the course is collected only if no other notebook was handed in for
the assignment: the grader can explain a broken notebook, but private notes must not replace the
answers.

A learning platform exports one assignment at a time.  Without ``--assignment``, this is assumed to
be the one for which most students have a notebook.  So a notebook of lesson 6 that was uploaded to
lesson 7 does not replace a notebook in lesson 6.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from statistics import multimode
from typing import NamedTuple

from autograder.collect.source.course import Course
from autograder.collect.source.deliveries import Handed, Piece
from autograder.collect.source.times import late_notes, read_time, STAMP
from autograder.collect.table import LEFT, Row, TAKEN
from autograder.results import first_of
from autograder.submission.tree import UnreadableError, UnusableUploadError

MOST_NOTEBOOKS = 50
"""Maximum number of notebooks read from one delivery; a clone of the course has about twelve."""
MOST_BYTES_EACH = 256 << 20
NAMES_SHOWN = 3


@dataclass(frozen=True, eq=False)
class Seen:
    """
    Facts about a notebook, without its content: the notebooks of a class may not fit in memory.

    :param handed: the delivery that contains the notebook
    :param shared: number of grade ids in the notebook, by assignment
    :param named: the assignment that the name of the file or folder suggests
    :param why: why the notebook was not read, empty if it was
    """

    handed: Handed
    piece: Piece
    shared: Mapping[str, int] = field(default_factory=dict)
    named: str = ''
    why: str = ''

    @property
    def content(self) -> str:
        """Return the assignment to which most cells belong, or an empty string."""
        return max(self.shared, key=lambda name: (self.shared[name], name), default='')

    @property
    def about(self) -> str:
        """Return the assignment that the cells, or else the name, suggest; empty if none."""
        return self.content or self.named


class Chosen(NamedTuple):
    """
    A notebook that was selected for collection.

    :param when: time of delivery in UTC, None if it is not known
    :param row: its row in the table, before the notebook is written
    """

    seen: Seen
    when: datetime | None
    row: Row


def of_all(seen: Iterable[Sequence[Seen]], course: Course, name: str) -> str:
    """
    Return the assignment that most students handed in, for a source with only one assignment.

    Each student counts once per assignment, even with several notebooks.

    :param seen: the notebooks of each student
    :param name: name of the source, for error messages
    :returns: the assignment, empty if there is no notebook at all
    :raises UnusableUploadError: if no notebook shows an assignment, or if two assignments are
        equally frequent
    """
    students = [one for one in seen if one]
    votes = (found for one in students for found in {each.about for each in one} - {''})
    among = sorted(multimode(votes))
    if len(among) == 1 or not students:
        return ''.join(among)
    got = f'as many cells of {among[1]} as of {among[0]}' if among else 'none of this course'
    raise UnusableUploadError(
        f'{name}: the notebooks do not show which assignment this is: {got}.',
        f'Try: --assignment NAME, with one of {", ".join(among or course.assignments)}',
    )


def choose(
    delivered: Mapping[Handed, Sequence[Seen]],
    course: Course,
    wanted: str = '',
    single: bool = False,
) -> tuple[list[Chosen], list[Row]]:
    """
    Select the notebooks to collect, one per student and assignment.

    :param delivered: the deliveries, each with its notebooks from :func:`look`
    :param wanted: the only assignment to collect; empty to recognise it from the source
    :param single: whether the source is for one assignment, so that notebooks of others are
        mistakes
    :returns: the selected notebooks, and a row for each entry that was not, or only partly,
        collected
    """
    fitting: dict[tuple[str, str], list[Seen]] = {}
    for handed, seen in delivered.items():
        goal = wanted or handed.assignment
        if not _unusable(handed, course, wanted):
            for name in [goal] if goal else sorted({one.about for one in seen} - {''}):
                found = _fitting(seen, name, course, bool(goal))
                fitting.setdefault((handed.id, name), []).extend(found)
    chosen: dict[str, dict[str, Chosen]] = {}
    reasons: dict[Seen, str] = {}
    for (student, assignment), candidates in fitting.items():
        names = {one.handed.called or one.handed.student for one in candidates}
        if len(names) > 1:  # Two students map to one id: collect neither and report the clash.
            why = f'the same student id as {", ".join(map(repr, sorted(names)))}'[:160]
            reasons |= dict.fromkeys(candidates, why)
        elif candidates:
            best = _best(candidates, assignment, course)
            chosen.setdefault(student, {})[assignment] = best
            reasons |= {one: _why_another(one, best.seen) for one in candidates}
    rows: list[Row] = []
    for handed, seen in delivered.items():
        mine = chosen.get(handed.id, {})
        rows += _others(handed, seen, course, mine, reasons, wanted, single)
    return [best for mine in chosen.values() for best in mine.values()], rows


def _unusable(handed: Handed, course: Course, wanted: str) -> str:
    """Return why a delivery cannot be collected, without reading its files; empty if it can."""
    if not handed.id:
        return 'no letter or digit in the name'
    if why := handed.doubt or handed.instead:
        return why
    if wanted and handed.assignment and handed.assignment != wanted:
        return f'handed in for {handed.assignment}'
    if handed.assignment and handed.assignment not in course.assignments:
        return f'{handed.assignment}: not an assignment of this course; name one with --assignment'
    return '' if handed.pieces else 'no file that can be read'


def look(handed: Handed, course: Course, wanted: str = '') -> list[Seen]:
    """Read the notebooks of a delivery within its limits, the most likely ones first."""
    if _unusable(handed, course, wanted):
        return []
    notebooks = [one for one in handed.pieces if one.file.name.lower().endswith('.ipynb')]
    notebooks.sort(key=lambda one: (len(one.file.parts), one.file.parts))
    notebooks.sort(key=lambda one: (not course.of_file(one.file.name), -one.turn))
    seen, left = [], MOST_BYTES_EACH
    for count, piece in enumerate(notebooks):
        one = Seen(handed, piece, named=course.named(piece.file.parts))
        try:
            if count >= MOST_NOTEBOOKS or left <= 0:
                raise UnreadableError(
                    f'not read: only the first {count} notebooks of a delivery are read'
                )
            data = piece.file.read()
            left -= len(data)
            seen.append(replace(one, shared=course.shared(data)))
        except UnreadableError as error:
            seen.append(replace(one, why=str(error)))
    return seen


def _fitting(seen: Sequence[Seen], assignment: str, course: Course, only: bool) -> list[Seen]:
    """
    Return the notebooks of a delivery that may belong to an assignment.

    A notebook without cells of the assignment is returned only if no other notebook qualifies.

    :param only: whether the whole delivery was handed in for this assignment
    """
    if found := [one for one in seen if one.content == assignment]:
        return found
    names = ('', assignment) if only else (assignment,)
    if any(one.why and one.named in names for one in seen):
        return []  # The unreadable notebook may contain the answers.
    named = [one for one in seen if not one.shared and one.named == assignment]
    if not named and only and len(seen) == 1:
        return [one for one in seen if not one.shared and not one.named]
    # If a lesson has no graded cells, only the name can identify its notebook.
    return named if len(named) == 1 or not course.cells[assignment] else []


def _best(candidates: Sequence[Seen], assignment: str, course: Course) -> Chosen:
    """Return the notebook to collect, with notes for the table."""

    def merit(one: Seen) -> tuple[bool, float, int, bool, bool, int, bool, int]:
        file, cells, when = one.piece.file, one.shared.get(assignment, 0), one.handed.when
        return (
            cells > 0,
            when.timestamp() if when else 0.0,
            cells,
            course.of_file(file.name) == assignment,
            assignment in file.parts,
            one.piece.turn,
            file.name == course.file_names[assignment],
            -len(file.parts),
        )

    # Of two files with the same name, consider only the newer one, regardless of its content.
    by_turn = sorted(candidates, key=lambda one: one.piece.turn)
    newest = {(one.handed.places, one.piece.file.parts): one for one in by_turn}
    best = max(newest.values(), key=merit)
    file = best.piece.file
    beside = [one for one in newest.values() if one.handed is best.handed]
    older = [one for one in candidates if one is not best and _is_attempt(one, best)]
    notes = [f'the newest of {len(older) + 1}'] if older else []
    if best.shared and not all(one.shared for one in older):
        notes[0] += ' with a cell of the assignment'
    if len(beside) > 1:
        notes.append(f'{file.path}, one of {len(beside)} notebooks for the assignment')
    notes += _said(best.handed)
    if course.cells[assignment] and not best.shared:
        notes.append('it contains no cell of the assignment')
    if file.name != course.file_names[assignment]:
        notes.append(f'the file was called {file.name[:60]!r}')
    when, about_time = _time(best.handed, best.piece, assignment)
    due = course.due.of(best.handed.id, assignment) if when else None
    late = late_notes(best.handed.late, when, due)
    place = best.piece.place
    row = _row(best.handed, assignment, place, TAKEN, (*late, *notes, *about_time), when)
    return Chosen(best, when, row)


def _is_attempt(one: Seen, best: Seen) -> bool:
    """Return whether a notebook is a different attempt, not another file of the same attempt."""
    return one.handed is not best.handed or one.piece.file.parts == best.piece.file.parts


def _why_another(one: Seen, best: Seen) -> str:
    """Return why a notebook for the same assignment was not selected."""
    if not _is_attempt(one, best):
        return f'{one.piece.file.path[:80]}: {best.piece.file.path} counts'
    odd = best.shared and not one.shared
    return 'a different one was collected' if odd else 'a newer one was collected'


def _time(
    handed: Handed, piece: Piece, assignment: str
) -> tuple[datetime | None, tuple[str, ...]]:
    """Return the time of delivery of a notebook, and notes about this time."""
    if not handed.stamped:
        return handed.when, ()
    beside = (assignment, STAMP)  # nbgrader writes the file only here.
    file = next((one.file for one in handed.pieces if one.file.parts == beside), None)
    if file is None or piece.file.parts[:-1] != beside[:-1]:
        return None, ()
    try:
        when, note = read_time(file.read()[:100].decode('utf-8', 'replace'))
    except UnreadableError as error:
        return None, (f'{file.path}: {error}',)
    # Name the file in the note, because a student may have written it.
    return when, (note or f'time from {file.path}',)


def _others(
    handed: Handed,
    seen: Sequence[Seen],
    course: Course,
    mine: Mapping[str, Chosen],
    reasons: Mapping[Seen, str],
    wanted: str,
    single: bool,
) -> Iterator[Row]:
    """
    Yield one row for every entry that was not, or only partly, collected.

    :param mine: the selected notebooks of the student, by assignment
    :param reasons: known reasons why notebooks were not selected
    """
    goal, why = wanted or handed.assignment, _unusable(handed, course, wanted)
    taken = {one.row.place for one in mine.values() if one.seen.handed is handed}
    for place in handed.places:
        there = [one for one in seen if one.piece.place == place]
        left = [
            one
            for one in there
            if one.why
            or place not in taken
            or (goal in ('', one.about) and one.about not in ('', *mine))
            or (single and one.content not in ('', goal))
        ]
        about = goal or next((one.about for one in left), '')
        said = [reasons.get(one) or _why_not(one, bool(mine), goal) for one in left]
        if not there and place not in taken:
            names = [piece.file.name for piece in handed.pieces if piece.place == place]
            said = [f'no notebook, only {first_of(names, NAMES_SHOWN)}'[:160]]
        if why or said:
            late = late_notes(handed.late, handed.when, None)
            notes = (why or first_of(said, NAMES_SHOWN, '; '), *late, *_said(handed))
            yield _row(handed, about, place, LEFT, notes, handed.when)


def _why_not(one: Seen, chosen: bool, goal: str) -> str:
    """
    Return why a notebook was not selected for any assignment.

    :param chosen: whether another notebook of the student was selected
    """
    path, about = one.piece.file.path[:80], goal or one.named
    if one.why:
        return f'{path}: {one.why}'
    if one.content:
        return f'wrong assignment: {path} is {one.content}'
    if not about and not chosen:
        return f'{path}: not an assignment of this course; name one with --assignment'
    other = goal and one.named not in ('', goal)
    named = f'named like {one.named}, but ' if other else ''
    more = '' if other or (chosen and not one.named) else ', and it is not the only notebook'
    return f'{path}: {named}it contains no cell of {about or "this course"}{more}'


def _said(handed: Handed) -> tuple[str, ...]:
    """Return the notes of a delivery, and a note if the student id differs from the name."""
    renamed = f'the name was {handed.student[:60]!r}' if handed.id != handed.student else ''
    return (*handed.notes, *filter(None, (renamed,)))


def _row(
    handed: Handed,
    assignment: str,
    place: str,
    done: str,
    notes: tuple[str, ...],
    when: datetime | None,
) -> Row:
    person = '' if handed.person == handed.id else handed.person
    handed_in = f'{when:%Y-%m-%d %H:%M}' if when else ''
    return Row(handed.id, assignment, place, done, notes, person, handed_in)

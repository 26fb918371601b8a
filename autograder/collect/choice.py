"""
Choose the notebook of a delivery that counts for each assignment.

Content decides first: the notebook with most grade ids of the assignment counts, whatever its file
is called.  Then the name decides, and then the time: the newest attempt counts.  A notebook
without a cell of the course is collected only if it is the only one delivered for the assignment:
grading can explain a broken notebook, but private notes must not replace the answers.

A learning platform exports one assignment at a time.  Without ``--assignment``, the notebooks of
most students decide which one, so that a notebook of lesson 6 that was uploaded to lesson 7 does
not replace one in lesson 6.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
import hashlib

from autograder.collect.source.course import Course
from autograder.collect.source.deliveries import Handed, Piece
from autograder.collect.source.times import late_notes, read_time, STAMP
from autograder.collect.table import LEFT, Row
from autograder.results import first_of
from autograder.submission.tree import NotTakenInError, UnreadableError

MOST_NOTEBOOKS = 50
"""Limit of notebooks in one delivery; a clone of the course has a dozen."""
MOST_BYTES_EACH = 256 << 20
NAMES_SHOWN = 3


@dataclass(frozen=True)
class Seen:
    """
    Facts about a notebook; the notebooks of a class are too large to hold at once.

    :param digest: SHA-256 of its content
    :param shared: how many grade ids it has of each assignment
    :param named: the assignment that its name or folder suggests
    :param why: why it was not read
    """

    piece: Piece
    digest: str = ''
    shared: Mapping[str, int] = field(default_factory=dict)
    named: str = ''
    why: str = ''

    @property
    def content(self) -> str:
        """Return the assignment that most cells belong to, or an empty string."""
        return max(self.shared, key=lambda name: (self.shared[name], name), default='')


@dataclass(frozen=True)
class Chosen:
    """
    A notebook that can be collected.

    :param digest: SHA-256 of its content
    :param strange: whether it contains no cell of the assignment
    :param when: time of delivery in UTC, None if it is not known
    """

    handed: Handed
    assignment: str
    piece: Piece
    digest: str
    strange: bool
    when: datetime | None
    notes: tuple[str, ...]

    def read(self) -> bytes:
        """
        Return the content; it must be the same as when it was chosen.

        :raises UnreadableError: if the file has changed
        """
        data = self.piece.file.read()
        if hashlib.sha256(data).hexdigest() != self.digest:
            raise UnreadableError('the file changed while it was collected')
        return data

    def row(self, done: str, course: Course, *why: str) -> Row:
        """Return the row of the table, with ``why`` as its first note."""
        due = course.due.of(self.handed.id, self.assignment) if self.when else None
        place = self.piece.place
        return _row(self.handed, self.assignment, place, done, why, self.notes, self.when, due)


def of_all(seen: Iterable[Sequence[Seen]], course: Course, name: str) -> str:
    """
    Return the assignment that most students delivered, if the source is of one assignment.

    Each student counts once per assignment, even with several notebooks.

    :param seen: the notebooks of each student
    :param name: of the source
    :returns: empty if there is no notebook at all
    :raises NotTakenInError: if no notebook shows an assignment, or if two assignments are equally
        frequent
    """
    students = [one for one in seen if one]
    votes = Counter(
        found for one in students for found in {each.content or each.named for each in one} - {''}
    )
    ranked = votes.most_common(2)
    if len(ranked) == 1 or (ranked and ranked[0][1] > ranked[1][1]):
        return ranked[0][0]
    if not students:
        return ''
    got = (
        f'as many cells of {ranked[1][0]} as of {ranked[0][0]}'
        if ranked
        else 'none of this course'
    )
    among = sorted(one for one, count in votes.items() if count == ranked[0][1])
    raise NotTakenInError(
        f'{name}: the notebooks do not show which assignment this is: {got}.',
        f'Try: --assignment NAME, with one of {", ".join(among or course.assignments)}',
    )


def choose(
    handed: Handed, seen: Sequence[Seen], course: Course, wanted: str = '', single: bool = False
) -> tuple[list[Chosen], list[Row]]:
    """
    Find the notebooks in one student's delivery, one for each assignment.

    :param seen: its notebooks, as :func:`look` has found them
    :param wanted: the only assignment to look for; empty to go by the source and the notebooks
    :param single: whether the whole source belongs to this assignment, so that others are mistakes
    :returns: the notebooks, and a row for each entry of the source without one
    """
    goal = wanted or handed.assignment
    if why := _unusable(handed, course, wanted):
        return [], [_left(handed, goal, place, why) for place in handed.places]
    for_what = [goal] if goal else sorted({one.content or one.named for one in seen} - {''})
    picked = (_pick(handed, seen, assignment, course, bool(goal)) for assignment in for_what)
    chosen = [one for one in picked if one is not None]
    lost = set(for_what) - {one.assignment for one in chosen}
    return chosen, list(_others(handed, seen, chosen, goal, lost, single))


def _unusable(handed: Handed, course: Course, wanted: str) -> str:
    """Return why nothing can be collected, before anything is read; empty if something can."""
    if not handed.id:
        return 'no letter or digit in the name'
    if why := handed.doubt or handed.instead:
        return why
    if wanted and handed.assignment and handed.assignment != wanted:
        return f'handed in for {handed.assignment}'
    if handed.assignment and handed.assignment not in course.assignments:
        return f'{handed.assignment}: not an assignment of this course; name one with --assignment'
    return '' if handed.pieces else 'no files'


def look(handed: Handed, course: Course, wanted: str = '') -> list[Seen]:
    """Read the notebooks of a delivery, likely ones first, up to the limit for one student."""
    if _unusable(handed, course, wanted):
        return []
    notebooks = [one for one in handed.pieces if one.file.name.lower().endswith('.ipynb')]
    notebooks.sort(
        key=lambda piece: (
            not course.of_file(piece.file.name),
            -piece.turn,
            len(piece.file.parts),
            piece.file.parts,
        )
    )
    seen, left = [], MOST_BYTES_EACH
    for count, piece in enumerate(notebooks):
        named, digest, shared, why = course.named(piece.file.parts), '', {}, ''
        try:
            if count >= MOST_NOTEBOOKS or left <= 0:
                raise UnreadableError(f'not read: {count} other notebooks come first')
            data = piece.file.read()
            left -= len(data)
            digest, shared = hashlib.sha256(data).hexdigest(), course.shared(data)
        except UnreadableError as error:
            why = str(error)
        seen.append(Seen(piece, digest, shared, named, why))
    return seen


def _pick(
    handed: Handed, seen: Sequence[Seen], assignment: str, course: Course, only: bool
) -> Chosen | None:
    """
    Return the notebook for an assignment, or None if there is none or the choice is unclear.

    :param only: whether everything was handed in for this assignment
    """
    fitting = [one for one in seen if one.content == assignment]
    fitting = fitting or _without_cells(seen, assignment, course, only)
    if not fitting:
        return None
    by_turn = sorted(fitting, key=lambda one: one.piece.turn)
    newest = {one.piece.file.parts: one for one in by_turn}

    def merit(one: Seen) -> tuple[int, bool, bool, int, bool, int]:
        file = one.piece.file
        return (
            one.shared.get(assignment, 0),
            course.of_file(file.name) == assignment,
            assignment in file.parts,
            one.piece.turn,
            file.name == course.file_names[assignment],
            -len(file.parts),
        )

    best = max(newest.values(), key=merit)
    again = sum(one.piece.file.parts == best.piece.file.parts for one in fitting)
    notes = [f'the newest of {again}'] if again > 1 else []
    if len(newest) > 1:
        notes.append(f'{best.piece.file.path} of {len(newest)} notebooks for it')
    return _chosen(handed, best, assignment, course, notes)


def _without_cells(
    seen: Sequence[Seen], assignment: str, course: Course, only: bool
) -> list[Seen]:
    """Return the only notebook delivered for an assignment, if it has none of its cells."""
    names = ('', assignment) if only else (assignment,)
    if any(one.why and one.named in names for one in seen):
        return []  # the unreadable notebook may contain the answers
    named = [one for one in seen if not one.shared and one.named == assignment]
    if not named and only and len(seen) == 1:
        return [one for one in seen if not one.shared and not one.named]
    # If a lesson has no graded cells, only the name can identify its notebook.
    return named if len(named) == 1 or not course.cells[assignment] else []


def _chosen(
    handed: Handed, best: Seen, assignment: str, course: Course, notes: Sequence[str]
) -> Chosen:
    """Return a notebook that can be collected, with notes about it."""
    strange = not best.shared and bool(course.cells[assignment])
    when, about_time = _time(handed, best.piece, assignment)
    name = best.piece.file.name
    said = [*notes, *_said(handed)]
    if strange:
        said.append('it contains no cell of the assignment')
    if name != course.file_names[assignment]:
        said.append(f'the file was called {name[:60]!r}')
    said += about_time
    return Chosen(handed, assignment, best.piece, best.digest, strange, when, tuple(said))


def _time(
    handed: Handed, piece: Piece, assignment: str
) -> tuple[datetime | None, tuple[str, ...]]:
    """Return when a notebook was delivered, and notes about this time."""
    if not handed.stamped:
        return handed.when, ()
    beside = (assignment, STAMP)  # nbgrader's place for it; elsewhere it is some other file
    file = next((one.file for one in handed.pieces if one.file.parts == beside), None)
    if file is None or piece.file.parts[:-1] != beside[:-1]:
        return None, ()
    try:
        when, note = read_time(file.read()[:100].decode('utf-8', 'replace'))
    except UnreadableError as error:
        return None, (f'{file.path}: {error}',)
    # Name the source, because a student may have written this file.
    return when, (note or f'time from {file.path}',)


def _others(
    handed: Handed,
    seen: Sequence[Seen],
    chosen: Sequence[Chosen],
    goal: str,
    lost: Collection[str],
    single: bool,
) -> Iterator[Row]:
    """Yield one row for every entry that was not collected or only partly read."""
    taken = {one.piece.place for one in chosen}
    for place in handed.places:
        there = [one for one in seen if one.piece.place == place]
        about = goal or next((one.content or one.named for one in there), '')
        reasons = [
            _why_not(one, chosen, goal)
            for one in there
            if one.why
            or place not in taken
            or (not one.shared and one.named in lost)
            or (single and one.content not in ('', goal))
        ]
        if not there and place not in taken:
            names = [piece.file.name for piece in handed.pieces if piece.place == place]
            reasons = [f'no notebook, only {first_of(names, NAMES_SHOWN)}'[:160]]
        if reasons:
            yield _left(handed, about, place, first_of(reasons, NAMES_SHOWN, '; '))


def _why_not(one: Seen, chosen: Sequence[Chosen], goal: str) -> str:
    path, about = one.piece.file.path[:80], goal or one.named
    if one.why:
        return f'{path}: {one.why}'
    for rival in chosen:
        if one.content == rival.assignment:
            same = one.piece.file.parts == rival.piece.file.parts
            return 'an earlier one' if same else f'{path}: {rival.piece.file.path} counts'
    if one.content:
        return f'wrong assignment: {path} is {one.content}'
    if not about and not chosen:
        return f'{path}: not an assignment of this course; name one with --assignment'
    other = goal and one.named not in ('', goal)
    named = f'named like {one.named}, but ' if other else ''
    more = '' if other or (chosen and not one.named) else ', and it is not the only notebook'
    return f'{path}: {named}it contains no cell of {about or "this course"}{more}'


def _said(handed: Handed) -> tuple[str, ...]:
    """Return the notes of the source, and a note if the name was changed."""
    return (
        *handed.notes,
        *(() if handed.id == handed.student else (f'the name was {handed.student[:60]!r}',)),
    )


def _left(handed: Handed, assignment: str, place: str, why: str) -> Row:
    return _row(handed, assignment, place, LEFT, (why,), _said(handed), handed.when)


def _row(
    handed: Handed,
    assignment: str,
    place: str,
    done: str,
    first: Sequence[str],
    notes: Sequence[str],
    when: datetime | None,
    due: datetime | None = None,
) -> Row:
    """Return a row of the table, with its first note and whether the work is late."""
    person = '' if handed.person == handed.id else handed.person
    handed_in = f'{when:%Y-%m-%d %H:%M}' if when else ''
    said = (*first, *late_notes(handed.late, when, due), *notes)
    return Row(handed.id, assignment, place, done, said, person, handed_in)

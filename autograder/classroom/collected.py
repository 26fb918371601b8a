"""
Store what ``collect`` knows about the work of each student, in one file.

Platforms accept feedback only under the file names that they generated, which contain the
platform's own numbers.  Work that could not be collected is stored until a submission of that
student is collected.  Otherwise a file in the wrong format would appear only in the table of one
collection, and later reports could not explain why the student is missing.
"""

from collections.abc import Collection, Iterable
from dataclasses import asdict, dataclass, replace
import json
import os

from autograder.classroom.tables import save_json
from autograder.errors import GraderError
from autograder.layout import Layout
from autograder.submission.reading import read_file

NOTHING = 'Nothing handed in'
LONGEST_NAME = 200
KEPT = frozenset('\t\n\r\u200c\u200d')
"""Unprintable characters to keep: line breaks become spaces, and Persian words need joiners."""


@dataclass(frozen=True)
class Work:
    """
    The latest work of a student for an assignment: collected, not collected, or not handed in.

    :param assignment: the assignment, empty if it is not known
    :param person: the student's name, empty if the id is a name
    :param kind: platform of the collected work, such as ``canvas``
    :param place: name of the collected notebook's file or folder in the source
    :param number: the student's numbers in Moodle, one from each activity, separated by spaces
    :param turn: the number of the collected file in Canvas, which is larger for newer files
    :param why: why the work was not collected, without a full stop; empty if it was
    :param handed_in: time of delivery of uncollected work in UTC, empty if it is not known
    :param shared: whether two people have this student id; such an entry is about no work
    """

    student: str
    assignment: str = ''
    person: str = ''
    kind: str = ''
    place: str = ''
    number: str = ''
    why: str = ''
    handed_in: str = ''
    shared: bool = False
    turn: str = ''

    @property
    def reason(self) -> str:
        """Return why the work was not collected, with the time of delivery."""
        if self.why == NOTHING:
            return f'{NOTHING}.'
        when = f' (handed in {self.handed_in} UTC)' if self.handed_in else ''
        return f'Not collected: {self.why}{when}.'


def read_collected(layout: Layout) -> tuple[Work, ...]:
    """
    Return everything that ``collect`` has saved, in the order of the collections.

    :raises GraderError: if the file is damaged or cannot be read, because two people could then
        share an id
    """
    path = layout.collected
    if not os.path.lexists(path):
        return ()
    data, problems = read_file(path, path.name)
    try:
        found = json.loads(data or b'')
        if any(type(value) not in (str, bool) for one in found for value in one.values()):
            raise TypeError
        return tuple(Work(**one) for one in found)
    except (ValueError, RecursionError, TypeError, AttributeError) as error:
        got = problems[0].got if problems else 'something else'
        raise GraderError(
            f'{path}: expected JSON with the work that collect has seen, got {got}.',
            'Try: delete the file, collect all work again, and look for equal names in the tables',
        ) from error


def read_not_collected(layout: Layout) -> tuple[Work, ...]:
    """Return the work that was not collected, of students without a submission since then."""
    found = (one for one in read_collected(layout) if _is_missing(layout, one))
    return tuple(sorted(found, key=lambda one: (one.student, one.assignment)))


def collected_work(layout: Layout, assignment: str) -> dict[str, Work]:
    """Return the collected work for an assignment, by student id."""
    return {
        one.student: one
        for one in read_collected(layout)
        if one.place and one.assignment == assignment
    }


def collected_names(found: Iterable[Work]) -> dict[str, str]:
    """Return the latest name of each student whose work was collected, by student id."""
    return {one.student: one.person for one in found if one.person and not one.why}


def printable_name(name: str) -> str:
    """Return a name as one printable line of limited length."""
    start = name[: 4 * LONGEST_NAME]
    kept = ''.join(char for char in start if char.isprintable() or char in KEPT)
    return ' '.join(kept.split())[:LONGEST_NAME].rstrip()


def save_collected(
    layout: Layout, found: Iterable[Work] = (), without: Collection[Work] = ()
) -> None:
    """
    Add work; it replaces earlier work of the student for the assignment with the same outcome.

    :param without: entries to remove
    :raises GraderError: if the file is damaged
    :raises OSError: if the file cannot be written
    """
    before = read_collected(layout)
    known, names = {_key(one): one for one in before}, collected_names(before)
    for one in sorted(found, key=lambda one: one.handed_in):
        old = known.pop(_key(one), one)
        person = printable_name(one.person) or names.get(one.student, '')
        numbers = dict.fromkeys([*old.number.split(), *one.number.split()])
        known[_key(one)] = replace(one, person=person, number=' '.join(numbers))
    kept = [
        {name: value for name, value in asdict(one).items() if value}
        for one in known.values()
        if one not in without and (not one.why or _is_missing(layout, one))
    ]
    save_json(layout.collected, kept)


def _key(one: Work) -> tuple[str, str, bool]:
    return one.student, one.assignment, bool(one.why)


def _is_missing(layout: Layout, one: Work) -> bool:
    """Return whether work was not collected, and ``submitted/`` still has no notebook for it."""
    folder = layout.submitted / one.student
    return bool(one.why) and not any(folder.glob(f'{one.assignment or "*"}/*.ipynb'))

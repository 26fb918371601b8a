"""
Store the deliveries that ``collect`` saw in a source, and find students without a submission.

Platforms accept feedback only under the file names that they generated, which contain the
platform's own numbers.  A delivery that could not be collected is stored until a submission of
that student is collected.  Otherwise a file in the wrong format would appear only in the table of
one collection, and later reports could not explain why the student is missing.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from autograder.classroom.people import class_list
from autograder.classroom.tables import read_json, save_json
from autograder.layout import Layout
from autograder.submission.ids import student_id

NOTHING = 'Nothing handed in'


@dataclass(frozen=True)
class Delivered:
    """
    The place of a collected notebook in its source.

    :param kind: platform of the source, such as ``canvas``
    :param place: name of the notebook's file or folder in the source
    """

    kind: str
    place: str


@dataclass(frozen=True)
class NotCollected:
    """
    A delivery that was not collected, or a student of the class who has handed in nothing.

    :param assignment: the assignment, empty if it is not known
    :param why: the reason, without a full stop
    :param person: the student's name, empty if the id is a name
    :param handed_in: time of delivery in UTC, empty if it is not known
    """

    student: str
    assignment: str
    why: str
    person: str = ''
    handed_in: str = ''

    @property
    def reason(self) -> str:
        """Return why the work was not collected, with the time of delivery."""
        if self.why == NOTHING:
            return f'{NOTHING}.'
        when = f' (handed in {self.handed_in} UTC)' if self.handed_in else ''
        return f'Not collected: {self.why}{when}.'


def read_delivered(layout: Layout) -> dict[tuple[str, str], Delivered]:
    """
    Return the saved deliveries; empty if their file is missing or damaged.

    :returns: collected notebooks by assignment and student id
    """
    try:
        return {
            (assignment, student): Delivered(str(one['kind']), str(one['place']))
            for assignment, students in (read_json(layout.delivered) or {}).items()
            for student, one in students.items()
        }
    except (KeyError, TypeError, AttributeError):
        return {}


def save_delivered(
    layout: Layout, found: Mapping[tuple[str, str], Delivered], without: str = ''
) -> None:
    """
    Save deliveries; a student's new delivery replaces the old one.

    :param without: a student whose deliveries are removed
    :raises OSError: if the file cannot be written
    """
    data: dict[str, dict[str, dict[str, str]]] = {}
    for (assignment, student), one in sorted({**read_delivered(layout), **found}.items()):
        if student != without:
            data.setdefault(assignment, {})[student] = asdict(one)
    save_json(layout.delivered, data)


def read_not_collected(layout: Layout) -> tuple[NotCollected, ...]:
    """Return the saved entries of students whose work has not been collected since then."""
    try:
        kept = [NotCollected(**one) for one in read_json(layout.not_collected) or ()]
        return tuple(one for one in kept if not _has_submission(layout, one))
    except TypeError:  # The file is damaged.
        return ()


def save_not_collected(layout: Layout, found: Iterable[NotCollected], without: str = '') -> None:
    """
    Add entries; keep only the latest entry per student and assignment.

    :param without: a student whose entries are removed
    :raises OSError: if the file cannot be written
    """
    known = {(one.student, one.assignment): one for one in read_not_collected(layout)}
    for one in sorted(found, key=lambda one: one.handed_in):
        if not _has_submission(layout, one):
            known[one.student, one.assignment] = one
    kept = [asdict(known[key]) for key in sorted(known) if key[0] != without]
    save_json(layout.not_collected, kept)


def not_collected(
    layout: Layout, assignment: str, graded: Collection[str]
) -> tuple[NotCollected, ...]:
    """
    Return the students who are missing from the results of an assignment.

    Their delivery could not be collected, or they are on the class list and handed in nothing.

    :param graded: students who have a result
    :raises GraderError: if the class list is wrong
    """
    names = class_list(layout)
    found = [
        replace(one, person=names.get(one.student) or one.person)
        for one in read_not_collected(layout)
        if one.assignment in ('', assignment) and one.student not in graded
    ]
    # The class list contains ids from collect, but the folder of a submission may be named with
    # the original name: accept both.
    known = {*graded, *map(student_id, graded), *(one.student for one in found)}
    found += [
        NotCollected(student, assignment, NOTHING, name)
        for student, name in names.items()
        if student not in known
    ]
    return tuple(sorted(found, key=lambda one: one.student))


def not_listed(layout: Layout, students: Collection[str]) -> tuple[str, ...]:
    """
    Return the students who are not on the class list; none if there is no list.

    :raises GraderError: if the class list is wrong
    """
    known = class_list(layout)
    here = (one for one in students if known.keys().isdisjoint((one, student_id(one))))
    return tuple(here) if known else ()


def names_for_email(missing: Sequence[NotCollected]) -> str:
    """Return the names or ids of students, separated by commas, for an e-mail to them."""
    return ', '.join(dict.fromkeys(one.person or one.student for one in missing))


def _has_submission(layout: Layout, one: NotCollected) -> bool:
    """Return whether ``submitted/`` contains a notebook of the student for the assignment."""
    return any((layout.submitted / one.student).glob(f'{one.assignment or "*"}/*.ipynb'))

"""
Refuse deliveries whose owner is unclear.

Moodle's exports contain no other id than the name.  If the id were the name alone, two people
would share an id; if it also depended on the other deliveries, one person could get two ids.  So
``collect`` refuses work under a shared name until the instructor adds an id to the names of the
folders.  In each of Moodle's activities, every participant has one number, which no other person
and no other activity has (table ``assign_user_mapping``).  The numbers are saved, because an
export may contain the work of only one of the two.  So a known number is enough to recognise a
student whose folder was renamed earlier.  A known name with a new number is a different person,
or the same person in a second activity for the same work, such as one for late work.  If most
students of an export are known and have new numbers, it is a second activity; a note reports each
of them, because one may still be a different person.  Two people with the same name who never hand
in the same assignment are not detected.

In nbgrader's exchange, every user of the machine can create a folder in ``inbound/`` and name it
after any student, and nbgrader leaves the folder writable for all users.  So the name proves
nothing.  But the file system records the owner of the folder and of each file in it, and a student
cannot change the owner.  The owner must be the student: the user of the same name, or the user
that ``c.ExchangeCollect.owners`` in the settings of the class assigns to the student.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache
import pwd

from autograder.classroom.collected import Work
from autograder.collect.deliveries import Delivery
from autograder.errors import GraderError
from autograder.gradebook.database import load_config
from autograder.layout import Layout

ADVICE = 'if you copied it there yourself, use --trust-names (docs/exchange.md)'


def check_names(
    deliveries: Sequence[Delivery], before: Sequence[Work], trust: bool = False
) -> list[str]:
    """
    Refuse work under a name that two people share, or may share; return the shared ids.

    :param trust: whether a known name with an unknown number is the same person
    """
    numbered = [one for one in deliveries if one.number and one.id]
    earlier = {(one.student, one.assignment): one.number.split() for one in before if one.number}
    here: dict[str, set[str]] = {}
    for one in numbered:
        here.setdefault(one.id, set()).add(one.number)
    renamed = {one: work for one in numbered for work in before if _is_renamed(one, work)}
    shared = {student for student, numbers in here.items() if len(numbers) > 1}
    shared |= {one.id for one in renamed}
    refused = {*shared, *(one.student for one in before if one.shared)}
    new = {one.number for one in numbered if _is_new(one, earlier)}
    second = 2 * len(new) > len({one.number for one in numbered}) > 1
    for one in numbered:
        if work := renamed.get(one):
            one.known, one.person = work.student, work.person or work.student
        elif one.id in refused:
            one.refused = _shared(one)
        elif _is_new(one, earlier) and not trust:
            numbers = ' and '.join(earlier[one.id, one.assignment])
            if second:
                one.notes += (_second_activity(one, numbers),)
            else:
                one.refused = _perhaps_different(one, numbers)
    return sorted(shared)


def _is_renamed(one: Delivery, work: Work) -> bool:
    """Return whether the number of a delivery is known, under a longer name."""
    known = work.assignment == one.assignment and one.number in work.number.split()
    return known and work.student != one.id and one.student in (work.person or work.student)


def _is_new(one: Delivery, earlier: Mapping[tuple[str, str], Sequence[str]]) -> bool:
    """Return whether the student is known for the assignment, but only with other numbers."""
    return one.number not in earlier.get((one.id, one.assignment), (one.number,))


def _shared(one: Delivery) -> str:
    """Return that two people share the name of a delivery, and what to do."""
    name = one.student[:60]
    return (
        f'two people are called {name!r}: unpack the zip, add an id to the names of all folders '
        'or files of both people (one id per person), as in '
        f'"{name} ID_{one.number}_assignsubmission_file", '
        f'and find out whose work is in submitted/{one.id}'
    )


def _second_activity(one: Delivery, earlier: str) -> str:
    """Return that a delivery was taken because most students of the download are known."""
    return (
        f'number {one.number}, earlier {earlier}: taken as a second activity; '
        f'perhaps a different {one.student[:60]!r}'
    )


def _perhaps_different(one: Delivery, earlier: str) -> str:
    """Return that a delivery may be from a different person of this name, and what to do."""
    name = one.student[:60]
    return (
        f'perhaps a different {name!r}: number {one.number} in Moodle, earlier '
        f'{earlier}. Try: if Moodle has two assignments for this work, add '
        '--trust-names; if these are two people, unpack the zip and add an id to the name of the '
        f'folder or file, as in "{name} ID_{one.number}_assignsubmission_file"'
    )


def owner_doubt(student: str, uids: Collection[int], owners: Mapping[str, str]) -> str:
    """
    Return why a delivery may not be the student's, or an empty string.

    :param uids: owners of the folder and all files in it; empty if they are not known
    :param owners: name of the system user by student id, where the two differ
    """
    if not uids:
        return f'handed in as {student!r}, but a zip does not record the owner'
    others = sorted({user_name(uid) for uid in uids} - {owners.get(student, student)})
    if not others:
        return ''
    return f'handed in as {student!r}, but owned by {", ".join(map(repr, others[:3]))}'


@cache
def user_name(uid: int) -> str:
    """Return the name of a system user, ``uid N`` if it has none."""
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return f'uid {uid}'


def check_owners(deliveries: Iterable[Delivery], layout: Layout) -> None:
    """Refuse deliveries that another user owns; raise a GraderError for unusable settings."""
    owners: Mapping[str, str] = {}
    if (layout.root / 'nbgrader_config.py').is_file():
        settings = load_config(layout).ExchangeCollect
        if not settings.get('check_owner', True):
            return
        owners = settings.get('owners', {})
        if not isinstance(owners, Mapping):
            raise GraderError(
                'nbgrader_config.py: c.ExchangeCollect.owners is not a dictionary.',
                "Try: c.ExchangeCollect.owners = {'STUDENT': 'USER'}",
            )
    for one in deliveries:
        if doubt := owner_doubt(one.student, one.owners, owners):
            one.refused = f'{doubt}; {ADVICE}'

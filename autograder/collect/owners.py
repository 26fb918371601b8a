"""
Refuse deliveries whose owner is unclear.

Moodle's exports contain no other id than the name.  If the id were the name alone, two people
would share an id; if it also depended on the other deliveries, one person could get two ids.  So
``collect`` refuses work under a shared name until the instructor adds an id to the names of the
folders.  Moodle numbers the participants of each assignment from scratch, but within an assignment
each person keeps one number.  The numbers are saved, because an export may contain the work of
only one of the two.  Two people with the same name who never hand in the same assignment are not
detected.

In nbgrader's exchange, every user of the machine can create a folder in ``inbound/`` and name it
after any student, and nbgrader leaves the folder writable for all users.  So the name proves
nothing.  But the file system records the owner of the folder and of each file in it, and a student
cannot change the owner.  The owner must be the student: the user of the same name, or the user
that ``c.ExchangeCollect.owners`` in ``nbgrader_config.py`` assigns to the student.
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


def check_names(deliveries: Sequence[Delivery], before: Sequence[Work]) -> list[str]:
    """Refuse work under a name that two people share, or may share; return the shared ids."""
    here: dict[str, set[str]] = {}
    for one in deliveries:
        if one.number and one.id:
            here.setdefault(one.id, set()).add(one.number)
    shared = [student for student, numbers in here.items() if len(numbers) > 1]
    known = {*shared, *(one.student for one in before if one.shared)}
    numbers_before = {(one.student, one.assignment): one.number for one in before if one.number}
    for one in deliveries:
        earlier = numbers_before.get((one.id, one.assignment), one.number)
        one.refused = _doubt(one, one.id in known, earlier) or one.refused
    return shared


def _doubt(one: Delivery, shared: bool, earlier: str) -> str:
    """Return why the owner of a delivery is unclear and what to do, or an empty string."""
    name, number = one.student[:60], one.number
    if number and shared:
        return (
            f'two people are called {name!r}: unpack the zip, add the same id to all folders of '
            f'one person, as in "{name} ID_{number}_assignsubmission_file", and find out '
            f'whose work is in submitted/{one.id}'
        )
    if number and number != earlier:
        return (
            f'perhaps a different {name!r}: number {number} in Moodle, earlier {earlier}; add an '
            f'id to the name of the folder as in "{name} ID_{number}_assignsubmission_file", or, '
            f'if Moodle has two assignments for this work, remove {earlier} from '
            '_work/collected.json'
        )
    return ''


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

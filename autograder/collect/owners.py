"""
Check who owns a delivery in nbgrader's exchange.

Every user of the machine can create a folder in ``inbound/`` and name it after any student, and
nbgrader leaves the folder writable for all users.  So the name proves nothing.  But the file
system records the owner of the folder and of each file in it, and a student cannot change the
owner.  The owner must be the student: the user of the same name, or the user that
``c.ExchangeCollect.owners`` in ``nbgrader_config.py`` assigns to the student.
"""

from collections.abc import Collection, Iterable, Mapping
from functools import cache
import pwd

from autograder.collect.deliveries import Delivery
from autograder.errors import GraderError
from autograder.gradebook.database import load_config
from autograder.layout import Layout

ADVICE = 'if you copied it there yourself, use --trust-names (docs/exchange.md)'


def owner_doubt(student: str, uids: Collection[int], owners: Mapping[str, str]) -> str:
    """
    Return why a delivery may not be the student's, or an empty string.

    :param student: the student named by the folder
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
    """
    Refuse the deliveries of an exchange that another user owns, as nbgrader's settings require.

    :raises GraderError: if the settings cannot be used
    """
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

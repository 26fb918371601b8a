"""
Check who owns a delivery in nbgrader's exchange.

Every user of the machine can create a folder in ``inbound/`` and name it after any student, and
nbgrader leaves it writable for all.  So the name proves nothing, but the system records who
created the folder and each file in it, and a student cannot change that. The owner has to be the
student: the user of that name, or the one that ``c.ExchangeCollect.owners`` in
``nbgrader_config.py`` records.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
import pwd

from autograder.collect.source.deliveries import Handed
from autograder.errors import GraderError
from autograder.gradebook.settings import load_config
from autograder.layout import Layout

ADVICE = 'if you copied it there yourself: --trust-names (docs/exchange.md)'


@dataclass(frozen=True)
class OwnerRule:
    """
    The user who has to own the work of each student.

    :param check: False to trust the names of the folders
    :param owners: name of the system user, by student id, where the two differ
    """

    check: bool = True
    owners: Mapping[str, str] = field(default_factory=dict)

    def doubt(self, student: str, uids: Collection[int]) -> str:
        """
        Return why a delivery may not be the student's, or an empty string.

        :param student: as the name of the folder says
        :param uids: of the folder and all files in it; empty if they are not known
        """
        if not self.check:
            return ''
        if not uids:
            return f'handed in as {student!r}, but a zip does not say who owned it'
        others = sorted({user_name(uid) for uid in uids} - {self.owners.get(student, student)})
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


def owner_rule(layout: Layout, trust_names: bool = False) -> OwnerRule:
    """
    Return the rule of a course, with nbgrader's own settings.

    :param trust_names: whether to check nothing
    :raises GraderError: if the settings cannot be used
    """
    if trust_names:
        return OwnerRule(check=False)
    if not (layout.root / 'nbgrader_config.py').is_file():
        return OwnerRule()
    settings = load_config(layout).ExchangeCollect
    owners = settings.get('owners', {})
    if not isinstance(owners, Mapping):
        raise GraderError(
            'nbgrader_config.py: c.ExchangeCollect.owners is not a dictionary.',
            "Try: c.ExchangeCollect.owners = {'STUDENT': 'USER'}",
        )
    return OwnerRule(bool(settings.get('check_owner', True)), owners)


def with_owners_checked(handed: Iterable[Handed], rule: OwnerRule) -> tuple[Handed, ...]:
    """Return deliveries of an exchange, with a doubt for those that another user owns."""
    doubts = ((one, rule.doubt(one.student, one.owners)) for one in handed)
    return tuple(
        replace(one, doubt=f'{doubt}; {ADVICE}') if doubt else one for one, doubt in doubts
    )

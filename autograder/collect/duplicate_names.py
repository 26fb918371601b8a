"""
Detect two people with the same name in Moodle exports, which contain no other id.

If the id were the name alone, two people would share an id; if it also depended on the other
deliveries, one person could get two ids.  So ``collect`` refuses work under a shared name until
the instructor adds an id to the names of the folders.  Moodle numbers the participants of each
assignment from scratch, but within an assignment each person keeps one number.  The numbers are
saved, because an export may contain the work of only one of the two.

Two people with the same name who never hand in the same assignment are not detected.
"""

from collections.abc import Sequence

from autograder.classroom.collected import Work
from autograder.collect.deliveries import Delivery


def check_names(deliveries: Sequence[Delivery], before: Sequence[Work]) -> list[str]:
    """
    Refuse the deliveries whose owner is unclear.

    :param before: what earlier collections have saved
    :returns: the student ids that two people share in this source
    """
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

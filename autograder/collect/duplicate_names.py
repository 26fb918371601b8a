"""
Detect two people with the same name in Moodle exports, which contain no other id.

If the id were the name alone, two people would share an id; if it also depended on the other
deliveries, one person could get two ids.  So ``collect`` refuses work under a shared name until
the instructor adds an id to the names of the folders.  Moodle numbers the participants of each
assignment from scratch, but within an assignment each person keeps one number.  The numbers are
saved, because an export may contain the work of only one of the two.

Two people with the same name who never hand in the same assignment are not detected.
"""

from collections.abc import Iterable, Sequence
import json
import os
from typing import NamedTuple

from autograder.classroom.tables import save_json
from autograder.collect.source.deliveries import Delivery
from autograder.layout import Layout
from autograder.submission.reading import read_file
from autograder.submission.tree import UnusableUploadError

Numbers = dict[str, dict[str, str]]


class Namesakes(NamedTuple):
    """
    Saved participant numbers and shared student ids.

    :param shared: student ids that belonged to two people in the same source
    :param numbers: number of the participant whose work was collected, by student id and
        assignment
    """

    shared: frozenset[str]
    numbers: Numbers


def read_namesakes(layout: Layout) -> Namesakes:
    """
    Return the saved ids and numbers.

    :raises UnusableUploadError: if the file is damaged or cannot be read, because two people could
        then share an id
    """
    if not os.path.lexists(layout.namesakes):
        return Namesakes(frozenset(), {})
    data, problems = read_file(layout.namesakes, layout.namesakes.name)
    try:
        found = json.loads(data or b'')
        numbers = {student: dict(of_one) for student, of_one in found['numbers'].items()}
        return Namesakes(frozenset(found['shared']), numbers)
    except (ValueError, RecursionError, KeyError, TypeError, AttributeError) as error:
        got = problems[0].got if problems else 'something else'
        raise UnusableUploadError(
            f'{layout.namesakes}: expected JSON with the numbers of people in Moodle, got {got}.',
            'Try: delete the file, collect again, and look for equal names in the table',
        ) from error


def check_names(deliveries: Sequence[Delivery], known: Namesakes) -> Namesakes:
    """Refuse the deliveries whose owner is unclear; return the updated ids and numbers."""
    here: dict[str, set[str]] = {}
    for one in deliveries:
        if one.number and one.id:
            here.setdefault(one.id, set()).add(one.number)
    shared = {student for student, numbers in here.items() if len(numbers) > 1}
    known = known._replace(shared=known.shared | shared)
    for one in deliveries:
        one.refused = _doubt(one, known) or one.refused
    return known


def _doubt(one: Delivery, known: Namesakes) -> str:
    """Return why the owner of a delivery is unclear and what to do, or an empty string."""
    name, number = one.student[:60], one.number
    before = known.numbers.get(one.id, {}).get(one.assignment, number)
    if number and one.id in known.shared:
        return (
            f'two people are called {name!r}: unpack the zip, add the same id to all folders of '
            f'one person, as in "{name} ID_{number}_assignsubmission_file", and find out '
            f'whose work is in submitted/{one.id}'
        )
    if number and before != number:
        return (
            f'perhaps a different {name!r}: number {number} in Moodle, earlier {before}; add an '
            f'id to the name of the folder as in "{name} ID_{number}_assignsubmission_file'
            '", or, if Moodle has two assignments for this work, delete _work/namesakes.json'
        )
    return ''


def save_namesakes(
    layout: Layout, known: Namesakes, taken: Iterable[tuple[Delivery, str]]
) -> None:
    """
    Save the shared ids, and the numbers of the participants whose work was just collected.

    :param taken: collected deliveries, each with its assignment
    :raises OSError: if the file cannot be written
    """
    numbers: Numbers = {student: dict(of_one) for student, of_one in known.numbers.items()}
    for one, assignment in taken:
        if one.number:
            numbers.setdefault(one.id, {})[assignment] = one.number
    if known.shared or numbers or layout.namesakes.exists():
        ordered = {student: dict(sorted(numbers[student].items())) for student in sorted(numbers)}
        save_json(layout.namesakes, {'numbers': ordered, 'shared': sorted(known.shared)})

"""
Detect two people with the same name in exports of Moodle, which have no other id.

The name alone would give two people one id.  An id that also depends on the other deliveries could
give one person two ids.  So ``collect`` does not guess: it refuses work under a name that two
people have until the instructor gives each of them a separate name.  Moodle numbers the
participants of each assignment from scratch, but within one assignment a person keeps the number.
The numbers are saved, because on some days only one of the two has handed in.

This cannot detect two people with the same name who never hand in the same assignment.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
import json

from autograder.collect.source.deliveries import Handed
from autograder.files import json_bytes, keep
from autograder.layout import Layout
from autograder.submission.reading import read_file
from autograder.submission.tree import NotTakenInError

Numbers = dict[str, dict[str, str]]


@dataclass(frozen=True)
class Namesakes:
    """
    The saved numbers and names that are in doubt.

    :param shared: student ids that two people have had in one source
    :param numbers: by student id and assignment, the participant whose work was taken
    """

    shared: frozenset[str] = frozenset()
    numbers: Numbers = field(default_factory=dict)


def read_namesakes(layout: Layout) -> Namesakes:
    """
    Return the saved names and numbers.

    :raises NotTakenInError: if the file is damaged, because without it two people could get one id
    """
    path = layout.namesakes
    data, problems = read_file(path, path.name)
    if data is None and not path.is_symlink() and not path.exists():
        return Namesakes()
    try:
        found = json.loads(data or b'')
        numbers = {
            str(student): {str(name): str(number) for name, number in of_one.items()}
            for student, of_one in found['numbers'].items()
        }
        return Namesakes(frozenset(map(str, found['shared'])), numbers)
    except (ValueError, RecursionError, KeyError, TypeError, AttributeError) as error:
        got = problems[0].got if problems else 'something else'
        raise NotTakenInError(
            f'{path}: expected JSON with the numbers of people in Moodle, got {got}.',
            'Try: delete the file, and look in the table for people with the same name',
        ) from error


def in_doubt(
    handed: Sequence[Handed], known: Namesakes, assignment: str
) -> tuple[list[Handed], Namesakes]:
    """
    Mark deliveries whose owner is unclear.

    :param assignment: what the source was handed in for, empty if that is not known
    :returns: the deliveries with their doubts, and the updated names and numbers
    """
    here: dict[str, set[str]] = {}
    for one in handed:
        if one.number and one.id:
            here.setdefault(one.id, set()).add(one.number)
    shared = known.shared | {student for student, numbers in here.items() if len(numbers) > 1}
    now = replace(known, shared=frozenset(shared))
    return [replace(one, doubt=one.doubt or _doubt(one, now, assignment)) for one in handed], now


def _doubt(one: Handed, known: Namesakes, assignment: str) -> str:
    """Return why the owner of a delivery is unclear and what to do, or an empty string."""
    student, name = one.id, one.student[:60]
    before = known.numbers.get(student, {}).get(assignment, one.number)
    if one.number and student in known.shared:
        return (
            f'two people are called {name!r}: unpack the zip, add an id to the names of their '
            f'folders as in "{name} ID_{one.number}_assignsubmission_file", always the same id, '
            f'and find out whose submitted/{student} is'
        )
    if one.number and before != one.number:
        return (
            f'perhaps another {name!r}: number {one.number} in Moodle, earlier {before}; add an '
            f'id to the name of the folder as in "{name} ID_{one.number}_assignsubmission_file'
            '", or if the same people hand in twice in Moodle, delete _work/namesakes.json'
        )
    return ''


def keep_namesakes(layout: Layout, known: Namesakes, taken: Iterable[tuple[Handed, str]]) -> None:
    """
    Save the names, with the numbers of the students who were collected now.

    :param taken: collected deliveries, each with its assignment
    :raises OSError: if it cannot be written
    """
    numbers: Numbers = {student: dict(of_one) for student, of_one in known.numbers.items()}
    for one, assignment in taken:
        if one.number:
            numbers.setdefault(one.id, {})[assignment] = one.number
    if not known.shared and not numbers and not layout.namesakes.exists():
        return
    ordered = {student: dict(sorted(numbers[student].items())) for student in sorted(numbers)}
    data = json_bytes({'numbers': ordered, 'shared': sorted(known.shared)})
    if data != read_file(layout.namesakes, '')[0]:
        keep(layout.namesakes, data)

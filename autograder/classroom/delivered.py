"""
Remember the names that a platform gave to collected files.

Platforms take feedback back only under these names, which hold numbers of their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
import json

from autograder.files import json_bytes, keep
from autograder.layout import Layout
from autograder.submission.reading import read_file


@dataclass(frozen=True)
class Delivered:
    """
    The place of a collected notebook in its source.

    :param kind: of the source, such as ``canvas``
    :param place: name of its file or folder there
    """

    kind: str
    place: str


Deliveries = Mapping[tuple[str, str], Delivered]
"""By assignment and student id."""


def read_delivered(layout: Layout) -> dict[tuple[str, str], Delivered]:
    """
    Return the names of the last collected deliveries.

    :returns: nothing if the file is missing or damaged
    """
    data, _ = read_file(layout.delivered, layout.delivered.name)
    try:
        return {
            (str(assignment), str(student)): Delivered(str(one['kind']), str(one['place']))
            for assignment, students in json.loads(data or b'{}').items()
            for student, one in students.items()
        }
    except (ValueError, RecursionError, KeyError, TypeError, AttributeError):
        return {}


def keep_delivered(layout: Layout, found: Deliveries) -> None:
    """
    Save names; a new delivery of a student replaces the old one.

    :raises OSError: if they cannot be written
    """
    known = read_delivered(layout)
    if (merged := {**known, **found}) != known:
        _write(layout, merged)


def forget_delivered(layout: Layout, student: str) -> None:
    """
    Remove the names of a student's files.

    :raises OSError: if it cannot be written
    """
    known = read_delivered(layout)
    kept = {key: one for key, one in known.items() if key[1] != student}
    if kept != known:
        _write(layout, kept)


def _write(layout: Layout, found: Deliveries) -> None:
    data: dict[str, dict[str, dict[str, str]]] = {}
    for (assignment, student), one in sorted(found.items()):
        data.setdefault(assignment, {})[student] = asdict(one)
    keep(layout.delivered, json_bytes(data))

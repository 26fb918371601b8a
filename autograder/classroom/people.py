"""Display names of students whose id is a number."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any
import unicodedata

from autograder.classroom.class_list import class_list
from autograder.classroom.collected import read_note
from autograder.errors import GraderError
from autograder.files import json_bytes, keep
from autograder.layout import Layout

LONGEST_NAME = 200
KEPT = frozenset('\t\n\r\u200c\u200d')
"""Unprintable characters to keep: line breaks become spaces, and Persian words need joiners."""


def read_people(layout: Layout) -> dict[str, str]:
    """
    Return the known names, by student id: from the class list, else from ``collect``.

    Platforms shorten names, as Canvas does to ``exampleann``; the list has them as people do.

    :raises GraderError: if the class list is wrong
    """
    return {**saved_people(layout), **_clean(class_list(layout))}


def saved_people(layout: Layout) -> dict[str, str]:
    """Return the names that ``collect`` has saved, by student id; none if they are damaged."""
    found = read_note(layout.people)
    return _clean(found) if isinstance(found, dict) else {}


def student_named(layout: Layout, name: str, students: Collection[str]) -> str:
    """
    Return the id of the student with this id or display name, or an empty string.

    :param students: ids of the students to search
    :raises GraderError: if several students have the name
    """
    if name in students:
        return name
    people = {one: named for one, named in read_people(layout).items() if one in students}
    found = sorted(one for one, named in people.items() if _folded(named) == _folded(name))
    if len(found) > 1:
        raise GraderError(
            f'{name}: {len(found)} students have this name.',
            f'Try: one of the ids {", ".join(found)}',
        )
    return found[0] if found else ''


def _folded(name: str) -> str:
    """Normalise the case and the spaces of a name for comparison."""
    return ' '.join(unicodedata.normalize('NFKC', name).casefold().split())


def keep_people(layout: Layout, names: Mapping[str, str]) -> None:
    """
    Save display names; a new name of a student replaces the old name.

    :param names: names by student id, as written in a source
    :raises OSError: if the file cannot be written
    """
    known = saved_people(layout)
    merged = dict(sorted({**known, **_clean(names)}.items()))
    if merged != known:
        keep(layout.people, json_bytes(merged))


def _clean(names: Mapping[str, Any]) -> dict[str, str]:
    """Return each name as one printable line of limited length; leave out empty names."""
    found = {}
    for student, name in names.items():
        if isinstance(name, str):
            start = name[: 4 * LONGEST_NAME]
            kept = ''.join(char for char in start if char.isprintable() or char in KEPT)
            if shown := ' '.join(kept.split()):
                found[student] = shown[:LONGEST_NAME].rstrip()
    return found

"""
Read Gradescope exports: ``submission_metadata.yml`` and one folder per submission next to it.

The student id is ``sid`` or, if that is missing, ``email``.  A group submission is collected for
each of its students.  Only the metadata file next to the folders is used: a file of the same name
in a folder was uploaded by a student.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
import re
from typing import Any

import yaml

from autograder.collect.source.deliveries import Entry, Handed, Level, System
from autograder.collect.source.times import read_time
from autograder.collect.table import Row, unclaimed
from autograder.submission.tree import File, NotTakenInError, UnreadableError

METADATA = 'submission_metadata.yml'
_FOLDER = re.compile(r'submission_\d+')


def matches(entry: Entry) -> bool:
    """Return whether an entry has a name in Gradescope's form."""
    return bool(_FOLDER.fullmatch(entry.name)) if entry.folder else entry.name == METADATA


def read(level: Level) -> Iterator[Handed | Row]:
    """
    Yield the submissions in the metadata, and a row for each folder that is not listed there.

    :raises NotTakenInError: if the metadata cannot be read
    """
    data = _metadata(level[METADATA].files[0])
    described = {str(folder): facts for folder, facts in data.items()}
    for folder, facts in described.items():
        when, note = read_time(_field(facts, 'created_at'))
        for student, person in _submitters(facts):
            yield Handed(
                student or folder,
                level[folder].pieces() if folder in level else (),
                folder,
                person=person,
                when=when,
                notes=(note,) if note else (),
            )
    for name, entry in level.items():
        if entry.folder and name not in described:
            yield unclaimed(name, f'not in {METADATA}, so its owner is unknown')


def _metadata(file: File) -> Mapping[Any, Any]:
    """Parse the metadata with the safe YAML loader, which creates no Python objects."""
    try:
        data = yaml.safe_load(file.read())
    except (yaml.YAMLError, UnreadableError, RecursionError, ValueError) as error:
        what = ' '.join(str(error).split())[:200]
        raise NotTakenInError(f'{METADATA}: this is not valid YAML: {what}.') from error
    if not isinstance(data, Mapping):
        raise NotTakenInError(f'{METADATA}: this is not a table of submissions.')
    return data


def _submitters(facts: object) -> list[tuple[str, str]]:
    """Return the id and the name of every student of a submission."""
    found = []
    people = _field(facts, 'submitters')
    for person in people if isinstance(people, list) else []:
        student = _text(person, 'sid') or _text(person, 'email')
        found.append((student, _text(person, 'name')))
    return found or [('', '')]


def _text(facts: object, name: str) -> str:
    """Return a field as a string; empty if it is missing or a nested value."""
    value = _field(facts, name)
    return str(value).strip() if isinstance(value, (str, int)) else ''


def _field(facts: object, name: str) -> Any:
    """Return a field; Gradescope writes field names as Ruby symbols, such as ``:email``."""
    if not isinstance(facts, Mapping):
        return None
    return facts.get(f':{name}', facts.get(name))


SYSTEM = System(f'the file {METADATA} and folders next to it', matches, read, needs=METADATA)

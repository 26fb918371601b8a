"""
Gradescope: ``submission_metadata.yml`` and next to it one folder per submission.

The student id is ``sid``, or ``email``; a submission of several students belongs to each of them.
Only the file next to the folders counts: a file of that name *in* a folder is a student's.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
import re
from typing import Any

import yaml

from autograder.collect.source.deliveries import Handed, in_folder, Left, Level
from autograder.collect.source.times import read_time
from autograder.submission.tree import File, NotTakenInError, UnreadableError

METADATA = 'submission_metadata.yml'
EXPECTED = f'the file {METADATA} and folders next to it'
_FOLDER = re.compile(r'submission_\d+')


def claims(level: Level) -> int:
    """Return how many entries have names in Gradescope's form; 0 without its metadata file."""
    if METADATA not in level.files:
        return 0
    return 1 + sum(bool(_FOLDER.fullmatch(name)) for name in level.folders)


def read(level: Level) -> Iterator[Handed | Left]:
    """
    Yield the submissions in the metadata, and the folders that are missing there.

    :raises NotTakenInError: if the table cannot be read
    """
    data = _metadata(level.files[METADATA])
    described = {str(folder): facts for folder, facts in data.items()}
    for folder, facts in described.items():
        when, note = read_time(_field(facts, 'created_at'))
        for student, person in _submitters(facts):
            yield Handed(
                student or folder,
                in_folder(folder, level.folders.get(folder, ())),
                folder,
                person=person,
                when=when,
                notes=(note,) if note else (),
            )
    for folder in level.folders:
        if folder not in described:
            yield Left(folder, f'not in {METADATA}, so its owner is unknown')


def _metadata(file: File) -> Mapping[Any, Any]:
    """Return the metadata; the YAML cannot create Python objects."""
    try:
        data = yaml.safe_load(file.read())
    except (yaml.YAMLError, UnreadableError, RecursionError, ValueError) as error:
        what = ' '.join(str(error).split())[:200]
        raise NotTakenInError(f'{METADATA}: this is not valid YAML: {what}.') from error
    if not isinstance(data, Mapping):
        raise NotTakenInError(f'{METADATA}: this is not a table of submissions.')
    return data


def _submitters(facts: object) -> list[tuple[str, str]]:
    """Return id and name of every student of a submission."""
    found = []
    people = _field(facts, 'submitters')
    for person in people if isinstance(people, list) else []:
        student = _text(person, 'sid') or _text(person, 'email')
        found.append((student, _text(person, 'name')))
    return found or [('', '')]


def _text(facts: object, name: str) -> str:
    """Return a field as a string; a nested value counts as missing."""
    value = _field(facts, name)
    return str(value).strip() if isinstance(value, (str, int)) else ''


def _field(facts: object, name: str) -> Any:
    """Return a field; Gradescope writes its names as Ruby symbols."""
    if not isinstance(facts, Mapping):
        return None
    return facts.get(f':{name}', facts.get(name))

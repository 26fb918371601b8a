"""
Who handed in what, by the names that each system gives to folders and files.

========== ==================================================================================
Canvas     ``NAME_[LATE_]USERID_SUBMISSIONID_FILE``; the student id is the user id, which the
           gradebook file of Canvas names too
Moodle     ``NAME_NUMBER_assignsubmission_file[_]/FILE``; the number is new in each assignment, so
           the student id is the name
Gradescope ``submission_metadata.yml`` and a folder a submission; the id is ``sid``, or ``email``
exchange   nbgrader's ``inbound/USER+ASSIGNMENT+TIMESTAMP[+...]/FILE``
folder     ``STUDENT/...`` with a notebook anywhere below, such as a clone of each one's
           repository, or ``STUDENT.ipynb``
========== ==================================================================================
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime, timezone
import re
from typing import Any

import yaml

from autograder.collect.tree import File, NotCollectedError, Tree, UnreadableError

METADATA = 'submission_metadata.yml'
CANVAS = re.compile(
    r'^(?P<name>[^_]+)_(?P<late>LATE_)?(?P<user>\d+)_(?P<submission>\d+)_(?P<file>.+)$'
)
CANVAS_AGAIN = re.compile(r'-(\d+)(?=\.[^.]+$)')
MOODLE = re.compile(r'^(?P<name>.+)_(?P<number>\d+)_assignsubmission_(?P<kind>file|onlinetext)_?$')
EXCHANGE = re.compile(
    r'^(?P<user>.+?)\+(?P<assignment>[^+]+)\+(?P<when>\d{4}-\d\d-\d\d \d\d:\d\d:\d\d[^+]*)(\+.*)?$'
)
KINDS = ('canvas', 'moodle', 'gradescope', 'exchange', 'folder')


@dataclass(frozen=True)
class Handed:
    """
    What one student handed in at one time.

    :param student: as the source names them; not yet fit for a folder
    :param files: of this submission
    :param place: where in the source
    :param person: a name for people, if the id is none
    :param when: time of delivery in UTC, None if the source does not tell
    :param turn: number of the attempt, as far as the source tells
    :param late: whether the source says so
    :param assignment: if the source names it
    """

    student: str
    files: tuple[File, ...]
    place: str
    person: str = ''
    when: datetime | None = None
    turn: int = 0
    late: bool = False
    assignment: str = ''


def kind_of(tree: Tree) -> str:
    """Return which system a source comes from, by its names."""
    files = tree.files
    if any(file.name == METADATA for file in files):
        return 'gradescope'
    tops = {part for file in files for part in file.parts[:-1]}
    if any(MOODLE.match(part) for part in tops):
        return 'moodle'
    if any(EXCHANGE.match(part) for part in tops):
        return 'exchange'
    named = sum(bool(CANVAS.match(file.name)) for file in files)
    return 'canvas' if named and named * 2 >= len(files) else 'folder'


def handed_in(tree: Tree, kind: str = '') -> list[Handed]:
    """
    Return all that was handed in.

    :param kind: one of :data:`KINDS`, empty to find out
    :raises NotCollectedError: if the source is not what its names say
    """
    kind = kind or kind_of(tree)
    read = {
        'canvas': _canvas,
        'moodle': _moodle,
        'gradescope': _gradescope,
        'exchange': _exchange,
        'folder': _folders,
    }[kind]
    return list(read(tree))


def _canvas(tree: Tree) -> Iterator[Handed]:
    for file in tree.files:
        match = CANVAS.match(file.name)
        if match is None:
            continue
        again = CANVAS_AGAIN.search(match['file'])
        name = CANVAS_AGAIN.sub('', match['file']) if again else match['file']
        renamed = File((name,), file.read)
        yield Handed(
            match['user'],
            (renamed,),
            file.path,
            person=match['name'],
            turn=int(again[1]) if again else 0,
            late=bool(match['late']),
        )


def _moodle(tree: Tree) -> Iterator[Handed]:
    grouped = _grouped(tree.files, MOODLE)
    people: dict[str, set[str]] = {}
    for folder in grouped:
        match = MOODLE.match(folder)
        assert match
        people.setdefault(match['name'], set()).add(match['number'])
    for folder, files in grouped.items():
        match = MOODLE.match(folder)
        assert match
        name = match['name']
        if len(people[name]) > 1:  # two people of one name
            name = f'{name} {match["number"]}'
        yield Handed(name, files, folder)


def _exchange(tree: Tree) -> Iterator[Handed]:
    for folder, files in _grouped(tree.files, EXCHANGE).items():
        match = EXCHANGE.match(folder)
        assert match
        yield Handed(
            match['user'],
            files,
            folder,
            when=_time(match['when']),
            assignment=match['assignment'],
        )


def _grouped(files: Iterable[File], pattern: re.Pattern[str]) -> dict[str, tuple[File, ...]]:
    """Return the files below each folder whose name fits, with paths as seen from there."""
    found: dict[str, list[File]] = {}
    for file in files:
        for depth, part in enumerate(file.parts[:-1]):
            if pattern.match(part):
                found.setdefault(part, []).append(File(file.parts[depth + 1 :], file.read))
                break
    return {folder: tuple(inside) for folder, inside in found.items()}


def _gradescope(tree: Tree) -> Iterator[Handed]:
    described = next(file for file in tree.files if file.name == METADATA)
    try:
        data = yaml.safe_load(described.read())
    except (yaml.YAMLError, UnreadableError, RecursionError) as error:
        what = ' '.join(str(error).split())[:200]
        raise NotCollectedError(f'{described.path}: expected YAML, got: {what}.') from error
    if not isinstance(data, Mapping):
        raise NotCollectedError(f'{described.path}: expected a table of submissions.')
    above = len(described.parts) - 1
    for folder, facts in data.items():
        files = tuple(
            File(file.parts[above + 1 :], file.read)
            for file in tree.files
            if len(file.parts) > above + 1 and file.parts[above] == str(folder)
        )
        for student, person in _submitters(facts):
            when = _time(_field(facts, 'created_at'))
            yield Handed(student or str(folder), files, str(folder), person=person, when=when)


def _submitters(facts: object) -> list[tuple[str, str]]:
    """Return id and name of everybody whose submission it is."""
    found = []
    people = _field(facts, 'submitters')
    for person in people if isinstance(people, list) else []:
        student = _field(person, 'sid') or _field(person, 'email') or ''
        found.append((str(student), str(_field(person, 'name') or '')))
    return found or [('', '')]


def _field(facts: object, name: str) -> Any:
    """Return a field; Gradescope writes its names as Ruby symbols."""
    if not isinstance(facts, Mapping):
        return None
    return facts.get(f':{name}', facts.get(name))


def _time(value: object) -> datetime | None:
    """Return a time in UTC, None for what is none."""
    if isinstance(value, str):
        text = value.strip().replace(' UTC', '+00:00').replace(' Z', '+00:00')
        try:
            value = datetime.fromisoformat(text)
        except ValueError:
            return None
    if not isinstance(value, datetime):
        return None
    return (value if value.tzinfo else value.replace(tzinfo=timezone.utc)).astimezone(timezone.utc)


def _folders(tree: Tree) -> Iterator[Handed]:
    grouped: dict[str, list[File]] = {}
    common = _wrapper(tree)
    for file in tree.files:
        parts = file.parts[common:]
        if len(parts) == 1:
            if file.name.endswith('.ipynb'):
                yield Handed(
                    file.name.removesuffix('.ipynb'), (File(parts, file.read),), file.path
                )
            continue
        grouped.setdefault(parts[0], []).append(File(parts[1:], file.read))
    prefix = len(_shared_prefix(list(grouped)))
    for folder, files in grouped.items():
        yield Handed(folder[prefix:], tuple(files), folder)


def _wrapper(tree: Tree) -> int:
    """Return how many folders are around everything, as some programs pack a zip."""
    tops = {file.parts[0] for file in tree.files}
    below = {file.parts[1] for file in tree.files if len(file.parts) > 2}
    alone = len(tops) == 1 and all(len(file.parts) > 2 for file in tree.files)
    return 1 if alone and len(below) > 1 else 0


def _shared_prefix(names: list[str]) -> str:
    """Return what all repositories of a class begin with, as in ``ASSIGNMENT-STUDENT``."""
    if len(names) < 2:
        return ''
    least, most = min(names), max(names)
    same = next((at for at, char in enumerate(least) if most[at : at + 1] != char), len(least))
    return least[: least.rfind('-', 0, same) + 1]

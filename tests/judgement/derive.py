"""
Derive the mutants, each of which differs from a reference solution in one place.

Operators create most of them from the references; ``mutants.yaml`` adds changes that no operator
makes, and the reasons why a mutant may survive.  Everything is derived in a fixed order from files
of this repository, so the same mutants have the same names everywhere.
"""

import ast
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from tests.judgement.operators import Change, changes
from tests.judgement.references import Exercise, exercises
from tests.judgement.text_operators import BY_SUFFIX

DATA = Path(__file__).with_name('mutants.yaml')
SHOWN = 70  # maximum characters of a change in a mutant's name
MOST = {'missing line': 4, 'text': 2, 'name': 2, 'missing log': 2, 'off by one': 2}
"""Maximum number of a kind in one function or non-Python file; 1 for the kinds in ONCE."""
ONCE = (
    'constant',
    'ends by itself',
    'exception',
    'logger',
    'loop in callback',
    'missing return',
    'missing publish',
    'order',
    'print',
    'private name',
    'sign',
)


@dataclass(frozen=True)
class Mutant:
    """
    A reference solution with one slip.

    :param name: description of the change, unique in its exam
    :param kind: kind of slip
    :param files: all files that the exam judges
    """

    exam: str
    name: str
    kind: str
    files: Mapping[str, str]


@cache
def written() -> Mapping[str, Any]:
    """Return the hand-written data: ``by_hand``, ``leave`` and ``survivors``."""
    return dict(yaml.safe_load(DATA.read_text(encoding='utf-8')))


def mutants_of(exercise: Exercise) -> list[Mutant]:
    """
    Return the mutants of an exercise, without duplicates.

    :raises ValueError: if a hand-written change does not match its reference
    """
    seen = {_meaning(path, text) for path, text in exercise.files.items()}
    counts: dict[str, int] = {}
    kinds: Counter[tuple[str, str, str]] = Counter()
    found = []
    for path, change in _changes(exercise):
        source = exercise.files[path]
        text = source[: change.start] + change.text + source[change.end :]
        meaning = _meaning(path, text)
        if meaning is None or meaning in seen:
            continue
        seen.add(meaning)
        where = change.kind, path, '' if change.kind in ONCE else change.place
        kinds[where] += 1
        if kinds[where] > MOST.get(change.kind, 1 if change.kind in ONCE else 4):
            continue
        name = _name(path, change, source)
        counts[name] = counts.get(name, 0) + 1
        if counts[name] > 1:
            name = f'{name} ({counts[name]})'
        found.append(Mutant(exercise.name, name, change.kind, {**exercise.files, path: text}))
    return found


def all_mutants() -> list[Mutant]:
    """Return the mutants of every graded exercise, in the order of the course."""
    return [mutant for exercise in exercises() for mutant in mutants_of(exercise)]


def _changes(exercise: Exercise) -> Iterator[tuple[str, Change]]:
    """Yield the changes of operators and the hand-written ones, file by file."""
    leave = [one['what'] for one in written()['leave'] if one['exam'] == exercise.name]
    left = {what for group in leave for what in group}
    # A node started in a namespace loses its own; without one, /x and x are the same topic.
    spaced = any('__ns:=' in word for word in exercise.exam.scenario.arguments)
    left.add('namespace' if spaced else 'absolute name')
    for path, source in exercise.files.items():
        if path.endswith('.py'):
            found: Iterable[Change] = changes(source)
        else:
            found = BY_SUFFIX[next(end for end in BY_SUFFIX if path.endswith(end))](source)
        yield from ((path, one) for one in found if not _is_left(one, source, left))
    yield from _by_hand(exercise)


def _is_left(change: Change, source: str, left: set[str]) -> bool:
    """Return whether to skip a change because of its position, its kind or the text it changes."""
    return bool(left & {change.place, change.kind, source[change.start : change.end]})


def _by_hand(exercise: Exercise) -> Iterator[tuple[str, Change]]:
    for one in written()['by_hand']:
        if one['exam'] != exercise.name:
            continue
        path = one.get('file', next(iter(exercise.files)))
        source = exercise.files[path]
        if source.count(one['replace']) != 1:
            raise ValueError(
                f'{DATA.name}, {exercise.name}: expected {one["replace"]!r} once in {path}, '
                f'got {source.count(one["replace"])} times.'
            )
        start = source.index(one['replace'])
        yield path, Change(one['kind'], start, start + len(one['replace']), one['by'])


def _meaning(path: str, text: str) -> str | None:
    """Return a key that equal mutants share, None if the text is not Python."""
    if not path.endswith('.py'):
        return f'{path}\0{text}'
    try:
        compile(text, path, 'exec')
    except SyntaxError:
        return None
    return ast.dump(ast.parse(text))


def _name(path: str, change: Change, source: str) -> str:
    """Return one line that describes the change and its place."""
    where = f'{change.place}(): ' if change.place else ''
    if not path.endswith('.py'):
        where = f'{path}: '
    if path.startswith('answers/'):
        return f'{path}: another letter'  # do not reveal the right letter
    old, new = _one_line(source[change.start : change.end]), _one_line(change.text)
    if not old:
        return f'{where}`{new}` is added'
    return f'{where}`{old}` is missing' if new in ('', 'pass') else f'{where}`{old}` → `{new}`'


def _one_line(text: str) -> str:
    line = ' '.join(text.split())
    return line if len(line) <= SHOWN else f'{line[: SHOWN - 4]} ...'

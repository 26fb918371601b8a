"""
Recognise the platform that a source comes from, and list the deliveries of each student.

Only the names on one level are used: those in the source itself, or in its single outer folder.
Students chose the names further down, and no student may influence how the work of the whole class
is read.  Each entry on that level that is not a submission is listed with a reason.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from autograder.collect.kinds import canvas, exchange, folders, gradescope, moodle
from autograder.collect.source.course import Course
from autograder.collect.source.deliveries import Handed, Level, level, only_folder, System
from autograder.collect.table import Row, unclaimed
from autograder.explaining.feedback import printable
from autograder.results import first_of
from autograder.submission.tree import NotTakenInError, Tree

FOLDER, EXCHANGE = 'folder', 'exchange'
NAMES_SHOWN = 3
SYSTEMS: Mapping[str, System] = {
    'canvas': canvas.SYSTEM,
    'moodle': moodle.SYSTEM,
    'gradescope': gradescope.SYSTEM,
    EXCHANGE: exchange.SYSTEM,
}


@dataclass(frozen=True)
class Found:
    """
    The contents of a source.

    :param kind: the platform, or ``'folder'``
    :param left: a row for each entry that belongs to no known student
    :param single: whether all work is for one assignment, as in exports of learning platforms
    """

    kind: str
    handed: tuple[Handed, ...]
    left: tuple[Row, ...]
    single: bool = False


def handed_in(tree: Tree, course: Course, kind: str = '', prefix: str = '') -> Found:
    """
    Return all deliveries in a source.

    :param kind: a platform, ``'folder'``, or empty to recognise it
    :param prefix: prefix to remove from the names of folders
    :raises NotTakenInError: if ``kind`` or ``prefix`` does not fit the source, or the source is an
        exchange with several courses
    """
    chosen, place = (kind, None) if kind else recognised(tree)
    found: list[Handed | Row] = []
    if system := SYSTEMS.get(chosen):
        if prefix:
            raise NotTakenInError(
                f'{tree.name}: --prefix works only with folders of students; these are names '
                f'from {chosen}.',
                'Try: leave out --prefix',
            )
        if place is None:
            place = next(filter(system.claims, _levels(tree)), level(tree))
        found += system.read(place) if system.claims(place) else ()
        expected, needs = system.expected, system.needs
    else:
        place = folders.level_of(tree, course)
        _refuse_unused(prefix, place, tree.name)
        found += folders.read(place, course, prefix)
        expected, needs = folders.EXPECTED, ''
    handed = tuple(one for one in found if isinstance(one, Handed))
    if kind and not handed:
        raise _nothing(tree, kind, expected)
    left = [one for one in found if isinstance(one, Row)]
    known = {name for one in handed for name in one.places} | {one.place for one in left}
    why = f'not named the way {chosen} names submissions'
    left += [unclaimed(name, why) for name in place if name not in {*known, needs}]
    return Found(chosen, handed, tuple(left), chosen not in (FOLDER, EXCHANGE))


def _refuse_unused(prefix: str, place: Level, where: str) -> None:
    """Refuse a prefix with which no name begins, because the student ids would be wrong."""
    if prefix and not any(name.startswith(prefix) for name in place):
        raise NotTakenInError(
            f'{where}: expected names of students that begin with {printable(prefix)!r} '
            f'(--prefix), got: {_shown(place)}.',
            'Try: leave out --prefix, or give the text that the folder names begin with',
        )


def recognised(tree: Tree) -> tuple[str, Level | None]:
    """Return the platform that recognises most names, and the level with these names."""
    for place in _levels(tree):
        claims = {name: system.claims(place) for name, system in SYSTEMS.items()}
        best = max(claims, key=lambda name: claims[name])
        if 0 < len(place) <= 2 * claims[best]:
            return best, place
    if (inbound := _inbound(tree)) is not None:  # The exchange has no deliveries yet.
        return EXCHANGE, inbound
    courses = level(tree)
    if courses and all(_is_exchange(level(tree, name)) for name in courses):
        raise NotTakenInError(
            f'{tree.name}: this exchange has {len(courses)} courses.',
            'Try: collect the folder of one course, or its inbound/',
        )
    return FOLDER, None


def _levels(tree: Tree) -> Iterator[Level]:
    """Yield the folders whose entries a platform may have named, outermost first."""
    outer = level(tree)
    yield outer
    if name := only_folder(outer):
        yield level(tree, name)
    if (inbound := _inbound(tree)) is not None:
        yield inbound


def _inbound(tree: Tree) -> Level | None:
    """Return the folder ``inbound`` of a course in nbgrader's exchange; None if it is missing."""
    outer = level(tree)
    for base in ((), (only_folder(outer),)):
        if _is_exchange(level(tree, *base)):
            return level(tree, *base, exchange.INBOUND)
    return None


def _is_exchange(place: Level) -> bool:
    """Return whether a folder is a course in nbgrader's exchange."""
    inbound = place.get(exchange.INBOUND)
    return inbound is not None and inbound.folder and place.keys() <= exchange.FOLDERS


def _nothing(tree: Tree, kind: str, expected: str) -> NotTakenInError:
    """Return the error for a source that does not match ``--kind``."""
    *_, place = _levels(tree)
    return NotTakenInError(
        f'{tree.name}: expected submissions of kind {kind} ({expected}), got: {_shown(place)}.',
        'Try: leave out --kind, or collect the source as you downloaded it',
    )


def _shown(names: Iterable[str]) -> str:
    return first_of([printable(name)[:60] for name in names], NAMES_SHOWN) or 'nothing'

"""
Read Canvas exports: files named ``NAME_[LATE_]USER_ATTACHMENT_FILE``, all in one folder.

The student id is the user's number, which is also in Canvas's gradebook file.  With anonymous
grading, the name is ``[LATE_]anon_ID_ATTACHMENT_FILE``; text typed into Canvas is in
``NAME_[LATE_]USER_text.html`` or ``..._link.html``.

A student's name may contain underscores and numbers, so a file name can be ambiguous.  Then the
other files decide: each attachment number belongs to one file, the numbers of an export are close
together, and a user has one name.  If a file name is still ambiguous, the file is not collected.

Source: canvas-lms, lib/content_zipper.rb, which removes numbers between underscores from names.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
import re

from autograder.collect.source.deliveries import Entry, Handed, Level, System
from autograder.collect.table import Row, unclaimed

AGAIN = re.compile(r'-\d+(?=\.[^.]+$)')
_NUMBER = re.compile(r'[1-9][0-9]*')
_ANONYMOUS = re.compile(
    r'(?P<late>LATE_)?(?P<user>anon_[0-9A-Za-z]+)_(?P<later>LATE_)?'
    r'(?:(?P<typed>text|link)\.html|(?P<attachment>[1-9][0-9]*)_(?P<file>.+))'
)
_TYPED = {
    'text': 'the student submitted text instead of a file',
    'link': 'the student submitted a link instead of a file',
}
_SPREAD = 10
"""Maximum ratio of attachment numbers in one assignment; Canvas numbers attachments in order."""


@dataclass(frozen=True)
class Reading:
    """
    One interpretation of a file name.

    :param attachment: number of the attachment as text, empty for text or a link
    :param file: the student's name of the file; ``text`` or ``link`` if there is no file
    """

    name: str
    user: str
    attachment: str
    file: str
    late: bool

    @property
    def anonymous(self) -> bool:
        """Return whether the file comes from an assignment with anonymous grading."""
        return not self.name and self.user.startswith('anon_')


def readings(name: str) -> tuple[Reading, ...]:
    """Return all interpretations of a file name; empty if it does not have Canvas's form."""
    found = []
    if match := _ANONYMOUS.fullmatch(name):
        late = bool(match['late'] or match['later'])
        file = match['file'] or match['typed']
        found.append(Reading('', match['user'], match['attachment'] or '', file, late))
    parts = name.split('_')
    for at in range(1, len(parts) - 1):
        late = parts[at - 1] == 'LATE'
        person, rest = parts[: at - late], parts[at + 1 :]
        if not _NUMBER.fullmatch(parts[at]) or not _may_be_name(person):
            continue
        typed = rest[0].removesuffix('.html')
        if len(rest) == 1 and typed != rest[0] and typed in _TYPED:
            found.append(Reading('_'.join(person), parts[at], '', typed, late))
        elif len(rest) > 1 and _NUMBER.fullmatch(rest[0]):
            file = '_'.join(rest[1:])
            found.append(Reading('_'.join(person), parts[at], rest[0], file, late))
    return tuple(found)


def _may_be_name(parts: Sequence[str]) -> bool:
    """Return whether Canvas could have written these parts as the name of a student."""
    return 'LATE' not in parts and not any(map(_NUMBER.fullmatch, parts[1:-1]))


def matches(entry: Entry) -> bool:
    """Return whether an entry is a file with a name in Canvas's form."""
    return not entry.folder and bool(readings(entry.name))


def read(level: Level) -> Iterator[Handed | Row]:
    """Yield the deliveries of each user, and a row for each ambiguous file."""
    ways = {name: readings(name) for name, entry in level.items() if matches(entry)}
    settled = {name: found[0] for name, found in ways.items() if len(found) == 1}
    users: dict[str, dict[str, Reading]] = {}
    for name, found in ways.items():
        fitting = [settled[name]] if name in settled else _fitting(found, settled, ways)
        if len(fitting) == 1:
            users.setdefault(fitting[0].user, {})[name] = fitting[0]
        else:
            whose = ' or '.join(sorted({f'user {one.user}' for one in found}))
            yield unclaimed(name, f'the owner is unclear: {whose}; rename the file')
    for user, told in users.items():
        notes = (f'user {user}, according to the other files',)
        yield from _of_user(level, user, told, () if told.keys() <= settled.keys() else notes)


def _fitting(
    ways: Sequence[Reading],
    settled: Mapping[str, Reading],
    all_ways: Mapping[str, Sequence[Reading]],
) -> list[Reading]:
    """Return the interpretations of a file name that are consistent with the other files."""
    known = settled.values()
    names = {one.user: one.name for one in known}
    near = [int(one.attachment) for one in known if one.attachment]
    numbers = Counter(
        number for found in all_ways.values() for number in {one.attachment for one in found}
    )

    def is_attachment(number: str) -> bool:
        found = int(number)
        among = not near or (min(near) <= found * _SPREAD and found <= max(near) * _SPREAD)
        return among and numbers[number] == 1

    return [
        one
        for one in ways
        if names.get(one.user, one.name) == one.name
        and (not one.attachment or is_attachment(one.attachment))
        and all(one.anonymous == other.anonymous for other in known)
    ]


def _of_user(
    level: Level, user: str, told: Mapping[str, Reading], notes: tuple[str, ...]
) -> Iterator[Handed]:
    """Yield each typed answer of a user, and all files as one delivery, newest first."""
    late = 'Canvas' if any(one.late for one in told.values()) else ''
    person = max(told.values(), key=lambda one: int(one.attachment or 0)).name
    pieces = []
    for name, one in told.items():
        if one.attachment:
            pieces.append(level[name].piece(AGAIN.sub('', one.file), int(one.attachment)))
        else:
            what = _TYPED[one.file]
            yield Handed(user, (), name, person, late=late, instead=what, notes=notes)
    if pieces:
        pieces.sort(key=lambda piece: piece.turn, reverse=True)
        yield Handed(user, tuple(pieces), '', person, late=late, notes=notes)


SYSTEM = System('files named NAME_USERID_NUMBER_FILE', matches, read)

"""
Describe the names in each platform's exports, and read the deliveries from them.

Canvas names files ``NAME_[LATE_]USER_ATTACHMENT_FILE``, all in one folder.  The student id is the
user's number, which is also in Canvas's gradebook file.  With anonymous grading, the name is
``[LATE_]anon_ID_ATTACHMENT_FILE``; text typed into Canvas is in ``NAME_[LATE_]USER_text.html`` or
``..._link.html``.  A student's name may contain underscores and numbers, so a file name can be
ambiguous.  Then the other files help: each attachment number belongs to one file, the numbers of
an export are close together, and a user has one name.  If a file name is still ambiguous, the file
is not collected.  A submission of a file that was submitted before has a new, larger attachment
number.  Sources: canvas-lms, lib/content_zipper.rb, which removes numbers between underscores from
names, and ``copy_attachments_to_submissions_folder`` in app/models/attachment.rb.

Moodle names folders ``NAME_NUMBER_assignsubmission_file[_]``.  The number differs in each
assignment, so the student id is the name; ``owners`` detects two people with the same name.
With "Download submissions in folders" off, files are named
``NAME_NUMBER_assignsubmission_file_FILE``.  For text typed into Moodle, the names contain
``onlinetext`` instead of ``file``.  Source: moodle, mod/assign/classes/downloader.php, which
removes underscores from names.

Gradescope writes ``submission_metadata.yml`` and one folder per submission next to it.  The
student id is ``sid`` or, if that is missing, ``email``.  A group submission is collected for each
of its students.  Only the metadata file next to the folders is used: a file of the same name in a
folder was uploaded by a student.

nbgrader's exchange has folders ``USER+ASSIGNMENT+TIME[+RANDOM]`` in the folder ``inbound``.
Source: nbgrader 0.9, nbgrader/exchange/default/submit.py.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from datetime import datetime, timezone
import math
import re
from typing import Any, NamedTuple

import yaml

from autograder.collect.deliveries import DeliveredFile, Delivery, Level, Row, System, unclaimed
from autograder.submission.reading import File, UnreadableError, UnusableUploadError

_AGAIN = re.compile(r'-\d+(?=\.[^.]+$)')
_NUMBER = re.compile(r'[1-9][0-9]*')
_END = r'(?:(?P<typed>text|link)\.html|(?P<attachment>[1-9][0-9]*)_(?P<file>.+))'
_NAMED = re.compile(rf'_(?P<user>[1-9][0-9]*)_{_END}')
_ANONYMOUS = re.compile(rf'(?P<late>LATE_)?(?P<user>anon_[0-9A-Za-z]+)_(?P<later>LATE_)?{_END}')
_SPREAD = 10
"""Maximum ratio of attachment numbers in one assignment; Canvas numbers attachments in order."""


class Reading(NamedTuple):
    """
    One interpretation of a file name.

    :param name: name of the student; empty with anonymous grading
    :param attachment: number of the attachment; 0 for text or a link
    :param file: file name that the student chose; ``text`` or ``link`` if there is no file
    """

    name: str
    user: str
    late: bool
    attachment: int
    file: str


def readings(name: str) -> tuple[Reading, ...]:
    """Return all interpretations of a file name; empty if it does not have Canvas's form."""
    if '/' in name:
        return ()  # a folder
    found = []
    if match := _ANONYMOUS.fullmatch(name):
        found.append(('', bool(match['late'] or match['later']), match))
    for mark in re.finditer('_', name):
        if match := _NAMED.fullmatch(name, mark.start()):
            person = name[: mark.start()].split('_')
            if late := person[-1] == 'LATE':
                person.pop()
            # Canvas never writes a name with LATE, or with a number between underscores.
            if 'LATE' not in person and not any(map(_NUMBER.fullmatch, person[1:-1])):
                found.append(('_'.join(person), late, match))
    return tuple(
        Reading(who, at['user'], late, int(at['attachment'] or 0), at['file'] or at['typed'])
        for who, late, at in found
    )


def _read_canvas(level: Level) -> Iterator[Delivery | Row]:
    """Yield the deliveries of each user, and a row for each ambiguous file."""
    ways = {name: found for name, entry in level.items() if (found := readings(entry.path))}
    settled = {name: found[0] for name, found in ways.items() if len(found) == 1}
    users: dict[str, dict[str, Reading]] = {}
    for name, found in ways.items():
        fitting = found if name in settled else _fitting(found, settled.values(), ways.values())
        if len(fitting) == 1:
            users.setdefault(fitting[0].user, {})[name] = fitting[0]
        else:
            whose = ' or '.join(sorted({f'user {one.user}' for one in found}))
            yield unclaimed(name, f'the owner is unclear: {whose}; rename the file')
    for user, entries in users.items():
        yield from _of_user(level, user, entries, entries.keys() <= settled.keys())


def _fitting(
    ways: Sequence[Reading],
    known: Collection[Reading],
    all_ways: Iterable[Sequence[Reading]],
) -> list[Reading]:
    """Return the interpretations of a file name that are consistent with the other files."""
    names = {one.user: one.name for one in known}
    anonymous = {one.user.startswith('anon_') for one in known}
    near = [one.attachment for one in known if one.attachment]
    least, most = min(near, default=0), max(near, default=math.inf)
    numbers = Counter(number for found in all_ways for number in {one.attachment for one in found})
    return [
        one
        for one in ways
        if names.get(one.user, one.name) == one.name
        and anonymous <= {one.user.startswith('anon_')}
        and (not one.attachment or numbers[one.attachment] == 1)
        and (not one.attachment or least <= one.attachment * _SPREAD)
        and one.attachment <= most * _SPREAD
    ]


def _of_user(
    level: Level, user: str, entries: Mapping[str, Reading], certain: bool
) -> Iterator[Delivery]:
    """Yield each typed answer of a user, and all files as one delivery, newest first."""
    late = 'Canvas' if any(one.late for one in entries.values()) else ''
    newest_first = sorted(entries.items(), key=lambda named: named[1].attachment, reverse=True)
    notes = () if certain else (f'user {user}, according to the other files',)
    person = newest_first[0][1].name
    files: list[DeliveredFile] = []
    for name, one in newest_first:
        if one.attachment:
            files += level[name].delivered_files(_AGAIN.sub('', one.file), one.attachment)
        else:
            what = 'a link' if one.file == 'link' else 'text'
            why = f'the student submitted {what} instead of a file'
            yield Delivery(user, (), name, person, late=late, refused=why, notes=notes)
    if files:
        yield Delivery(user, tuple(files), '', person, late=late, notes=notes)


# The student chose the end of a file name, so the name and number are matched as early as
# possible.
_MOODLE = re.compile(
    r'(?P<name>[^/]+?)_(?P<number>\d+)_assignsubmission_(?P<kind>[a-z0-9]+)(_?/|_(?P<file>[^/]+))'
)
_TYPED_INTO_MOODLE = {'file': '', 'onlinetext': 'an online text, which is not collected'}


def _read_moodle(level: Level) -> Iterator[Delivery]:
    """Yield the deliveries of each participant."""
    deliveries: dict[tuple[str, str, str], tuple[str, list[DeliveredFile]]] = {}
    for place, entry in level.items():
        if match := _MOODLE.fullmatch(entry.path):
            key = match['name'], match['number'], match['kind']
            deliveries.setdefault(key, (place, []))[1].extend(
                entry.delivered_files(match['file'] or '')
            )
    for (name, number, kind), (place, found) in deliveries.items():
        why = _TYPED_INTO_MOODLE.get(kind, f'Moodle type {kind}, not a file')
        files = () if why else tuple(found)
        yield Delivery(name, files, place, name, refused=why, number=number)


_TIME = re.compile(r'(\d{4}-\d\d-\d\d)[ T](\d\d:\d\d)(:\d\d)?(?:\.\d+)? ?(\S.*)?')
_ZONE = re.compile(r'UTC|GMT|Z|([+-]\d\d):?(\d\d)?', re.IGNORECASE)


def read_time(value: object) -> tuple[datetime | None, str]:
    """
    Read a time as nbgrader and Gradescope write it.

    Offsets and UTC are accepted, but no other names of time zones: CST alone has four meanings.

    :param value: a string, the content of a file, a datetime from YAML, or None; without a time
        zone it is in UTC
    :returns: the time in UTC or None, and a note if the value was not understood
    """
    try:
        if isinstance(value, datetime):
            found = value if value.tzinfo else value.replace(tzinfo=timezone.utc)
            return found.astimezone(timezone.utc), ''
        if isinstance(value, bytes):
            value = value[:100].decode('utf-8', 'replace')
        text = value.strip() if isinstance(value, str) else ''
        match = _TIME.fullmatch(text)
        if match is None:
            return None, f'time {text[:40]!r} not understood, ignored' if text else ''
        day, minute, second, name = match.groups()
        zone = _ZONE.fullmatch(name or 'UTC')
        if zone is None:
            return None, f'time zone {name[:20]} not understood, ignored'
        offset = f'{zone[1] or "+00"}:{zone[2] or "00"}'
        found = datetime.fromisoformat(f'{day} {minute}{second or ":00"}{offset}')
        return found.astimezone(timezone.utc), ''
    except (ValueError, OverflowError):  # The date does not exist, or is before the year 1.
        return None, f'time {str(value)[:40]!r} not understood, ignored'


METADATA = 'submission_metadata.yml'
_GRADESCOPE = re.compile(rf'submission_\d+/|{re.escape(METADATA)}')


def _read_gradescope(level: Level) -> Iterator[Delivery | Row]:
    """Yield the submissions in the metadata, and a row for each folder that it does not list."""
    described = _metadata(level[METADATA].files[0])
    for folder, facts in described.items():
        when, note = read_time(_field(facts, 'created_at'))
        for student, person in _submitters(facts):
            yield Delivery(
                student or folder,
                level[folder].delivered_files() if folder in level else (),
                folder,
                person=person,
                when=when,
                notes=(note,) if note else (),
            )
    for name, entry in level.items():
        if entry.folder and name not in described:
            yield unclaimed(name, f'not in {METADATA}, so its owner is unknown')


def _metadata(file: File) -> Mapping[str, Any]:
    """Return facts about submissions by folder; the safe YAML loader creates no other objects."""
    try:
        data = yaml.safe_load(file.read())
    except (yaml.YAMLError, UnreadableError, RecursionError, ValueError) as error:
        what = ' '.join(str(error).split())[:200]
        raise UnusableUploadError(f'{METADATA}: this is not valid YAML: {what}.') from error
    if not isinstance(data, Mapping):
        raise UnusableUploadError(f'{METADATA}: this is not a table of submissions.')
    return {str(folder): facts for folder, facts in data.items()}


def _submitters(submission: object) -> list[tuple[str, str]]:
    """Return the id and the name of every student of a submission."""
    people = _field(submission, 'submitters')
    found = []
    for person in people if isinstance(people, list) else ():
        facts = [_field(person, name) for name in ('sid', 'email', 'name')]
        texts = [str(one).strip() if isinstance(one, (str, int)) else '' for one in facts]
        found.append((texts[0] or texts[1], texts[2]))
    return found or [('', '')]


def _field(facts: object, name: str) -> Any:
    """Return a field; Gradescope writes field names as Ruby symbols, such as ``:email``."""
    return facts.get(f':{name}', facts.get(name)) if isinstance(facts, Mapping) else None


INBOUND = 'inbound'
FOLDERS = frozenset({INBOUND, 'outbound', 'feedback'})
"""Folders of each course in an exchange."""
_EXCHANGE = re.compile(
    r'(?P<user>.+?)\+(?P<assignment>[^+]+)\+'
    r'(?P<when>\d{4}-\d\d-\d\d \d\d:\d\d:\d\d(?:\.\d+)?(?: (?:[+-][\d:]+|[^\s+]+))?)(?:\+.*)?/'
)


def _read_exchange(level: Level) -> Iterator[Delivery]:
    """Yield each delivery, with the time in the name of its folder."""
    for name, entry in level.items():
        if match := _EXCHANGE.fullmatch(entry.path):
            when, note = read_time(match['when'])
            yield Delivery(
                match['user'],
                entry.delivered_files(),
                name,
                when=when,
                assignment=match['assignment'],
                notes=(note,) if note else (),
                owners=entry.owners,
            )


EXCHANGE = 'exchange'
SYSTEMS: Mapping[str, System] = {
    'canvas': System('files named NAME_USERID_NUMBER_FILE', readings, _read_canvas),
    'moodle': System(
        'folders or files named NAME_NUMBER_assignsubmission_file_',
        _MOODLE.fullmatch,
        _read_moodle,
    ),
    'gradescope': System(
        f'the file {METADATA} and folders next to it',
        _GRADESCOPE.fullmatch,
        _read_gradescope,
        needs=METADATA,
    ),
    EXCHANGE: System(
        'folders named USER+ASSIGNMENT+TIME, as in inbound/', _EXCHANGE.fullmatch, _read_exchange
    ),
}

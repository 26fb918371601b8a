"""
Recognise the platform that a source comes from, and list the deliveries of each student.

Only the names at one level are used: those in the source itself, or in its single outer folder.
Students chose the names further down, and no student may influence how the work of the whole class
is read.  Each entry at that level that is not a submission is listed with a reason.

If no platform fits, there is one folder or one notebook per student.  Notebooks may be anywhere
below a student's folder.  nbgrader's own layout is ``STUDENT/ASSIGNMENT/NOTEBOOK.ipynb``, with a
``timestamp.txt`` next to the notebook.  The student id is the name of the folder.  If the name of
a cloned repository begins with an assignment, as in ``talk-ann``, that prefix is removed.  A
``timestamp.txt`` in a clone is ignored, because students can edit it.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from contextlib import suppress

from autograder.collect.course import Course
from autograder.collect.deliveries import (
    Delivery,
    Entry,
    Level,
    level,
    NOTEBOOK,
    only_folder,
    Row,
    unclaimed,
    ZIP,
)
from autograder.collect.platforms import EXCHANGE, FOLDERS, INBOUND, SYSTEMS
from autograder.explaining.feedback import printable
from autograder.results import first_of
from autograder.submission.inbox import STAMP
from autograder.submission.reading import Tree, UnreadableError, UnusableUploadError

FOLDER, EXPECTED = 'folder', 'one folder or one notebook per student'
ZIPPED = (
    'a zip file. Try: collect it alone if it is a download; unpack it into a folder with the name '
    'of the student if it is the work of one student'
)
NAMES_SHOWN = 3
FEW = 20
"""Maximum number of notebooks read to distinguish a class from the copies of one student."""


def find_deliveries(
    tree: Tree, course: Course, kind: str = '', prefix: str = ''
) -> tuple[str, list[Delivery], list[Row]]:
    """
    Return all deliveries in a source.

    :param kind: a platform, ``'folder'``, or empty to recognise it
    :param prefix: prefix to remove from the names of folders
    :returns: the platform or ``'folder'``, the deliveries, and a row for each other entry
    :raises UnusableUploadError: if ``kind`` or ``prefix`` does not fit the source, or the source
        is an exchange with several courses
    """
    chosen = kind or recognise_platform(tree)
    if system := SYSTEMS.get(chosen):
        if prefix:
            raise UnusableUploadError(
                f'{tree.name}: --prefix works only with folders of students; these are names '
                f'from {chosen}.',
                'Try: leave out --prefix',
            )
        places = _levels(tree)
        place = next(filter(system.claims, places), places[-1])
        found = [*system.read(place)] if system.claims(place) else []
    else:
        place = _level_of(tree, course)
        if prefix and not any(name.startswith(prefix) for name in place):
            # All student ids would be wrong.
            raise UnusableUploadError(
                f'{tree.name}: expected names of students that begin with {printable(prefix)!r} '
                f'(--prefix), got: {_shown(place)}.',
                'Try: leave out --prefix, or give the text that the folder names begin with',
            )
        found = [_delivery(entry, course, prefix) for entry in place.values()]
    deliveries = [one for one in found if isinstance(one, Delivery)]
    if kind and not deliveries:
        expected = system.expected if system else EXPECTED
        got = _shown(_levels(tree)[-1])
        raise UnusableUploadError(
            f'{tree.name}: expected submissions of kind {kind} ({expected}), got: {got}.',
            'Try: leave out --kind, or collect the source as you downloaded it',
        )
    rows = [one for one in found if isinstance(one, Row)]
    known = {name for one in deliveries for name in one.places} | {one.place for one in rows}
    known |= {system.needs} if system else set()
    why = f'not named the way {chosen} names submissions'
    rows += [unclaimed(name, why) for name in place if name not in known]
    return chosen, deliveries, rows


def recognise_platform(tree: Tree) -> str:
    """Return the platform that most names fit, or ``'folder'``."""
    places = _levels(tree)
    for place in places:
        claims = {name: system.claims(place) for name, system in SYSTEMS.items()}
        best = max(claims, key=lambda name: len(claims[name]))
        if 0 < len(place) <= 2 * len(claims[best]):
            return best
    if any(map(_is_exchange, places)):  # The exchange has no deliveries yet.
        return EXCHANGE
    if places[0] and all(_is_exchange(level(tree, name)) for name in places[0]):
        raise UnusableUploadError(
            f'{tree.name}: this exchange has {len(places[0])} courses.',
            'Try: collect the folder of one course, or its inbound/',
        )
    return FOLDER


def _levels(tree: Tree) -> list[Level]:
    """
    Return the folders whose entries a platform may have named.

    These are the source, its only folder, and finally the folder ``inbound`` of an exchange.
    """
    outer = level(tree)
    bases = [(name,) if name else () for name in dict.fromkeys(('', only_folder(outer)))]
    places = [level(tree, *base) for base in bases]
    inbound = (base for base, place in zip(bases, places) if _is_exchange(place))
    return [*places, *(level(tree, *base, INBOUND) for base in list(inbound)[:1])]


def _is_exchange(place: Level) -> bool:
    """Return whether a folder is a course in nbgrader's exchange."""
    inbound = place.get(INBOUND)
    return inbound is not None and inbound.folder and place.keys() <= FOLDERS


def _shown(names: Iterable[str]) -> str:
    return first_of([printable(name)[:60] for name in names], NAMES_SHOWN) or 'nothing'


def _level_of(tree: Tree, course: Course) -> Level:
    """Return the folder with one entry per student; it may be inside a single outer folder."""
    outer = level(tree)
    name = only_folder(outer)
    if not name or (outer[name].repository and course.beginning(name)):
        return outer  # The only entry is a repository: a class with one student so far.
    inner = level(tree, name)
    return inner if _is_class(inner, course) else outer


def _is_class(inner: Level, course: Course) -> bool:
    """Return whether a folder contains the work of a class, not of one student."""
    theirs = {*course.assignments, course.layout.notebooks.name}
    if len(inner) < 2 or any(inner[name].folder for name in theirs & inner.keys()):
        return False
    files = [entry for entry in inner.values() if not entry.folder]
    return not files or _are_students(files, course)


def _are_students(files: Sequence[Entry], course: Course) -> bool:
    """Return whether files are notebooks of different students: some share an assignment."""
    if not all(NOTEBOOK.search(one.name) and not course.of_file(one.name) for one in files):
        return False
    lessons: Counter[str] = Counter()
    for one in files[:FEW]:
        with suppress(UnreadableError):
            lessons.update(course.shared(one.files[0].read())[0].keys())
    return any(count > 1 for count in lessons.values())


def _delivery(entry: Entry, course: Course, prefix: str) -> Delivery | Row:
    """Return the delivery of a student, or a row if the entry is not a student's."""
    name = entry.name
    if not entry.folder and name.lower().endswith(ZIP):
        return unclaimed(name, ZIPPED)
    if not entry.folder and not NOTEBOOK.search(name):
        return unclaimed(name, "neither a notebook nor a student's folder")
    if entry.folder and name in course.assignments:
        why = 'the name of an assignment, not of a student: collect the folder above'
        return unclaimed(name, why)
    name = name if entry.folder else NOTEBOOK.sub('', name)
    off = prefix if name.startswith(prefix) and name != prefix else ''
    if entry.repository:
        off = off or course.beginning(name)
    notes = [f'{off!r} was removed from the name'] if off else []
    if entry.repository and any(file.name == STAMP for file in entry.files):
        notes.append(f'{STAMP} ignored: in a repository, students can edit it')
    return Delivery(
        name[len(off) :],
        entry.delivered_files(),
        entry.name,
        stamped=not entry.repository,
        notes=tuple(notes),
        called=name,
    )

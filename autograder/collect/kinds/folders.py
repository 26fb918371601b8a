"""
Read a class from one folder per student, or from one notebook per student.

Notebooks may be anywhere below a student's folder.  nbgrader's own layout is
``STUDENT/ASSIGNMENT/NOTEBOOK.ipynb``, with a ``timestamp.txt`` next to the notebook.  The student
id is the name of the folder.  If the name of a cloned repository begins with an assignment, as in
``talk-ann``, that prefix is removed.  A ``timestamp.txt`` in a clone is ignored, because students
can edit it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from autograder.collect.source.course import Course
from autograder.collect.source.deliveries import Entry, Handed, Level, level, only_folder
from autograder.collect.source.times import STAMP
from autograder.collect.table import Row, unclaimed
from autograder.submission.tree import Tree, UnreadableError

EXPECTED = 'one folder or one notebook per student'
NOTEBOOK = '.ipynb'
FEW = 20
"""Maximum number of notebooks read to distinguish a class from the copies of one student."""


def level_of(tree: Tree, course: Course) -> Level:
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
    if not all(one.name.endswith(NOTEBOOK) and not course.of_file(one.name) for one in files):
        return False
    lessons: Counter[str] = Counter()
    for one in files[:FEW]:
        try:
            lessons.update(set(course.shared(one.files[0].read())))
        except UnreadableError:
            continue
    return any(count > 1 for count in lessons.values())


def read(level: Level, course: Course, prefix: str = '') -> Iterator[Handed | Row]:
    """
    Yield the delivery of each student, and a row for each entry that is not a student's.

    Only the name of the entry identifies the student.

    :param prefix: prefix to remove from the names, as given by the instructor
    """
    for name, entry in level.items():
        if not entry.folder and not name.lower().endswith(NOTEBOOK):
            yield unclaimed(name, "neither a notebook nor a student's folder")
        elif entry.folder and name in course.assignments:
            yield unclaimed(
                name, 'the name of an assignment, not of a student: collect the folder above'
            )
        else:
            yield _handed(entry, course, prefix)


def _handed(entry: Entry, course: Course, prefix: str) -> Handed:
    """Return a delivery, with a note if a prefix was removed from the name."""
    name = entry.name if entry.folder else entry.name[: -len(NOTEBOOK)]
    off = prefix if name.startswith(prefix) and name != prefix else ''
    if entry.repository:
        off = off or course.beginning(name)
    notes = [f'{off!r} was removed from the name'] if off else []
    if entry.repository and any(file.name == STAMP for file in entry.files):
        notes.append(f'{STAMP} ignored: in a repository, students can edit it')
    return Handed(
        name[len(off) :],
        entry.pieces(),
        entry.name,
        stamped=not entry.repository,
        notes=tuple(notes),
        called=name,
    )

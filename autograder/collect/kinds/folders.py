"""
One folder per student with notebooks anywhere below, or one notebook per student.

``STUDENT/ASSIGNMENT/NOTEBOOK.ipynb`` is nbgrader's own layout, with a ``timestamp.txt`` next to
the notebook.  The student id is the folder's name.  If the name of a cloned repository begins with
an assignment, as in ``talk-ann``, that prefix is removed.  The student wrote the clone's
``timestamp.txt``, so its time is not used.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping

from autograder.collect.source.course import Course
from autograder.collect.source.deliveries import Handed, in_folder, Left, Level, level, Piece
from autograder.collect.source.times import STAMP
from autograder.submission.tree import File, Tree, UnreadableError

EXPECTED = 'one folder or one notebook per student'
FEW = 20
"""Number of notebooks to read, to distinguish a class from one student's copies."""


def level_of(tree: Tree, course: Course) -> Level:
    """Return the folder whose entries are students; a zip may have an extra folder around it."""
    outer = level(tree)
    if outer.files or len(outer.folders) != 1:
        return outer
    (name,) = outer.folders
    if name in outer.repositories and course.beginning(name):
        return outer  # a class with one student so far
    inner = level(tree, name)
    return inner if _is_class(inner, course) else outer


def _is_class(inner: Level, course: Course) -> bool:
    """Return whether a folder has students in it; otherwise it belongs to one student."""
    theirs = {*course.assignments, course.layout.notebooks.name}
    if len(inner.entries) < 2 or theirs & set(inner.folders):
        return False
    return not inner.files or _are_students(inner.files, course)


def _are_students(files: Mapping[str, File], course: Course) -> bool:
    """Return whether notebooks are named after students: two have cells of one assignment."""
    if not all(name.endswith('.ipynb') and not course.of_file(name) for name in files):
        return False
    lessons: Counter[str] = Counter()
    for file in list(files.values())[:FEW]:
        try:
            lessons.update(set(course.shared(file.read())))
        except UnreadableError:
            continue
    return any(count > 1 for count in lessons.values())


def read(level: Level, course: Course, prefix: str = '') -> Iterator[Handed | Left]:
    """
    Yield the delivery of each student; only the folder's own name decides whose it is.

    :param prefix: the beginning of names that the instructor wants removed
    """
    for name, file in level.files.items():
        if name.lower().endswith('.ipynb'):
            stem = name[: -len('.ipynb')]
            off = _prefix(stem, prefix)
            yield _handed(stem, off, (Piece(file, name),), name)
        else:
            yield Left(name, "neither a notebook nor a student's folder")
    for folder, files in level.folders.items():
        if folder in course.assignments:
            yield Left(
                folder, 'the name of an assignment, not of a student: collect the folder above'
            )
            continue
        repository = folder in level.repositories
        off = _prefix(folder, prefix) or (course.beginning(folder) if repository else '')
        notes: tuple[str, ...] = ()
        if repository and any(file.name == STAMP for file in files):
            notes = (f'{STAMP} ignored: in a repository, students can edit it',)
        yield _handed(folder, off, in_folder(folder, files), folder, not repository, notes)


def _prefix(name: str, prefix: str) -> str:
    """Return the prefix to remove, or nothing if no name would be left."""
    return prefix if name.startswith(prefix) and name != prefix else ''


def _handed(
    name: str,
    off: str,
    pieces: tuple[Piece, ...],
    place: str,
    stamped: bool = False,
    notes: tuple[str, ...] = (),
) -> Handed:
    """Return a delivery, with a note about what was removed from the name."""
    said = (f'{off!r} was removed from the name',) if off else ()
    student = name[len(off) :]
    return Handed(student, pieces, place, stamped=stamped, notes=(*said, *notes), called=name)

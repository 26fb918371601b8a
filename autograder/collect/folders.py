"""
A folder a student with notebooks anywhere below, or a notebook a student.

``STUDENT/ASSIGNMENT/NOTEBOOK.ipynb`` is nbgrader's own layout, with a ``timestamp.txt`` beside the
notebook.  The student id is the folder's name.  A clone of a student's repository loses the name
of an assignment that its own begins with, as ``talk-ann`` does, and its ``timestamp.txt`` is the
student's, so it tells no time.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping

from autograder.collect.course import Course
from autograder.collect.handed import Handed, in_folder, Left, Level, level, Piece
from autograder.collect.times import STAMP
from autograder.collect.tree import File, Tree, UnreadableError

EXPECTED = 'a folder or a notebook a student'
FEW = 20
"""So many notebooks are looked into, to tell a class from one student's copies."""


def level_of(tree: Tree, course: Course) -> Level:
    """Return the folder whose entries are students: some programs pack a zip with one around."""
    outer = level(tree)
    if outer.files or len(outer.folders) != 1:
        return outer
    (name,) = outer.folders
    if name in outer.repositories and course.beginning(name):
        return outer  # on the first day one student's repository is all there is
    inner = level(tree, name)
    return inner if _is_class(inner, course) else outer


def _is_class(inner: Level, course: Course) -> bool:
    """Tell whether a folder has students in it; else it is one student's own."""
    theirs = {*course.assignments, course.layout.notebooks.name}
    if len(inner.entries) < 2 or theirs & set(inner.folders):
        return False
    return not inner.files or _are_students(inner.files, course)


def _are_students(files: Mapping[str, File], course: Course) -> bool:
    """Tell whether notebooks are named by students: two have cells of one assignment."""
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
    Yield what each student handed in; whose it is, the name alone tells, never who else is there.

    :param prefix: what the instructor takes off the names that begin with it
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
            yield Left(folder, "an assignment, no student's name: collect the folder above it")
            continue
        repository = folder in level.repositories
        off = _prefix(folder, prefix) or (course.beginning(folder) if repository else '')
        notes: tuple[str, ...] = ()
        if repository and any(file.name == STAMP for file in files):
            notes = (f"no time from its {STAMP}: in a repository that is the student's own",)
        yield _handed(folder, off, in_folder(folder, files), folder, not repository, notes)


def _prefix(name: str, prefix: str) -> str:
    """Return what is taken off: all of it would leave nobody's name."""
    return prefix if name.startswith(prefix) and name != prefix else ''


def _handed(
    name: str,
    off: str,
    pieces: tuple[Piece, ...],
    place: str,
    stamped: bool = False,
    notes: tuple[str, ...] = (),
) -> Handed:
    """Return a hand-in, which tells what was taken off the name."""
    said = (f'{off!r} was taken off the name',) if off else ()
    student = name[len(off) :]
    return Handed(student, pieces, place, stamped=stamped, notes=(*said, *notes), called=name)

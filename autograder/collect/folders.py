"""
A folder a student with notebooks anywhere below, or a notebook a student.

``STUDENT/ASSIGNMENT/NOTEBOOK.ipynb`` is nbgrader's own layout, with a ``timestamp.txt`` beside the
notebook; clones of each one's repository look alike, and lose what their names begin with.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping

from autograder.collect.course import Course
from autograder.collect.handed import Handed, in_folder, Left, Level, level, Piece
from autograder.collect.tree import File, Tree, UnreadableError

EXPECTED = 'a folder or a notebook a student'
FEW = 20
"""So many notebooks are looked into, to tell a class from one student's copies."""


def level_of(tree: Tree, course: Course) -> Level:
    """Return the folder whose entries are students: some programs pack a zip with one around."""
    outer = level(tree)
    if outer.files or len(outer.folders) != 1:
        return outer
    inner = level(tree, *outer.folders)
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


def read(level: Level, course: Course) -> Iterator[Handed | Left]:
    """Yield what each student handed in."""
    for name, file in level.files.items():
        if name.lower().endswith('.ipynb'):
            yield Handed(name[: -len('.ipynb')], (Piece(file, name),), name)
        else:
            yield Left(name, "neither a notebook nor a student's folder")
    prefix = len(_shared_prefix(level.folders))
    for folder, files in level.folders.items():
        if folder in course.assignments:
            yield Left(folder, "an assignment, no student's name: collect the folder above it")
        else:
            yield Handed(folder[prefix:], in_folder(folder, files), folder, stamped=True)


def _shared_prefix(names: Collection[str]) -> str:
    """Return what all repositories of a class begin with, as in ``ASSIGNMENT-STUDENT``."""
    if len(names) < 2:
        return ''
    least, most = min(names), max(names)
    same = next((at for at, char in enumerate(least) if most[at : at + 1] != char), len(least))
    return least[: least.rfind('-', 0, same) + 1]

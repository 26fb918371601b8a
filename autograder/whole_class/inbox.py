"""
The folder of submitted work: who handed in what.

``submitted/<student>/<assignment>/<notebook>.ipynb``, as nbgrader's collect leaves it.  These
folders were filled from outside, so nothing is followed that could lead elsewhere: only
regular files in real folders, looked at with lstat and opened without following links.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
import os
from pathlib import Path
import stat
import unicodedata

from autograder.handed_in.submission import MAX_BYTES, too_large
from autograder.judging.results import Problem

MAX_NAME_CHARS = 100
# nbgrader globs with the id, splits lists of ids at commas and exports it to CSV unquoted.
_BESIDE_LETTERS = frozenset(' ._@-')
SUBMIT_AGAIN = 'ask the student to submit again'


@dataclass(frozen=True)
class Submission:
    """
    What one student handed in for one assignment.

    :param student: name of the student's folder, the student id of the gradebook
    :param folder: the folder that was looked into
    :param data: content of a notebook that is in no file
    :param problems: what went wrong while looking
    :param recordable: False if the name cannot be an id in the gradebook
    :param path: the notebook's file; a class of them is too much to hold at once
    """

    student: str
    folder: Path
    data: bytes | None = None
    problems: tuple[Problem, ...] = ()
    recordable: bool = True
    path: Path | None = None

    def read(self, where: str) -> tuple[bytes | None, tuple[Problem, ...]]:
        """
        Read the notebook, each time anew: None if there is none to read.

        :param where: how to name the file in messages
        :returns: the content, and what went wrong while looking and reading
        """
        if self.path is None:
            return self.data, self.problems
        data, problems = read_file(self.path, where)
        return data, problems or self.problems


def discover(
    submitted: Path, assignment: str, notebook: str, known: Collection[str] = ()
) -> tuple[Submission, ...]:
    """
    Look into every student's folder, in the order of their names.

    :param submitted: the folder of the class
    :param assignment: name of the assignment's folder
    :param notebook: file name of the released notebook
    :param known: names of all assignments, to tell a misnamed folder from another assignment
    :returns: one entry a student who handed in something that may be meant for it
    :raises OSError: if the folder of the class itself cannot be read
    """
    found = []
    for name in sorted(os.listdir(submitted)):
        folder = submitted / name
        if name.startswith('.') or stat.S_ISREG(os.lstat(folder).st_mode):
            continue  # notes and editor files beside the students' folders
        submission = _student(folder, assignment, notebook, known)
        if submission is not None:
            found.append(submission)
    return tuple(found)


def is_student_id(name: str) -> bool:
    """Tell whether a folder's name can be an id in nbgrader's gradebook."""
    begins = name[:1] == '_' or unicodedata.category(name[:1] or ' ')[0] in 'LN'
    known = all(is_letter(char) or char in _BESIDE_LETTERS for char in name)
    short = len(name) <= MAX_NAME_CHARS and not name.endswith(' ')
    return begins and known and short and name.isprintable()


def is_letter(char: str) -> bool:
    """
    Tell whether a character is a letter or digit of any alphabet, or a sign that belongs to one.

    Regular expressions count no such sign as part of a word, but it may be a name's only vowel.
    """
    return unicodedata.category(char)[0] in 'LMN'


def _student(
    folder: Path, assignment: str, notebook: str, known: Collection[str]
) -> Submission | None:
    """Look into one student's folder; None if there is only work for other assignments."""
    name = folder.name
    readable = name.encode('utf-8', 'surrogateescape').decode('utf-8', 'replace')
    if not is_student_id(name):
        problem = Problem(
            f'submitted/{readable[:MAX_NAME_CHARS]!r}',
            f'a student id of at most {MAX_NAME_CHARS} letters, digits and . _ - @',
            'another folder name, which nbgrader would misread',
            'rename the folder to the student id',
        )
        return Submission(readable[:MAX_NAME_CHARS], folder, None, (problem,), recordable=False)
    where = f'submitted/{name}'
    try:
        if not stat.S_ISDIR(os.lstat(folder).st_mode):
            return Submission(name, folder, None, (_no_folder(where),))
        inside = sorted(os.listdir(folder))
    except OSError as error:
        return Submission(name, folder, None, (_unreadable(where, error),))
    if assignment in inside:
        return open_folder(folder / assignment, name, notebook)
    strange = [entry for entry in inside if entry not in known and not entry.startswith('.')]
    if inside and not strange:
        return None
    got = f'only {", ".join(map(repr, strange[:3]))}'[:120] if strange else 'an empty folder'
    problem = Problem(where, f'a folder {assignment}', got, 'rename the folder, or submit again')
    return Submission(name, folder, None, (problem,))


def open_folder(folder: Path, student: str, notebook: str) -> Submission:
    """
    Find the notebook in one submission folder.

    A single notebook under another name, as browsers make them ("name (1).ipynb"), counts.

    :param folder: ``submitted/<student>/<assignment>``
    :param student: name of the student
    :param notebook: file name of the released notebook
    """
    where = f'submitted/{student}/{folder.name}'
    try:
        if not stat.S_ISDIR(os.lstat(folder).st_mode):
            return Submission(student, folder, None, (_no_folder(where),))
        inside = sorted(os.listdir(folder))
    except OSError as error:
        return Submission(student, folder, None, (_unreadable(where, error),))
    notes: tuple[Problem, ...] = ()
    chosen = notebook
    if notebook not in inside:
        others = [name for name in inside if name.endswith('.ipynb') and name[0] != '.']
        if len(others) != 1:
            got = f'{len(others)} other notebooks' if others else 'no notebook'
            problem = Problem(where, f'the file {notebook}', got, SUBMIT_AGAIN)
            return Submission(student, folder, None, (problem,))
        chosen = others[0]
        got = f'{chosen[:60]!r}, which was graded instead'
        notes = (Problem(where, f'the file {notebook}', got, 'keep the file name next time'),)
    return Submission(student, folder, problems=notes, path=folder / chosen)


def read_file(path: Path, where: str) -> tuple[bytes | None, tuple[Problem, ...]]:
    """
    Read a regular file without following links or waiting for a pipe.

    :param path: the file
    :param where: how to name it in messages
    """
    try:
        kind = os.lstat(path).st_mode
        if not stat.S_ISREG(kind):
            got = 'a symbolic link' if stat.S_ISLNK(kind) else 'something else'
            return None, (Problem(where, 'a regular file', got, SUBMIT_AGAIN),)
        # The file may have been exchanged since lstat, so look again at what was opened.
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        with os.fdopen(descriptor, 'rb') as file:
            now = os.fstat(descriptor)
            if not stat.S_ISREG(now.st_mode):
                return None, (Problem(where, 'a regular file', 'something else', SUBMIT_AGAIN),)
            if now.st_size > MAX_BYTES:
                return None, (too_large(where, now.st_size),)
            return file.read(now.st_size + 1), ()  # reading makes room for what it asks for
    except OSError as error:
        return None, (_unreadable(where, error),)


def _no_folder(where: str) -> Problem:
    """Say that something stands where a folder is needed."""
    return Problem(where, 'a folder', 'a link or a file', SUBMIT_AGAIN)


def _unreadable(where: str, error: OSError) -> Problem:
    """Say why the system does not let us read."""
    reason = (error.strerror or type(error).__name__).lower()
    return Problem(where, 'something that can be read', reason, 'check its permissions')

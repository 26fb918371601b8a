"""
Find the submissions in the folder of a class, and convert names to ids of students.

The path of a submission is ``submitted/<student>/<assignment>/<notebook>.ipynb``, the structure
that nbgrader's collect writes.  The files come from students, so no link is followed: this module
reads only regular files in real folders, checks them with lstat and opens them with O_NOFOLLOW.
"""

from collections.abc import Collection
from dataclasses import dataclass
import hashlib
import os
from pathlib import Path
import re
import stat
import unicodedata

from autograder.results import Problem
from autograder.submission.reading import read_file, SUBMIT_AGAIN, unreadable

STAMP = 'timestamp.txt'
"""nbgrader's file with the time of delivery, next to the notebook."""
SECRET = 'submission_secret.txt'
"""nbgrader's file from which the exchange derives the name of the student's feedback."""
MAX_NAME_CHARS = 100
# nbgrader uses an id as a glob pattern, splits lists of ids at commas, and writes ids to CSV files
# without quotes. So an id may contain only letters, digits and these characters.
_BESIDE_LETTERS = frozenset(' ._@-')
_DIGITS = 12
"""Hexadecimal digits of the digest: enough that the names of a class do not collide by chance."""
_REPLACED = re.compile(rf'.*--[0-9a-f]{{{_DIGITS}}}')


@dataclass(frozen=True)
class Submission:
    """
    One student's submission of one assignment.

    :param student: name of the student's folder, which is the student id in the gradebook
    :param folder: the folder that was searched for the notebook
    :param data: content of the notebook if it is not read from a file
    :param recordable: whether the student's name is a valid id for the gradebook
    :param path: the notebook's file, which is read when needed to save memory
    """

    student: str
    folder: Path
    data: bytes | None = None
    problems: tuple[Problem, ...] = ()
    recordable: bool = True
    path: Path | None = None

    def read(self, where: str) -> tuple[bytes | None, tuple[Problem, ...]]:
        """Read the notebook on each call; return its content, or None, and the problems."""
        if self.path is None:
            return self.data, self.problems
        data, problems = read_file(self.path, where)
        return data, problems or self.problems


def discover(
    submitted: Path, assignment: str, notebook: str, known: Collection[str] = ()
) -> tuple[Submission, ...]:
    """
    Find the submissions of an assignment, sorted by student id.

    :param known: names of all assignments, to distinguish misnamed folders from other assignments
    :returns: one entry per student, without students who submitted only other assignments
    :raises OSError: if the folder of the class itself cannot be read
    """
    names = students_in(submitted, {assignment, *known})
    found = (_student(submitted / name, assignment, notebook, known) for name in names)
    return tuple(one for one in found if one is not None)


def students_in(submitted: Path, assignments: Collection[str]) -> list[str]:
    """
    Return the sorted names of the students' folders: those with a notebook of the course.

    A folder without such a notebook may not belong to a student: it may be part of a raw download,
    or contain a whole class one level deeper.

    :raises OSError: if the folder of the class cannot be read
    """
    return [one for one in _folders(submitted) if _has_notebook(submitted / one, assignments)]


def without_notebooks(submitted: Path, assignments: Collection[str]) -> list[str]:
    """Return the sorted names of the folders without a notebook of the course."""
    return [one for one in _folders(submitted) if not _has_notebook(submitted / one, assignments)]


def _folders(submitted: Path) -> list[str]:
    """Return the names of possible students' folders, without regular and hidden files."""
    return [
        name
        for name in sorted(os.listdir(submitted))
        if name[0] != '.' and not stat.S_ISREG(os.lstat(submitted / name).st_mode)
    ]


def _has_notebook(folder: Path, assignments: Collection[str]) -> bool:
    """
    Return whether a student's folder contains a notebook of an assignment, readable or not.

    A link instead of an assignment's folder also counts, so that it is reported; it is not
    followed.
    """
    if os.path.islink(folder):
        return False
    places = [folder / one for one in assignments]
    names = [name for one in places for name in _inside(one, '')[0]]
    return any(map(os.path.islink, places)) or any(name.endswith('.ipynb') for name in names)


def is_student_id(name: str) -> bool:
    """Return whether a folder's name is a valid student id for nbgrader's gradebook."""
    begins = name[:1] == '_' or unicodedata.category(name[:1] or ' ')[0] in 'LN'
    known = all(is_letter(char) or char in _BESIDE_LETTERS for char in name)
    short = len(name) <= MAX_NAME_CHARS and not name.endswith(' ')
    return begins and known and short and name.isprintable()


def is_letter(char: str) -> bool:
    """
    Return whether a character is a letter, a digit or a combining character of any alphabet.

    Regular expressions do not treat combining characters as letters, but some alphabets write
    vowels with them.
    """
    return unicodedata.category(char)[0] in 'LMN'


def named_id(text: str) -> str:
    """
    Return the student id for the name or the student id that an instructor gives.

    :func:`student_id` would replace even an id that it has created itself, because it cannot know
    that the text is not a name.
    """
    return text if is_student_id(text) and _REPLACED.fullmatch(text) else student_id(text)


def student_id(name: str) -> str:
    """
    Return a student id for a name: the name itself if it is valid, else one with a digest.

    Letters of all alphabets are kept, with their combining characters.  If characters must be
    replaced, the id ends with a digest of the name.  So different names have different ids, and an
    id does not depend on the other students.  A name without a letter or digit has the id ''.
    """
    text = unicodedata.normalize('NFC', name)
    kept = ''.join(char if is_letter(char) or char in ' .@-' else '_' for char in text)
    kept = kept.strip(' ._-@')
    # Drop combining characters without their letter.
    while kept and unicodedata.category(kept[0])[0] == 'M':
        kept = kept[1:].lstrip(' ._-@')
    if not kept:
        return ''
    if is_student_id(text) and not _REPLACED.fullmatch(text):
        return text
    digest = hashlib.sha256(text.encode('utf-8', 'surrogatepass')).hexdigest()[:_DIGITS]
    return f'{kept[: MAX_NAME_CHARS - _DIGITS - 2].rstrip()}--{digest}'


def _student(
    folder: Path, assignment: str, notebook: str, known: Collection[str]
) -> Submission | None:
    """Return the submission in a student's folder; None if it has only other assignments."""
    name = folder.name
    readable = name.encode('utf-8', 'surrogateescape').decode('utf-8', 'replace')
    if not is_student_id(name):
        problem = Problem(
            f'submitted/{readable[:MAX_NAME_CHARS]!r}',
            f'a student id of at most {MAX_NAME_CHARS} letters, digits and . _ - @',
            'a folder name that nbgrader would misread',
            'rename the folder to the student id',
        )
        return Submission(readable[:MAX_NAME_CHARS], folder, None, (problem,), recordable=False)
    where = f'submitted/{name}'
    inside, problems = _inside(folder, where)
    if problems:
        return Submission(name, folder, None, problems)
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
    Find the notebook in one submission folder, ``submitted/<student>/<assignment>``.

    If the folder has only one notebook, a different name such as "name (1).ipynb" is accepted.
    """
    where = f'submitted/{student}/{folder.name}'
    inside, problems = _inside(folder, where)
    if problems:
        return Submission(student, folder, None, problems)
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


def _inside(folder: Path, where: str) -> tuple[list[str], tuple[Problem, ...]]:
    """Return the sorted names in a folder, or the problem if it is a link or unreadable."""
    try:
        if stat.S_ISDIR(os.lstat(folder).st_mode):
            return sorted(os.listdir(folder)), ()
    except OSError as error:
        return [], (unreadable(where, error),)
    return [], (Problem(where, 'a folder', 'a link or a file', SUBMIT_AGAIN),)

"""
Read the files that exams judge from a package folder on disk.

Node files may be in the top folder or, as in every Python ROS package, in the folder with the
package's name.  No link is followed: a package with a link is refused.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from autograder.exam.exam import Exam
from autograder.results import ExamResult, first_of
from autograder.submission.reading import read_file
from autograder.submission.tree import NotTakenInError

MAX_FILES = 200
NOTEBOOK_KINDS = ('.py', '.msg', '.srv', '.action', '.xml', '.txt', '.cfg', '.toml', '.yaml')
"""Suffixes of the files that cells of a lesson save."""

KINDS = (
    *NOTEBOOK_KINDS,
    *('', '.md', '.rst', '.in', '.cmake', '.json', '.yml', '.sh', '.launch'),
    *('.h', '.hpp', '.c', '.cpp'),
)
"""Suffixes of files that a build may need; the marker in ``resource/`` has no suffix."""


LEFT_OUT = {'build', 'install', 'log', '__pycache__', '__MACOSX', 'node_modules'}
"""Names of folders that tools generate; their content is not the student's work."""


def is_left_out(name: str) -> bool:
    """Return whether a file or folder of this name is hidden or generated."""
    return name in LEFT_OUT or (name.startswith('.') and name not in ('.', '..'))


def read_package(folder: Path) -> dict[str, str]:
    """
    Return the texts of a package's files by the paths that exams use.

    :param folder: the package, or a folder with the same structure
    :raises NotTakenInError: if a file or folder is a link
    """
    found: dict[str, str] = {}
    for path in sorted(folder.rglob('*')):
        inside = path.relative_to(folder)
        if any(map(is_left_out, inside.parts)):
            continue
        if path.is_symlink():
            fix = 'Try: replace the link by a copy of its target'
            raise NotTakenInError(f'{path}: expected a file or folder, got a link.', fix)
        if path.suffix not in NOTEBOOK_KINDS or not path.is_file():
            continue
        if path.suffix == '.py' and len(inside.parts) > 1 and inside.parts[0] != 'test':
            inside = Path(*inside.parts[1:])
        data, problems = read_file(path, str(inside))
        if data is not None and not problems and len(found) < MAX_FILES:
            found.setdefault(inside.as_posix(), data.decode('utf-8', 'replace'))
    return found


def own_files(exam: Exam, files: Mapping[str, str]) -> dict[str, str]:
    """
    Return the files that an exam needs, from all files that a notebook has saved.

    A message package is built without the nodes of later exercises, as in grading, so editing a
    node does not cause a new build.

    :param files: from :func:`read_package`
    """
    if exam.scenario.program != 'build' or any(name.endswith('.py') for name in exam.requires):
        return dict(files)
    return {name: text for name, text in files.items() if not name.endswith('.py')}


def what_is_there(files: Mapping[str, str]) -> str:
    """Return the names of the first files of a package, for a message about a missing file."""
    if not files:
        return 'no file of a package'
    names = [name if name.isprintable() else repr(name) for name in files]
    return f'only {first_of(names, 8)}'


def name_missing(result: ExamResult, files: Mapping[str, str]) -> ExamResult:
    """
    Return a result whose message about a missing file does not mention a notebook's cells.

    :param result: the exam's result for these files
    """
    return with_missing_file(
        result,
        observed=what_is_there(files),
        cause='The file was not saved in the folder that is checked.',
        try_this='Save it there, then check again.',
    )


def with_missing_file(result: ExamResult, **words: str) -> ExamResult:
    """
    Return a result with a different message about a missing file.

    :param words: fields of :class:`~autograder.results.CheckResult` to replace
    """
    checks = [
        replace(check, **words) if check.cause_id == 'missing_file' else check  # type: ignore[arg-type]
        for check in result.checks
    ]
    return replace(result, checks=tuple(checks))

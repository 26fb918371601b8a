"""
A package folder on disk as the files that exams judge.

Nodes may lie at the top or, as in every Python ROS package, in the folder named like the package;
links are not followed.
"""

from __future__ import annotations

from pathlib import Path

from autograder.inbox import read_file

MAX_FILES = 200
KINDS = ('.py', '.msg', '.srv', '.action', '.xml', '.txt', '.cfg', '.toml', '.yaml')


def read_package(folder: Path) -> dict[str, str]:
    """
    Return the texts of a package by the paths that the exams use.

    :param folder: the package, or any folder laid out like one
    """
    found: dict[str, str] = {}
    for path in sorted(folder.rglob('*')):
        inside = path.relative_to(folder)
        if any(part.startswith(('.', '__pycache__')) for part in inside.parts):
            continue
        if path.suffix not in KINDS or path.is_symlink() or not path.is_file():
            continue
        if path.suffix == '.py' and len(inside.parts) > 1 and inside.parts[0] != 'test':
            inside = Path(*inside.parts[1:])
        data, problems = read_file(path, str(inside))
        if data is not None and not problems and len(found) < MAX_FILES:
            found.setdefault(inside.as_posix(), data.decode('utf-8', 'replace'))
    return found

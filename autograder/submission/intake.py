"""
Read submissions other than notebooks: a Python script, a ROS package folder, or a zip of one.

The result is the text of each file by its relative path.  A zip is never unpacked on the grader's
disk (:mod:`autograder.submission.tree`).  A folder or zip that contains a link, a special file or
an unsafe path is refused: without the linked file, the grader would judge another program.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath
import re

from autograder.submission.package import is_left_out, KINDS
from autograder.submission.reading import read_file
from autograder.submission.tree import (
    Bounds,
    NotTakenInError,
    opened,
    UnreadableError,
)

MOST_ENTRIES = 2000
MOST_FILES = 200
LARGEST_ZIP = 8 << 20
LARGEST_FILE = 1 << 20
LARGEST_WHOLE = 8 << 20
LONGEST_NAME = 200

MANIFEST = 'package.xml'
NO_MODULES = {'test', 'tests', 'launch', 'config', 'msg', 'srv', 'action', 'resource', 'answers'}
_COMMENT = re.compile('#.*')
_ENTRY_POINT = re.compile(r'\b(?P<name>\w+)\s*=\s*(?P<module>[\w.]+)\s*:\s*(?P<call>\w+)')


def read_handed_in(path: Path) -> dict[str, str]:
    """
    Return the texts of a script, a package folder or a zip file by relative path.

    :param path: a ``.py`` file, or a folder or ``.zip`` file with one package at any depth
    :raises NotTakenInError: if the path is none of these, or its content is not safe
    """
    if path.suffix == '.py' and not path.is_dir():
        return {path.name: _script(path)}
    if path.is_dir() or path.suffix == '.zip':
        return in_package(_texts(path), str(path))
    kind = 'another file' if path.exists() else 'no file or folder of this name'
    raise NotTakenInError(
        f'{path}: expected a Python script, a package folder, a zip file or a notebook, '
        f'got {kind}.'
    )


def _script(path: Path) -> str:
    data, problems = read_file(path, str(path))
    if data is None:
        raise NotTakenInError(problems[0].line())
    if len(data) > LARGEST_FILE:
        raise _bounds().refusal(str(path), f'{len(data)} bytes')
    return data.decode('utf-8', 'replace')


def _bounds() -> Bounds:
    return Bounds(
        'the files of one package',
        'hand in the package folder alone, with copies of files instead of links',
        lambda parts, _: is_left_out(parts[-1]),
        entries=MOST_ENTRIES,
        listed=10 * MOST_ENTRIES,
        file_bytes=LARGEST_FILE,
        whole_bytes=LARGEST_WHOLE,
        name_chars=LONGEST_NAME,
    )


def _texts(path: Path) -> dict[str, str]:
    """
    Return the texts of a folder or a zip file by relative path, without following links.

    :raises NotTakenInError: if it is damaged or too large, or has a link, a special file or an
        unsafe path
    """
    bounds, found, folder = _bounds(), {}, path.is_dir()
    if not folder and path.is_symlink():
        raise NotTakenInError(f'{path}: expected a regular file, got a link.')
    if not folder and path.stat().st_size > LARGEST_ZIP:
        raise bounds.refusal(str(path), f'{path.stat().st_size} bytes')
    with opened(path, bounds) as tree:
        for name, trouble in tree.refused:
            raise bounds.refusal(f'{path}, {name[:80]!r}', trouble)
        files = [file for file in tree.files if PurePosixPath(file.name).suffix in KINDS]
        if len(files) > MOST_FILES:
            raise bounds.refusal(str(path), f'more than {MOST_FILES} files')
        for file in files:
            try:
                found[file.path] = file.read().decode('utf-8', 'replace')
            except UnreadableError as error:
                raise bounds.refusal(f'{path}, {file.path}', str(error)) from error
    for name in found:
        for above in PurePosixPath(name).parents:
            if above.as_posix() in found:
                raise NotTakenInError(f'{path}: {above} is both a file and a folder.')
    return found


def in_package(files: Mapping[str, str], where: str) -> dict[str, str]:
    """
    Return the files of the only package, with paths relative to its folder.

    :param files: the files of a package, or of a folder that contains a package at any depth
    :param where: name of the submission in messages
    :raises NotTakenInError: if there are several packages
    """
    roots = sorted(
        PurePosixPath(name).parent for name in files if PurePosixPath(name).name == MANIFEST
    )
    if len(roots) > 1:
        names = ', '.join(str(root) for root in roots[:5])
        raise NotTakenInError(
            f'{where}: expected one package, got {len(roots)}: {names}.',
            'Try: name the folder of one of them.',
        )
    tops = {PurePosixPath(name).parts[0] for name in files}
    if roots:
        root = roots[0]
    elif len(tops) == 1 and tops.isdisjoint(files):
        root = PurePosixPath(tops.pop())
    else:
        root = PurePosixPath('.')
    return {
        PurePosixPath(name).relative_to(root).as_posix(): text
        for name, text in files.items()
        if PurePosixPath(name).is_relative_to(root)
    }


def with_node_files(files: Mapping[str, str], wanted: Iterable[str]) -> dict[str, str]:
    """
    Return the files with a copy of each wanted node in the top folder, where exams look for it.

    The source is the file that ``ros2 run`` would start: the module from which ``setup.py`` or
    ``setup.cfg`` builds the executable of that name; otherwise, a file of that name: the one that
    ``CMakeLists.txt`` mentions, or the one in the top folder, or one in the package's folders.

    :param wanted: node files such as ``talker.py``
    """
    found = dict(files)
    for name in wanted:
        if not name.endswith('.py') or any(path.startswith(f'{name}/') for path in files):
            continue  # a folder may have the node's name; then no file can
        text = _node_text(files, name)
        if text is not None:
            found[name] = text
    return found


def _node_text(files: Mapping[str, str], name: str) -> str | None:
    stem = name.removesuffix('.py')
    for setup in ('setup.py', 'setup.cfg'):
        for match in _ENTRY_POINT.finditer(_COMMENT.sub('', files.get(setup, ''))):
            path = match['module'].replace('.', '/') + '.py'
            if match['name'] == stem and path in files:
                if match['call'] == 'main' or path == name:
                    return files[path]
                module, call = match['module'], match['call']
                return f'import sys\n\nfrom {module} import {call}\n\nsys.exit({call}())\n'
    installed = re.split(r'[\s"()]+', _COMMENT.sub('', files.get('CMakeLists.txt', '')))
    places = [
        (path not in installed, path.count('/'), path)
        for path in files
        if f'/{path}'.endswith(f'/{name}') and not NO_MODULES & set(PurePosixPath(path).parts)
    ]
    return files[min(places)[-1]] if places else None

"""
Read the files of a ROS package: a folder on disk, or a submitted script, folder or zip.

The result is the text of each file by its relative path (:mod:`autograder.submission.reading`).  A
submission with a link, a special file or an unsafe path is refused, because without the linked
file the grader would judge a different program.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path, PurePosixPath
import re

from autograder.exam.exam import Exam
from autograder.results import ExamResult, first_of
from autograder.submission.reading import (
    Bounds,
    opened,
    read_file,
    UnreadableError,
    UnusableUploadError,
)

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
MOST_FILES = 200
LARGEST_ZIP = 8 << 20
BOUNDS = Bounds(
    'the files of one package',
    'hand in the package folder alone, with copies of files instead of links',
    lambda parts, _: is_left_out(parts[-1]),
    entries=2000,
    listed=20_000,
    file_bytes=1 << 20,
    whole_bytes=8 << 20,
    name_chars=200,
)
NO_MODULES = {'test', 'tests', 'launch', 'config', 'msg', 'srv', 'action', 'resource', 'answers'}
_COMMENT = re.compile('#.*')
_ENTRY_POINT = re.compile(r'\b(?P<name>\w+)\s*=\s*(?P<module>[\w.]+)\s*:\s*(?P<call>\w+)')


def is_left_out(name: str) -> bool:
    """Return whether a file or folder of this name is hidden or generated."""
    return name in LEFT_OUT or (name.startswith('.') and name not in ('.', '..'))


def read_package(folder: Path) -> dict[str, str]:
    """Return the texts of a package by the paths that exams use; refuse links as unusable."""
    found: dict[str, str] = {}
    for path in sorted(folder.rglob('*')):
        inside = path.relative_to(folder)
        if any(map(is_left_out, inside.parts)):
            continue
        if path.is_symlink():
            fix = 'Try: replace the link with a copy of its target'
            raise UnusableUploadError(f'{path}: expected a file or folder, got a link.', fix)
        if path.suffix not in NOTEBOOK_KINDS or not path.is_file():
            continue
        if path.suffix == '.py' and len(inside.parts) > 1 and inside.parts[0] != 'test':
            inside = Path(*inside.parts[1:])
        data, problems = read_file(path, str(inside))
        if data is not None and not problems and len(found) < MOST_FILES:
            found.setdefault(inside.as_posix(), data.decode('utf-8', 'replace'))
    return found


def read_upload(path: Path) -> dict[str, str]:
    """
    Return the text of each file in a script, package folder or zip file, by relative path.

    :param path: a ``.py`` file, or a folder or ``.zip`` file with one package at any depth
    :raises UnusableUploadError: if the path is none of these, or its content is not safe
    """
    if path.suffix == '.py' and not path.is_dir():
        return {path.name: _script(path)}
    if path.is_dir() or path.suffix == '.zip':
        return in_package(_texts(path), str(path))
    kind = 'a different file' if path.exists() else 'no file or folder of this name'
    raise UnusableUploadError(
        f'{path}: expected a Python script, a package folder, a zip file or a notebook, '
        f'got {kind}.'
    )


def _script(path: Path) -> str:
    data, problems = read_file(path, str(path))
    if data is None:
        raise UnusableUploadError(problems[0].line())
    if len(data) > BOUNDS.file_bytes:
        raise BOUNDS.refusal(str(path), f'{len(data)} bytes')
    return data.decode('utf-8', 'replace')


def _texts(path: Path) -> dict[str, str]:
    """Return the texts of a folder or a zip file by relative path, without following links."""
    found, folder = {}, path.is_dir()
    if not folder and path.is_symlink():
        raise UnusableUploadError(f'{path}: expected a regular file, got a link.')
    if not folder and path.stat().st_size > LARGEST_ZIP:
        raise BOUNDS.refusal(str(path), f'{path.stat().st_size} bytes')
    with opened(path, BOUNDS) as tree:
        for name, trouble in tree.refused:
            raise BOUNDS.refusal(f'{path}, {name[:80]!r}', trouble)
        files = [file for file in tree.files if PurePosixPath(file.name).suffix in KINDS]
        if len(files) > MOST_FILES:
            raise BOUNDS.refusal(str(path), f'more than {MOST_FILES} files')
        for file in files:
            try:
                found[file.path] = file.read().decode('utf-8', 'replace')
            except UnreadableError as error:
                raise BOUNDS.refusal(f'{path}, {file.path}', str(error)) from error
    for name in found:
        for above in PurePosixPath(name).parents:
            if above.as_posix() in found:
                raise UnusableUploadError(f'{path}: {above} is both a file and a folder.')
    return found


def in_package(files: Mapping[str, str], where: str) -> dict[str, str]:
    """
    Return the files of the only package, with paths relative to its folder.

    :param files: the files of a package, or of a folder that contains a package at any depth
    :raises UnusableUploadError: if there are several packages
    """
    roots = sorted(
        PurePosixPath(name).parent for name in files if PurePosixPath(name).name == 'package.xml'
    )
    if len(roots) > 1:
        names = ', '.join(str(root) for root in roots[:5])
        raise UnusableUploadError(
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


def own_files(exam: Exam, files: Mapping[str, str]) -> dict[str, str]:
    """
    Return the files that an exam needs, from those of :func:`read_package`.

    As in grading, these do not include the nodes of other exercises: editing those nodes does not
    cause a new build, and a cause can name a line, because all code is in one file.
    """
    wanted = {name for name in exam.requires if name.endswith('.py')}
    if not wanted and exam.scenario.program != 'build':
        return dict(files)
    return {
        name: text for name, text in files.items() if not name.endswith('.py') or name in wanted
    }


def describe_files(files: Mapping[str, str]) -> str:
    """Return the names of the first files of a package, for a message about a missing file."""
    if not files:
        return 'no package files'
    names = [name if name.isprintable() else repr(name) for name in files]
    return f'only {first_of(names, 8)}'


def name_missing(result: ExamResult, files: Mapping[str, str]) -> ExamResult:
    """Return a result whose message about a missing file does not mention a notebook's cells."""
    return with_missing_file(
        result,
        title='All files of the exercise exist.',  # the first check is about other things
        observed=describe_files(files),
        cause='',
        try_this='Save each missing file at its path in the package folder, then check again.',
    )


def with_missing_file(result: ExamResult, **words: str) -> ExamResult:
    """Return a result with other words in the check about a missing file."""
    checks = [
        replace(check, **words) if check.cause_id == 'missing_file' else check  # type: ignore[arg-type]
        for check in result.checks
    ]
    return replace(result, checks=tuple(checks))

"""
Build the student's package inside the sandbox with colcon, then run one of its executables.

Usage: run_package.py SOURCE PACKAGE EXECUTABLE [arguments of the program].  The executable is the
file that ``ros2 run PACKAGE EXECUTABLE`` would start: a file of that name in ``lib/PACKAGE``.  If
the file is missing, one line on standard error lists the existing executables, and the exit code
is 97; if the build fails, the exit code is 98.  ``{share}`` in an argument is replaced by the
folder ``share/PACKAGE`` of the installed package.
"""

import json
import os
from pathlib import Path
import sys

import build_package  # type: ignore[import-not-found]  # next to this file, inside the sandbox
import gate  # type: ignore[import-not-found]

NO_EXECUTABLE, NOT_BUILT = 97, 98
MARK = 'run_package: '


def executable(prefix: Path, package: str, name: str) -> Path | None:
    """Return the executable file of this name, with or without the suffix ``.py``."""
    folder = prefix / 'lib' / package
    return next(filter(_runs, (folder / name, folder / f'{name}.py')), None)


def list_executables(prefix: Path, package: str) -> dict[str, list[str]]:
    """
    Return the names of the existing executables, at most 20 of each kind.

    :returns: ``lib``: executables in ``lib/PACKAGE``; ``bin``: executables in ``bin``; ``others``:
        subfolders of ``lib`` with executables
    """
    found: dict[str, set[str]] = {'lib': set(), 'bin': set(), 'others': set()}
    for word, pattern in (('lib', f'lib/{package}/*'), ('bin', 'bin/*'), ('others', 'lib/*/*')):
        for file in filter(_runs, prefix.glob(pattern)):
            found[word].add(file.parent.name if word == 'others' else file.name)
    return {word: sorted(names)[:20] for word, names in found.items()}


def _runs(file: Path) -> bool:
    return file.is_file() and os.access(file, os.X_OK)


def command(file: Path) -> list[str]:
    """Return the command for an executable; the Python of this process runs Python scripts."""
    with file.open('rb') as script:
        first = script.readline(200)
    if first.startswith(b'#!') and b'python' in first:
        return [sys.executable, str(Path(__file__).with_name('rclpy_patches.py')), str(file)]
    return [str(file)]


def main() -> None:
    """Build the package and replace this process with the program."""
    gate.wait()
    source, package, name, *arguments = sys.argv[1:]
    try:
        prefix = build_package.build(source, package)
    except SystemExit:
        sys.exit(NOT_BUILT)
    file = executable(prefix, package, name)
    if file is None:
        print(MARK + json.dumps(list_executables(prefix, package)), file=sys.stderr)
        sys.exit(NO_EXECUTABLE)
    share = str(prefix / 'share' / package)
    argv = [*command(file), *(one.replace('{share}', share) for one in arguments)]
    os.execve(argv[0], argv, build_package.variables(prefix))


if __name__ == '__main__':
    main()

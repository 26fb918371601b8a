"""
Build the student's package inside the sandbox with colcon, then echo messages of its type.

Usage: build_package.py SOURCE PACKAGE TYPE.  After a successful build, this process becomes
``echo_node.py``, which imports TYPE from the built package.
"""

from contextlib import suppress
from glob import glob
import os
from pathlib import Path
import shutil
import subprocess
import sys

import gate  # type: ignore[import-not-found]  # next to this file, inside the sandbox


def add_package_files(folder: Path, package: str) -> None:
    """
    Add the files that ``ros2 pkg create`` generates to a Python package from a notebook.

    The node files of a notebook are in the top folder; this function moves them to the folder
    with the package's name.
    """
    modules, marker = folder / package, folder / 'resource' / package
    if not (folder / 'setup.py').is_file() or modules.exists() or marker.exists():
        return  # a complete Python package, or a CMake package
    for made in (modules / '__init__.py', marker):
        made.parent.mkdir(exist_ok=True)
        made.touch()
    for node in folder.glob('*.py'):
        if node.name != 'setup.py':
            node.rename(modules / node.name)


def build(source: str, package: str) -> Path:
    """
    Build a copy of a package, or exit with colcon's exit code.

    :param source: read-only folder of the package
    :returns: the folder in which the package is installed
    :raises SystemExit: if the build fails
    """
    workspace = Path('/tmp/ws') if not os.environ.get('TMPDIR') else Path(os.environ['TMPDIR'])
    copy = workspace / 'src' / package
    shutil.copytree(source, copy)
    add_package_files(copy, package)
    command = ['colcon', '--log-base', str(workspace / 'log'), 'build', '--merge-install']
    command += ['--base-paths', str(workspace / 'src')]
    command += ['--build-base', str(workspace / 'build')]
    command += ['--install-base', str(workspace / 'install')]
    command += ['--event-handlers', 'console_direct+']
    # The result needs neither optimisation nor debug information.
    command += ['--cmake-args', '-DCMAKE_BUILD_TYPE=None', '-DBUILD_TESTING=OFF']
    if shutil.which('ninja'):
        command += ['-GNinja']  # Ninja runs more steps of a message build in parallel than Make
    # Four parallel compilers stay below the sandbox's process limit on any machine; Ninja
    # ignores MAKEFLAGS. There is no load limit (-l): with one, a busy machine would build one file
    # at a time. Only Python programs run, so environment/cmake skips the C++ code of messages.
    parallel = {'MAKEFLAGS': '-j4', 'CMAKE_BUILD_PARALLEL_LEVEL': '4'}
    settings = {**os.environ, **parallel, 'ROS2_COURSE_GRADED_BUILD': '1'}
    with suppress(ImportError):
        from cmake import CMAKE_BIN_DIR  # type: ignore[import-not-found]

        # The cmake command from PyPI is a slow Python wrapper, so use the real program.
        settings['CMAKE_COMMAND'] = str(Path(CMAKE_BIN_DIR) / 'cmake')
    ended = subprocess.run(command, env=settings, check=False).returncode
    if ended != 0:
        sys.exit(ended if ended > 0 else 1)
    return workspace / 'install'


def variables(prefix: Path) -> dict[str, str]:
    """Return the environment variables for programs of the installed package."""
    found = glob(f'{prefix}/lib/python3*/site-packages')
    # The build ran in real time; the program runs in virtual time.
    whole = {**os.environ, 'LD_PRELOAD': os.environ['CLOCK_LIBRARY']}
    for name, value in (
        ('PYTHONPATH', ':'.join(found)),
        ('LD_LIBRARY_PATH', f'{prefix}/lib'),
        ('AMENT_PREFIX_PATH', str(prefix)),
    ):
        whole[name] = ':'.join(filter(None, (value, whole.get(name))))
    return whole


def main() -> None:
    """Build the package and become the echo node, or exit with colcon's exit code."""
    gate.wait()
    source, package, type_name = sys.argv[1:4]
    prefix = build(source, package)
    echo = str(Path(__file__).with_name('echo_node.py'))
    os.execve(sys.executable, [sys.executable, echo, type_name], variables(prefix))


if __name__ == '__main__':
    main()

"""
Compute digests of everything that affects how a program runs, to compare two machines.

The project may be in a different folder on each machine, but its files, Python and ROS must match.
A recording also contains readable versions (:func:`made_with`).
"""

from collections.abc import Container, Iterable, Mapping
from contextlib import suppress
from functools import lru_cache
import hashlib
from importlib import metadata
import json
import os
from pathlib import Path
import platform
import subprocess
import sys

from autograder.sandboxes.sandbox import HERE
from environment import ros

RUNS_PROGRAMS = (
    *('clock/*.[ch]', 'clock/virtual_clock.py', 'fastdds.xml', 'sandboxes/seccomp/*.bpf'),
    *('grading/examine.py', 'inside/**/*.py', 'probe/*.py', 'probe/probe.xml'),
    *('runs/observe.py', 'runs/program.py', 'runs/watchdog.py'),
    *('sandboxes/confinement.py', 'sandboxes/forked.py', 'sandboxes/fork_server.py'),
    *('sandboxes/landlock.py', 'sandboxes/processes.py', 'sandboxes/sandbox.py', 'simulated.py'),
)
"""Files of the grader that can affect a recording."""
ROS_PACKAGES = ('ros-jazzy-rclpy', 'ros-rclpy', 'rclpy')
"""Names of Python distributions that may contain rclpy."""
GIT_S = 5.0
"""Timeout for git; the commit is only informative, so a longer wait is not worthwhile."""
FURTHER = 'packages of environment/messages.txt'
"""Key of the extra message packages in a version; a run depends only on packages that it names."""
TASKS = 1
"""Version of the format of tasks and answers in :mod:`autograder.runs.task`."""


@lru_cache(maxsize=4)
def version(python: str = sys.executable) -> Mapping[str, str]:
    """Return the versions and digests that must be equal on two machines, by name."""
    venv = Path(python).parents[1]
    further = ros.further_messages(venv)
    return {
        'tasks': str(TASKS),
        'grader': _digest_of_grader(),
        'Python': platform.python_version(),
        'machine': platform.machine(),
        'settings of ROS': _digest_of_settings(venv),
        'packages of ROS': _digest_of_packages(venv, further),
        FURTHER: ', '.join(sorted({pin for pins in further.values() for pin in pins})),
    }


def difference(wanted: Mapping[str, str], got: Mapping[str, str]) -> str:
    """Return a description of how two versions differ; empty if they are equal."""
    return '; '.join(
        f'{name}: expected {wanted.get(name) or "nothing"}, got {got.get(name) or "nothing"}'
        for name in dict.fromkeys((*wanted, *got))
        if wanted.get(name) != got.get(name)
    )


def environment_digest(python: str, texts: Iterable[str]) -> str:
    """
    Return a digest of the environment, for the file names and headers of recordings.

    The digest includes a package of ``environment/messages.txt`` only if one of the texts names
    it, so adding a package keeps all other recordings valid.

    :param texts: contents of the program's files, and the scenario as JSON
    """
    further = ros.further_messages(Path(python).parents[1])
    named = {name for text in texts for name in further if name in text}
    parts = {**version(python), FURTHER: {name: further[name] for name in sorted(named)}}
    return digest(json.dumps(parts, sort_keys=True).encode(), 32)


@lru_cache(maxsize=1)
def made_with() -> Mapping[str, str]:
    """Return the known versions of the grader, Python and rclpy, for the headers of recordings."""
    found = {'grader': commit(HERE.parent), 'python': platform.python_version()}
    for name in reversed(ROS_PACKAGES):
        with suppress(metadata.PackageNotFoundError):
            found['rclpy'] = metadata.version(name)  # without importing rclpy
    return {name: text for name, text in found.items() if text}


def commit(root: Path) -> str:
    """
    Return the commit of a copy of the project, with a suffix if files have changed since.

    :returns: an empty string if the folder is not a git repository, or if git is missing or fails
    """
    if not (root / '.git').exists():  # otherwise git would describe an enclosing repository
        return ''
    command = ['git', '-C', str(root), 'describe', '--always', '--dirty', '--exclude=*']
    # Ignore the variables of a git hook that runs this program, and take no lock that could block
    # another git command.
    around = {name: text for name, text in os.environ.items() if not name.startswith('GIT_')}
    try:
        done = subprocess.run(
            [*command, '--abbrev=12'],
            env={**around, 'GIT_OPTIONAL_LOCKS': '0'},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=GIT_S,
            check=True,
        )
    except (OSError, subprocess.SubprocessError, UnicodeDecodeError):
        return ''
    return done.stdout.strip()


def _digest_of_grader() -> str:
    files = sorted(path for pattern in RUNS_PROGRAMS for path in HERE.glob(pattern))
    files.append(Path(ros.__file__).with_name('clock.py'))  # the compiler's options
    return digest(b'\0'.join(path.name.encode() + b'\0' + path.read_bytes() for path in files))


def _digest_of_settings(venv: Path) -> str:
    """Return a digest of the ROS settings that does not depend on folder names."""
    text = (venv / ros.FILE_NAME).read_text(encoding='utf-8')
    share = Path(json.loads(text)['workspace'], 'share')
    for folder, name in ((venv, 'VENV'), (HERE.parent, 'COURSE'), (sys.base_prefix, 'PYTHON')):
        text = text.replace(str(folder), f'<{name}>')
    messages = sorted(share.glob('*/msg/*.msg'))
    cmake = sorted((HERE.parent / 'environment' / 'cmake').glob('*.cmake'))
    return digest(text.encode() + b''.join(path.read_bytes() for path in (*messages, *cmake)))


def _digest_of_packages(venv: Path, without: Container[str]) -> str:
    """Return a digest of the installed ROS wheels; a sourced ROS has none."""
    # Use the folder names, because reading the metadata of all packages takes seconds.
    found = venv.glob('lib/python*/site-packages/ros_*.dist-info')
    packages = {path.name: path.name.removeprefix('ros_').partition('-')[0] for path in found}
    names = sorted(name for name, package in packages.items() if package not in without)
    return digest('\n'.join(names).encode())


def digest(data: bytes, length: int = 16) -> str:
    """Return the first hexadecimal digits of the SHA-256 digest of data."""
    return hashlib.sha256(data).hexdigest()[:length]


def files_digest(files: Mapping[str, str]) -> str:
    """Return the digest of a student's files, as stored in a recording's header."""
    return digest(json.dumps(sorted(files.items())).encode(), 32)

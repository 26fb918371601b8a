"""
Digests of everything that decides how a program runs, to compare two machines.

The project may be in different folders, but its files, its Python and its ROS have to be the same.
Digests compare them; for people, a recording also names versions (:func:`made_with`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
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
from environment.ros import FILE_NAME, further_messages

RUNS_PROGRAMS = (
    *('clock/*.[ch]', 'clock/virtual_clock.py', 'fastdds.xml', 'sandboxes/seccomp/*.bpf'),
    *('inside/**/*.py', 'probe/*.py', 'probe/probe.xml'),
    *('runs/kept.py', 'runs/observe.py', 'runs/watchdog.py', 'sandboxes/confined.py'),
    *('sandboxes/landlock.py', 'sandboxes/probes.py', 'sandboxes/processes.py'),
    'sandboxes/sandbox.py',
    'simulated.py',
)
"""The files in and around the sandbox on which a recording depends."""
ROS_PACKAGES = ('ros-jazzy-rclpy', 'ros-rclpy', 'rclpy')
"""Names under which rclpy may be installed."""
GIT_S = 5.0
"""How long git may take: a name for people is not worth more."""
FURTHER = 'packages of environment/messages.txt'
"""What two machines must have in common, and what only runs that name such a package depend on."""
TASKS = 1
"""Format of what :mod:`autograder.runs.task` sends and gets."""


@lru_cache(maxsize=4)
def version(python: str = sys.executable) -> Mapping[str, str]:
    """
    Return the facts that two machines must have in common, by name.

    :param python: interpreter of the prepared environment
    """
    venv = Path(python).parents[1]
    return {
        'tasks': str(TASKS),
        'grader': _digest_of_grader(),
        'Python': platform.python_version(),
        'machine': platform.machine(),
        'settings of ROS': _digest_of_settings(venv),
        'packages of ROS': _digest_of_packages(venv),
        FURTHER: ', '.join(sorted({pin for pins in _further(venv).values() for pin in pins})),
    }


def difference(wanted: Mapping[str, str], got: Mapping[str, str]) -> str:
    """Return how two versions differ, as text; empty if they are equal."""
    return '; '.join(
        f'{name}: expected {wanted.get(name) or "nothing"}, got {got.get(name) or "nothing"}'
        for name in dict.fromkeys((*wanted, *got))
        if wanted.get(name) != got.get(name)
    )


def environment_digest(python: str, texts: Iterable[str]) -> str:
    """
    Return a digest of the environment, for the names and headers of recordings.

    A package of ``environment/messages.txt`` counts only for runs that name it: adding one leaves
    all other recordings valid.

    :param python: interpreter of the prepared environment
    :param texts: the files of the program and the scenario
    """
    further = _further(Path(python).parents[1])
    named = {name for text in texts for name in further if name in text}
    parts = {**version(python), FURTHER: {name: further[name] for name in sorted(named)}}
    return _digest(json.dumps(parts, sort_keys=True).encode(), 32)


@lru_cache(maxsize=1)
def made_with() -> Mapping[str, str]:
    """Return versions for the headers of recordings, without unknown ones."""
    found = {'grader': commit(HERE.parent), 'python': platform.python_version(), 'rclpy': _rclpy()}
    return {name: text for name, text in found.items() if text}


def commit(root: Path) -> str:
    """
    Return the commit of a copy of the project, marked if files have changed since.

    :returns: empty if it is no copy of a repository, or git is missing or refuses
    """
    if not (root / '.git').exists():  # else git would answer for a repository around it
        return ''
    command = ['git', '-C', str(root), 'describe', '--always', '--dirty', '--exclude=*']
    # Nothing of a hook that runs us, and no lock that would be in somebody's way.
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


def _rclpy() -> str:
    """Return the version of rclpy, without importing it."""
    for name in ROS_PACKAGES:
        try:
            return metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return ''


def _digest_of_grader() -> str:
    files = sorted(path for pattern in RUNS_PROGRAMS for path in HERE.glob(pattern))
    return _digest(b'\0'.join(path.name.encode() + b'\0' + path.read_bytes() for path in files))


def _digest_of_settings(venv: Path) -> str:
    """Return a digest of the settings of ROS, whatever the folders are called."""
    text = (venv / FILE_NAME).read_text(encoding='utf-8')
    share = Path(json.loads(text)['workspace'], 'share')
    for folder, name in ((venv, 'VENV'), (HERE.parent, 'COURSE'), (sys.base_prefix, 'PYTHON')):
        text = text.replace(str(folder), f'<{name}>')
    messages = sorted(share.glob('*/msg/*.msg'))
    cmake = sorted((HERE.parent / 'environment' / 'cmake').glob('*.cmake'))
    return _digest(text.encode() + b''.join(path.read_bytes() for path in (*messages, *cmake)))


def _digest_of_packages(venv: Path) -> str:
    """Return a digest of the installed ROS packages; empty for a sourced ROS."""
    # By their folders: to read the metadata of all packages takes seconds.
    found = venv.glob('lib/python*/site-packages/ros_*.dist-info')
    packages = {path.name: path.name.removeprefix('ros_').partition('-')[0] for path in found}
    names = sorted(name for name, package in packages.items() if package not in _further(venv))
    return _digest('\n'.join(names).encode())


@lru_cache(maxsize=4)
def _further(venv: Path) -> Mapping[str, list[str]]:
    return further_messages(venv)


def _digest(data: bytes, length: int = 16) -> str:
    return hashlib.sha256(data).hexdigest()[:length]

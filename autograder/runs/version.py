"""
What decides how a program runs: the same on two machines, or their recordings are not alike.

The project may lie in different folders; its files, its Python and its ROS have to be the same.
Digests tell whether they are; for people, a recording also names versions (:func:`made_with`).
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
import hashlib
from importlib import metadata
import json
import os
from pathlib import Path
import platform
import subprocess
import sys

from autograder.sandboxes import probes
from autograder.sandboxes.sandbox import HERE
from environment.ros import FILE_NAME

AROUND = (
    'fastdds.xml',
    'judging/clock_steps.py',
    'judging/code_periods.py',
    'judging/late_answers.py',
    'judging/learners_code.py',
    'judging/own_time.py',
    'runs/examine.py',
    'runs/observe.py',
    'runs/scenario.py',
    'sandboxes/confined.py',
    'sandboxes/landlock.py',
    'sandboxes/probes.py',
    'sandboxes/processes.py',
    'sandboxes/sandbox.py',
    'sandboxes/warm_probes.py',
)
"""What runs programs, beside what runs in the sandbox."""
ROS_PACKAGES = ('ros-jazzy-rclpy', 'ros-rclpy', 'rclpy')
"""Names under which rclpy may be installed."""
GIT_S = 5.0
"""How long git may take: a name for people is not worth more."""
TASKS = 1
"""Format of what :mod:`autograder.runs.workers` sends and gets."""


@lru_cache(maxsize=4)
def version(python: str = sys.executable) -> Mapping[str, str]:
    """
    Return what two machines must have in common, by name.

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
    }


def difference(wanted: Mapping[str, str], got: Mapping[str, str]) -> str:
    """Return how two versions differ, in words; empty if they are the same."""
    return '; '.join(
        f'{name}: expected {wanted.get(name, "nothing")}, got {got.get(name, "nothing")}'
        for name in dict.fromkeys((*wanted, *got))
        if wanted.get(name) != got.get(name)
    )


@lru_cache(maxsize=4)
def environment_digest(python: str = sys.executable) -> str:
    """Return a digest of all of it, for the names and the headers of recordings."""
    return _digest(json.dumps(version(python), sort_keys=True).encode(), 32)


@lru_cache(maxsize=1)
def made_with() -> Mapping[str, str]:
    """Return versions in words, for the headers of recordings; what is unknown is left out."""
    found = {'grader': commit(HERE.parent), 'python': platform.python_version(), 'rclpy': _rclpy()}
    return {name: text for name, text in found.items() if text}


def commit(root: Path) -> str:
    """
    Return the commit of a copy of the project, with a sign if files were changed since.

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
    inside = sorted((HERE / 'inside').rglob('*.py'))
    filters = sorted((HERE / 'sandboxes' / 'seccomp').glob('*.bpf'))
    files = [*(HERE / name for name in (*probes.FILES, *AROUND)), *inside, *filters]
    return _digest(b'\0'.join(path.name.encode() + b'\0' + path.read_bytes() for path in files))


def _digest_of_settings(venv: Path) -> str:
    """Return a digest of how ROS is started, whatever the folders are called."""
    text = (venv / FILE_NAME).read_text(encoding='utf-8')
    for folder, name in ((venv, 'VENV'), (HERE.parent, 'COURSE'), (sys.base_prefix, 'PYTHON')):
        text = text.replace(str(folder), f'<{name}>')
    messages = sorted((HERE.parent / 'temp_monitor_pkg' / 'msg').glob('*.msg'))
    cmake = sorted((HERE.parent / 'environment' / 'cmake').glob('*.cmake'))
    return _digest(text.encode() + b''.join(path.read_bytes() for path in (*messages, *cmake)))


def _digest_of_packages(venv: Path) -> str:
    """Return a digest of the ROS packages in the environment; none where ROS was sourced."""
    # By their folders: to read the metadata of all packages takes seconds.
    found = venv.glob('lib/python*/site-packages/ros_*.dist-info')
    return _digest('\n'.join(sorted(path.name for path in found)).encode())


def _digest(data: bytes, length: int = 16) -> str:
    return hashlib.sha256(data).hexdigest()[:length]

"""
What decides how a program runs: the same on two machines, or their recordings are not alike.

The project may lie in different folders; its files, its Python and its ROS have to be the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
import hashlib
import json
from pathlib import Path
import platform
import sys

from autograder.sandboxes.sandbox import HERE, PROBE
from environment.ros import FILE_NAME

AROUND = (
    'fastdds.xml',
    'runs/observe.py',
    'sandboxes/confined.py',
    'sandboxes/landlock.py',
    'sandboxes/processes.py',
    'sandboxes/sandbox.py',
)
"""What runs programs, beside what runs in the sandbox."""
ROS_PACKAGES = ('ros-jazzy-rclpy', 'ros-rclpy', 'rclpy')
"""Names under which rclpy may be installed."""
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


def _digest_of_grader() -> str:
    inside = sorted((HERE / 'inside').rglob('*.py'))
    filters = sorted((HERE / 'sandboxes' / 'seccomp').glob('*.bpf'))
    files = [*(HERE / name for name in (*PROBE, *AROUND)), *inside, *filters]
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

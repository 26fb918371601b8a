"""
Describe the ROS 2 installation, and provide the description to all other modules.

`environment prepare` writes the description to `<venv>/ros_environment.json`: the variables with
which ROS 2 works in a new process.  Everything else reads it through :func:`ros_environment`, and
so works with both the wheels from PyPI and a sourced installation.  With the wheels, everything is
in the venv.  With a sourced installation, the description keeps the variables that its setup file
exported, so that later shells need not source it again.  This module does not import ROS.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
import json
import os
from pathlib import Path
import sys

from environment.places import NO_PACKAGE, Places

FILE_NAME = 'ros_environment.json'
MESSAGES_NAME = 'ros_messages.json'
"""File in the same folder that lists the installed packages of environment/messages.txt."""
SYSTEM_PATH = ('/usr/local/sbin', '/usr/local/bin', '/usr/sbin', '/usr/bin', '/sbin', '/bin')

# Variables for every process of the course, wherever ROS comes from.
COMMON = {
    # Raise an error when a string is assigned to a number field, instead of crashing in publish().
    'ROS_PYTHON_CHECK_FIELDS': '1',
    # nbgrader gives 0 points to a grade cell with output on stderr, and JupyterLab shows it in
    # red.
    'RCUTILS_LOGGING_USE_STDOUT': '1',
    'RCUTILS_COLORIZED_OUTPUT': '1',
    'RCUTILS_CONSOLE_OUTPUT_FORMAT': '[{severity}] [{name}]: {message}',
    # Students in one room must not receive each other's messages.
    'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
}

# Variables that a sourced installation exports and its programs need; PYTHONPATH, PATH and
# LD_LIBRARY_PATH are handled separately.
SOURCED_NAMES = (
    'AMENT_PREFIX_PATH',
    'CMAKE_PREFIX_PATH',
    'COLCON_PREFIX_PATH',
    'CONDA_PREFIX',
    'PKG_CONFIG_PATH',
    'RMW_IMPLEMENTATION',
    'ROS_DISTRO',
    'ROS_PYTHON_VERSION',
    'ROS_VERSION',
)


class RosEnvironmentError(RuntimeError):
    """Raised if the environment was not prepared or its description is damaged."""


@dataclass(frozen=True)
class RosEnvironment:
    """
    The interpreter and the variables of a process that can use ROS 2.

    :param kind: 'wheels' (from PyPI) or 'sourced' (an installation that was sourced)
    :param variables: variables needed to import rclpy and the course's own package
    :param base_variables: the same variables without the course's workspace, to build student
        packages
    :param read_only: directories that a sandbox binds read-only, without /usr
    :param workspace: install prefix of the course's own ROS package, a folder named after the
        package
    """

    kind: str
    python: str
    variables: dict[str, str]
    base_variables: dict[str, str]
    read_only: tuple[str, ...]
    workspace: str

    @property
    def package(self) -> str:
        """Return the name of the course's own ROS package; empty if it has none."""
        return Path(self.workspace).name.removeprefix(NO_PACKAGE)

    def to_json(self) -> str:
        """Return the description as the text of `ros_environment.json`."""
        return json.dumps(asdict(self), indent=2) + '\n'

    @classmethod
    def from_json(cls, text: str) -> RosEnvironment:
        """Parse the text of :meth:`to_json`, or raise a ValueError that says what is wrong."""
        data = json.loads(text)
        names = {field.name for field in fields(cls)}
        if not isinstance(data, dict) or set(data) != names:
            raise ValueError(f'expected exactly the keys {", ".join(sorted(names))}')
        for name in ('variables', 'base_variables'):
            if not isinstance(data[name], dict):
                raise ValueError(f'{name} is not a table of names and values')
        return cls(**{**data, 'read_only': tuple(data['read_only'])})


def ros_environment(venv: str | Path | None = None) -> RosEnvironment:
    """Return a venv's ROS environment, by default this Python's; raise a RosEnvironmentError."""
    path = Path(venv or sys.prefix) / FILE_NAME
    try:
        return RosEnvironment.from_json(path.read_text(encoding='utf-8'))
    except FileNotFoundError:
        raise RosEnvironmentError(
            f'{path}: the description of the ROS environment is missing. '
            'Likely cause: this is not the Python of the course, or the set-up did not finish. '
            'Try: make doctor'
        ) from None
    except (OSError, ValueError, TypeError) as error:
        raise RosEnvironmentError(
            f'{path}: the description of the ROS environment cannot be read: {error}. '
            'Try: make doctor'
        ) from error


def further_messages(venv: Path) -> dict[str, list[str]]:
    """
    Return the message packages that an environment has in addition to those of the lock.

    :returns: name of the ROS package, such as ``'trajectory_msgs'``, -> the sorted pins
        (``NAME==VERSION``) of its wheel and of the additional packages that it uses
    """
    try:
        found = json.loads((venv / MESSAGES_NAME).read_text(encoding='utf-8'))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def join_paths(*parts: str | Path | Iterable[str | Path]) -> str:
    """Join the parts into one search path, in order, without empty or repeated entries."""
    flat: list[str] = []
    for part in parts:
        flat += [str(part)] if isinstance(part, (str, Path)) else map(str, part)
    entries = [entry for item in flat for entry in item.split(os.pathsep) if entry]
    return os.pathsep.join(dict.fromkeys(entries))


def describe_wheels(places: Places, base_prefix: str) -> RosEnvironment:
    """Describe a venv with the ROS 2 wheels, made by the Python installed in ``base_prefix``."""
    venv, site = places.venv, places.site_packages()
    base = {
        **COMMON,
        'VIRTUAL_ENV': str(venv),
        'PATH': join_paths(venv / 'bin', SYSTEM_PATH),
        'AMENT_PREFIX_PATH': str(venv),
        # Without these two variables, every Python process would restart itself once to set them.
        # Nearly all of the hundred libraries that rclpy loads are in the first folder.
        'LD_LIBRARY_PATH': join_paths(venv / 'lib', sorted(site.glob('ros_*.libs'))),
        '_ROS_WHEELS_BOOTSTRAP_COMPLETE': '1',
        'CMAKE_TOOLCHAIN_FILE': str(places.cmake / 'ros_wheels_toolchain.cmake'),
    }
    return _describe('wheels', places, base, [str(venv), base_prefix])


def describe_sourced(
    places: Places, base_prefix: str, environ: Mapping[str, str]
) -> RosEnvironment:
    """Describe a venv with a ROS 2 installation (apt or conda) that was sourced in ``environ``."""
    kept = {name: environ[name] for name in SOURCED_NAMES if environ.get(name)}
    prefixes = environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep)
    base = {
        **COMMON,
        **kept,
        'VIRTUAL_ENV': str(places.venv),
        'PATH': join_paths(places.venv / 'bin', [f'{p}/bin' for p in prefixes if p], SYSTEM_PATH),
    }
    for name in ('LD_LIBRARY_PATH', 'PYTHONPATH'):
        if environ.get(name):
            base[name] = join_paths(environ[name])
    return _describe(
        'sourced', places, base, [str(places.venv), base_prefix, *filter(None, prefixes)]
    )


def _describe(
    kind: str, places: Places, base: dict[str, str], folders: list[str]
) -> RosEnvironment:
    return RosEnvironment(
        kind=kind,
        python=str(places.python),
        variables=with_workspace(base, places.prefix),
        base_variables=base,
        read_only=tuple(_outermost(folders)),
        workspace=str(places.prefix),
    )


def trial_of_messages(package: str) -> str:
    """Return a Python program that imports ROS and every message of a package, if one is given."""
    if not package:
        return 'import rclpy'
    return f"""
import rclpy
import {package}.msg as messages
for name in [name for name in dir(messages) if name[0].isupper()]:
    type(getattr(messages, name)).__import_type_support__()
"""


def with_workspace(base: Mapping[str, str], prefix: Path) -> dict[str, str]:
    """Return the variables with the paths of a workspace, installed in ``prefix``, in front."""
    # Debian's CMake rules may use local/lib and dist-packages; both are accepted.
    python = [
        folder
        for pattern in ('lib/python3*/*-packages', 'local/lib/python3*/*-packages')
        for folder in sorted(prefix.glob(pattern))
    ]
    variables = {
        **base,
        'AMENT_PREFIX_PATH': join_paths(prefix, base.get('AMENT_PREFIX_PATH', '')),
        'LD_LIBRARY_PATH': join_paths(prefix / 'lib', base.get('LD_LIBRARY_PATH', '')),
        'PYTHONPATH': join_paths(python, base.get('PYTHONPATH', '')),
    }
    return {name: value for name, value in variables.items() if value}


def _outermost(folders: Iterable[str]) -> list[str]:
    """Return the existing folders, resolved, without /usr and folders inside other folders."""
    real = {str(Path(folder)) for folder in folders if Path(folder).is_dir()}
    real |= {os.path.realpath(folder) for folder in real}
    outer: list[str] = []
    for folder in sorted(real):
        inside = [*outer, '/usr']
        if not any(folder == top or folder.startswith(top + os.sep) for top in inside):
            outer.append(folder)
    return outer

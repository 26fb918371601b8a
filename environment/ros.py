"""
Provide the description of the ROS 2 installation to all other modules.

`environment prepare` writes its findings to `<venv>/ros_environment.json`. Everything else reads
them through :func:`ros_environment`, and so works with both the wheels from PyPI and a sourced
installation. This module does not import ROS.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
import json
from pathlib import Path
import sys

from environment.places import NO_PACKAGE

FILE_NAME = 'ros_environment.json'
MESSAGES_NAME = 'ros_messages.json'
"""File in the same folder that lists the installed packages of environment/messages.txt."""


class RosEnvironmentError(RuntimeError):
    """Raised if the environment was not prepared or its description is damaged."""


@dataclass(frozen=True)
class RosEnvironment:
    """
    The interpreter and the variables of a process that can use ROS 2.

    :param kind: 'wheels' (from PyPI) or 'sourced' (an installation that was sourced)
    :param python: interpreter of the prepared virtual environment
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
    """
    Return the ROS environment of a virtual environment, by default that of this Python.

    :raises RosEnvironmentError: if it is missing or unreadable; the message gives the command to
        run
    """
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

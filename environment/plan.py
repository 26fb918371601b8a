"""Decide what to prepare: with which ROS 2 and Python, and in which folder."""

from collections.abc import Mapping
from dataclasses import dataclass
import os
from pathlib import Path
import subprocess

from environment import interpreters, stamps, system
from environment.interpreters import Interpreter
from environment.places import Places
from environment.ros import (
    describe_sourced,
    describe_wheels,
    ros_environment,
    RosEnvironment,
    RosEnvironmentError,
)
from environment.steps import StepError

# Variables that would affect the venv's Python, pip or colcon in unexpected ways.
_HARMFUL = (
    # Set by make for this process; colcon's make would look for the outer make's job server.
    'MAKEFLAGS',
    'MAKELEVEL',
    'MFLAGS',
    'LD_LIBRARY_PATH',
    'PYTHONHOME',
    'PYTHONPATH',
    'VIRTUAL_ENV',
    '_ROS_WHEELS_BOOTSTRAP_COMPLETE',
    '__PYVENV_LAUNCHER__',
)


@dataclass
class Plan:
    """
    The choices for one run of the set-up.

    :param environ: the shell's environment, plus the variables of a remembered sourced ROS 2
    :param kind: 'wheels' or 'sourced'
    :param interpreter: the Python to use, None if none is installed yet
    """

    places: Places
    environ: Mapping[str, str]
    kind: str
    interpreter: Interpreter | None

    @property
    def python(self) -> Interpreter:
        """The interpreter; the first step ensures that it exists."""
        assert self.interpreter is not None
        return self.interpreter

    def clean_environ(self) -> dict[str, str]:
        """Return the shell's environment without variables that harm the venv's programs."""
        return {k: v for k, v in self.environ.items() if k not in _HARMFUL}

    def description(self) -> RosEnvironment:
        """Describe the current environment."""
        if self.kind == 'sourced':
            return describe_sourced(self.places, self.python.base_prefix, self.environ)
        return describe_wheels(self.places, self.python.base_prefix)

    def digest(self, step: str) -> str:
        """Return the digest that the stamp of a step must have to be up to date."""
        python = self.python
        # One Python can have several names: python3, python3.12.
        path = os.path.realpath(python.path)
        venv = stamps.digest_of(str(self.places.venv), path, python.version, self.kind)
        packages = stamps.packages_digest(python.version, self.kind)
        return {
            'venv': lambda: venv,
            'packages': lambda: packages,
            'messages': lambda: stamps.digest_of(venv, packages, stamps.messages_text()),
            'clock': lambda: stamps.digest_of(venv, stamps.clock_digest()),
            'workspace': lambda: stamps.digest_of(
                venv, packages, stamps.package_digest(self.places)
            ),
        }[step]()


def make_plan(places: Places, environ: Mapping[str, str]) -> Plan:
    """
    Choose the source of ROS 2 and the Python.

    A sourced ROS 2 Jazzy is used if its Python can import rclpy. A venv that was prepared this way
    keeps using that ROS 2 in later shells, even if nothing is sourced in them.

    :raises StepError: if the source is missing, or this user cannot create shared memory
    """
    system.refuse_closed_shared_memory()
    wish = environ.get('ROS_SOURCE', '')
    if wish not in ('', 'wheels', 'sourced'):
        raise StepError(f'ROS_SOURCE: expected wheels or sourced, got {wish!r}')
    request = environ.get('PYTHON', '')
    if wish != 'wheels':
        shell = _sourced_environ(places, environ)
        names = [request] if request else _sourced_pythons(places, environ)
        python = _python_with_rclpy(shell, names) if shell else None
        if shell and python:
            return Plan(places, shell, 'sourced', python)
        if wish == 'sourced':
            raise StepError(
                'ROS_SOURCE=sourced: found no ROS 2 Jazzy with a Python that imports rclpy',
                'source its setup file first, for example: source /opt/ros/jazzy/setup.bash',
            )
    kept = None if request else _python_of_venv(places, environ)
    return Plan(places, environ, 'wheels', kept or interpreters.find(environ, request))


def _python_of_venv(places: Places, environ: Mapping[str, str]) -> Interpreter | None:
    """Return the Python of an existing venv, None if it is missing, unsupported or incomplete."""
    python = interpreters.probe(str(places.python), environ) if places.python.exists() else None
    return python if python and python.supported and python.complete else None


def _sourced_environ(places: Places, environ: Mapping[str, str]) -> dict[str, str] | None:
    """Return an environment with ROS 2 sourced: the shell's or the remembered one, else None."""
    if environ.get('ROS_DISTRO') == 'jazzy' and environ.get('AMENT_PREFIX_PATH'):
        return dict(environ)
    try:
        ros = ros_environment(places.venv)
    except RosEnvironmentError:
        return None
    if ros.kind != 'sourced':
        return None
    return {**environ, **{k: v for k, v in ros.base_variables.items() if k != 'PATH'}}


def _sourced_pythons(places: Places, environ: Mapping[str, str]) -> list[str]:
    """Return the Pythons to try: those of the venv, conda and the system, and those on PATH."""
    names = [str(places.python)] if places.python.exists() else []
    if environ.get('CONDA_PREFIX'):
        names.append(str(Path(environ['CONDA_PREFIX'], 'bin', 'python3')))
    return [*names, '/usr/bin/python3', 'python3', 'python3.12']


def _python_with_rclpy(environ: Mapping[str, str], names: list[str]) -> Interpreter | None:
    """Return the first Python that can import the sourced installation's rclpy."""
    for name in names:
        python = interpreters.find(environ, name)
        if python is not None:
            command = [python.path, '-c', 'import rclpy']
            done = subprocess.run(
                command, env=dict(environ), stdin=subprocess.DEVNULL, capture_output=True
            )
            if done.returncode == 0:
                return python
    return None

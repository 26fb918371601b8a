"""
Start the course's own small ``ros2`` with the ROS environment, for ``<venv>/bin/ros2``.

It runs in any terminal, sourced or not, and in cells of a notebook.  Search paths that are set
already stay in front, so a workspace that was built in a notebook or sourced in a terminal is
found.  Where the ROS installation in use has a ``ros2`` of its own, that one is started instead.
"""

from __future__ import annotations

from collections.abc import Mapping
import os
from pathlib import Path
import shutil
import sys

if not __package__:
    # Run as a file with -S and -E, which is quicker; then only this folder is on the path.
    sys.path[0] = str(Path(__file__).resolve().parent.parent)

from environment.places import PROJECT
from environment.ros import EnvironmentError_, ros_environment, RosEnvironment

PROGRAM = PROJECT / 'roslab' / 'ros2' / '__main__.py'
PROFILES = PROJECT / 'environment' / 'fastdds.xml'
_SEARCH_PATHS = ('AMENT_PREFIX_PATH', 'LD_LIBRARY_PATH', 'PYTHONPATH')


def installed_ros2(ros: RosEnvironment, path: str = '') -> str | None:
    """
    Return the ``ros2`` of the ROS installation in use; the wheels have none.

    :param path: a search path to look at besides that of the installation
    """
    if ros.kind != 'sourced':
        return None
    own = Path(ros.python).parent
    folders = f'{ros.variables.get("PATH", "")}{os.pathsep}{path}'.split(os.pathsep)
    others = [folder for folder in folders if folder and Path(folder) != own]
    return shutil.which('ros2', path=os.pathsep.join(others))


def discovery_variables(ros: RosEnvironment) -> dict[str, str]:
    """Return the settings that make discovery fast."""
    if 'RMW_IMPLEMENTATION' in ros.variables:
        return {}
    return {'FASTRTPS_DEFAULT_PROFILES_FILE': str(PROFILES)}


def overlaid(environ: Mapping[str, str], ros: RosEnvironment) -> dict[str, str]:
    """
    Return the variables of a shell, completed by those that ROS needs.

    What the shell says stays; search paths are joined, the shell's in front.
    """
    variables = {**discovery_variables(ros), **ros.variables, **environ}
    for name in _SEARCH_PATHS:
        parts = f'{environ.get(name, "")}{os.pathsep}{ros.variables.get(name, "")}'
        entries = dict.fromkeys(part for part in parts.split(os.pathsep) if part)
        variables[name] = os.pathsep.join(entries)
    folder = str(Path(ros.python).parent)
    path = [part for part in environ.get('PATH', os.defpath).split(os.pathsep) if part != folder]
    return {**variables, 'PATH': os.pathsep.join([folder, *path])}


def main(arguments: list[str], environ: Mapping[str, str]) -> int:
    """Replace this process by the command; return an exit code only if that is not possible."""
    venv, *rest = arguments
    try:
        ros = ros_environment(venv)
    except EnvironmentError_ as error:
        print(error, file=sys.stderr)
        return 1
    variables = overlaid(environ, ros)
    if real := installed_ros2(ros, environ.get('PATH', '')):
        print(f"ros2: {real} is the installation's own, so that one is started", file=sys.stderr)
        os.execve(real, [real, *rest], variables)
    os.execve(ros.python, [ros.python, str(PROGRAM), *rest], variables)


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:], os.environ))

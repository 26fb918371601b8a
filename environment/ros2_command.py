"""
Start the course's small ``ros2`` command with the ROS environment, for ``<venv>/bin/ros2``.

It runs in any terminal, sourced or not, and in notebook cells.  Existing search paths stay in
front, so it finds a workspace that was built in a notebook or sourced in a terminal.  If the ROS
installation has a ``ros2`` command, it starts that command instead.
"""

import signal

if __name__ == '__main__' and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    # Ctrl-C ends the command without a traceback of the imports.
    signal.signal(signal.SIGINT, signal.SIG_DFL)

from collections.abc import Mapping
import os
from pathlib import Path
import shutil
import sys

if not __package__:
    # This file runs with -S and -E, to start faster, so sys.path contains only this folder.
    sys.path[0] = str(Path(__file__).resolve().parent.parent)

from environment.places import PROJECT
from environment.ros import join_paths, ros_environment, RosEnvironment, RosEnvironmentError

PROGRAM = PROJECT / 'roslab' / 'ros2' / '__main__.py'
PROFILES = PROJECT / 'environment' / 'fastdds.xml'
_SEARCH_PATHS = ('AMENT_PREFIX_PATH', 'LD_LIBRARY_PATH', 'PYTHONPATH')


def installed_ros2(ros: RosEnvironment, path: str = '') -> str | None:
    """Return the ``ros2`` of a sourced installation, also searched in ``path``, else None."""
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
    """Return a shell's variables plus those of ROS; the shell's values and paths come first."""
    variables = {**discovery_variables(ros), **ros.variables, **environ}
    for name in _SEARCH_PATHS:
        variables[name] = join_paths(environ.get(name, ''), ros.variables.get(name, ''))
    folder = str(Path(ros.python).parent)
    path = [part for part in environ.get('PATH', os.defpath).split(os.pathsep) if part != folder]
    return {**variables, 'PATH': os.pathsep.join([folder, *path])}


def main(arguments: list[str], environ: Mapping[str, str]) -> int:
    """Replace this process with the command; return an exit code only if that fails."""
    venv, *rest = arguments
    try:
        ros = ros_environment(venv)
    except RosEnvironmentError as error:
        print(error, file=sys.stderr)
        return 1
    variables = overlaid(environ, ros)
    if real := installed_ros2(ros, environ.get('PATH', '')):
        print(f'ros2: starting {real}, which belongs to the ROS 2 installation', file=sys.stderr)
        os.execve(real, [real, *rest], variables)
    if signal.getsignal(signal.SIGINT) is signal.SIG_DFL:
        # Block Ctrl-C until Python has started again; the program then unblocks it.
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    os.execve(ros.python, [ros.python, str(PROGRAM), *rest], variables)


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:], os.environ))

"""
Command line of the set-up, run in the folder of a course by any Python 3.10 or newer.

    python3 -m environment prepare   prepare everything (what make does first)
    python3 -m environment ready     end with code 0 if there is nothing to prepare
    python3 -m environment doctor    one line for each requirement: state and fix; offline
    python3 -m environment run CMD   run a command with the ROS environment
    python3 -m environment lock      resolve requirements.in into requirements.lock

VENV, PYTHON and ROS_SOURCE (wheels or sourced) select the venv, the Python and the ROS 2 to use.
"""

from collections.abc import Mapping, Sequence
import os
from pathlib import Path
import sys

from environment.places import FILE, Places, PROJECT


def main(arguments: Sequence[str], environ: Mapping[str, str]) -> int:
    """Run one command and return its exit code."""
    command, rest = (arguments[0] if arguments else ''), list(arguments[1:])
    here = Path.cwd()
    course = here if (here / FILE).is_file() else PROJECT
    if not (course / FILE).is_file():
        print(
            f'{here}: this is not a course folder: it has no {FILE}. Try: cd COURSE',
            file=sys.stderr,
        )
        return 2
    places = Places.of(environ.get('VENV') or '.venv', course)
    # Import modules where needed: `ready` runs before most make goals and must start quickly.
    if command == 'ready':
        from environment.stamps import is_ready

        return 0 if is_ready(places, environ) else 1
    if command == 'prepare':
        from environment import prepare

        prepare.leave_venv(places)
        return 0 if prepare.prepare(places, environ) else 1
    if command == 'doctor':
        from environment.doctor import run_doctor

        return run_doctor(places, environ)
    if command == 'run' and rest:
        return run(rest, places, environ)
    if command == 'lock':
        from environment.lock import write_lock

        return write_lock(environ)
    print(__doc__.strip(), file=sys.stderr)
    return 2


def run(command: Sequence[str], places: Places, environ: Mapping[str, str]) -> int:
    """Replace this process with a command that has the ROS environment."""
    from environment.ros import ros_environment, RosEnvironmentError

    try:
        ros = ros_environment(places.venv)
    except RosEnvironmentError as error:
        print(error, file=sys.stderr)
        return 1
    path = f'{places.venv}/bin{os.pathsep}{environ.get("PATH", "/usr/bin:/bin")}'
    env = {**environ, **ros.variables, 'PATH': path}
    try:
        os.execvpe(command[0], list(command), env)
    except OSError as error:
        print(f'{command[0]}: {error.strerror}', file=sys.stderr)
        return 127


if __name__ == '__main__':
    try:
        sys.exit(main(sys.argv[1:], os.environ))
    except BrokenPipeError:
        # The reader, such as head, has closed the pipe; Python would report that again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        sys.exit(1)
    except KeyboardInterrupt:
        print('\nstopped; run the same command again to continue', file=sys.stderr)
        sys.exit(130)

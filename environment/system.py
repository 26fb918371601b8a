"""Find the system's compiler, make and bubblewrap; install them with apt where possible."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import os
import shutil
import subprocess

from environment.interpreters import Interpreter
from environment.places import SHARED_MEMORY
from environment.steps import Job, StepError


@dataclass(frozen=True)
class Tool:
    """A program that the system provides; ``required`` if the set-up stops without it."""

    title: str
    command: str
    apt: str
    dnf: str
    required: bool = True


TOOLS = (
    Tool('C++ compiler', 'g++', 'g++', 'gcc-c++'),
    Tool('make', 'make', 'make', 'make'),
    # Lessons and their visible checks work without bubblewrap; grading stops and prints the
    # reason.
    Tool('bubblewrap', 'bwrap', 'bubblewrap', 'bubblewrap', required=False),
)


def missing_tools() -> list[Tool]:
    """Return the programs that are missing."""
    return [tool for tool in TOOLS if not shutil.which(tool.command)]


def refuse_closed_shared_memory() -> None:
    """Raise a StepError if this user cannot create shared memory, which ROS 2 needs."""
    if SHARED_MEMORY.is_dir() and not os.access(SHARED_MEMORY, os.W_OK | os.X_OK):
        command = f'mount -o remount,rw {SHARED_MEMORY} && chmod 1777 {SHARED_MEMORY}'
        raise StepError(
            f'{SHARED_MEMORY}: ROS 2 needs shared memory, and you cannot create files there',
            f'as root: {command}',
        )


def python_packages(interpreter: Interpreter | None) -> list[str]:
    """Return the apt packages that complete the system's Python, or that install one."""
    if interpreter is None:
        return ['python3', 'python3-venv', 'python3-dev']
    if not interpreter.path.startswith('/usr/bin/'):
        return []
    names = [] if interpreter.has_venv else [f'python{interpreter.version}-venv']
    return names + ([] if interpreter.has_headers else [f'python{interpreter.version}-dev'])


def apt_get(environ: Mapping[str, str]) -> list[str] | None:
    """Return a command for apt-get that asks for no password, or None if there is none."""
    path = environ.get('PATH')
    if not shutil.which('apt-get', path=path):
        return None
    if os.geteuid() == 0:
        return ['apt-get']
    sudo = shutil.which('sudo', path=path)
    if sudo and subprocess.run([sudo, '-n', 'true'], capture_output=True).returncode == 0:
        # sudo drops the environment, so `env` sets the variable after it.
        return [sudo, '-n', 'env', 'DEBIAN_FRONTEND=noninteractive', 'apt-get']
    return None


def command_to_type(tools: Sequence[Tool], python: Sequence[str] = ()) -> str:
    """Return one command that installs everything that is missing."""
    if shutil.which('apt-get') or not shutil.which('dnf'):
        return f'sudo apt-get install -y {" ".join([*(t.apt for t in tools), *python])}'
    dnf = ['python3-devel'] if python else []
    return f'sudo dnf install -y {" ".join([*(t.dnf for t in tools), *dnf])}'


def install_missing(job: Job, environ: Mapping[str, str], interpreter: Interpreter | None) -> None:
    """Install missing programs with apt without a password, or raise a StepError with a fix."""
    tools, python = missing_tools(), python_packages(interpreter)
    command = apt_get(environ)
    if command and (tools or python):
        env = {**environ, 'DEBIAN_FRONTEND': 'noninteractive'}
        packages = [*(tool.apt for tool in tools), *python]
        try:
            # A new container has no package lists; existing lists may suffice if this command
            # fails.
            job.run([*command, 'update', '-q'], env, 'apt-get update')
        except StepError as error:
            print(error, file=job.log, flush=True)
        install = [*command, 'install', '-y', '-q', '--no-install-recommends', *packages]
        job.run(install, env, 'apt-get install')
        tools, python = missing_tools(), []
    lacking = [tool for tool in tools if tool.required]
    if lacking or python:
        names = ', '.join([*(tool.title for tool in lacking), *python])
        raise StepError(f'missing: {names}', f'type: {command_to_type(tools, python)}')

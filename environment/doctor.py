"""
Implement `make doctor`: one line per requirement, with its state and fix, without network access.

If a requirement is `missing`, the course does not work; if one is `weak`, part of it does not.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
import importlib.metadata
import json
import os
from pathlib import Path
import re
import shlex
import shutil
import subprocess
import sys

from environment import install_files, interpreters, messages, stamps, system
from environment.exchange import exchange_root, unprotected
from environment.interpreters import Interpreter
from environment.pins import canonical, is_ros, pins_for
from environment.places import LOCK_FILE, Places, SHARED_MEMORY
from environment.plan import Plan
from environment.ros import (
    further_messages,
    ros_environment,
    RosEnvironment,
    RosEnvironmentError,
    trial_of_messages,
)
from environment.ros2_command import installed_ros2
from environment.steps import StepError

OK, WEAK, MISSING = 'ok', 'weak', 'missing'
PREPARE = 'make prepare'
ANEW = 'make clean, then make prepare'
DISK_MB, SHM_MB = 1500, 64

_GENERATORS = """
import pathlib, sys, tempfile
from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_parser.parser import parse_idl_string
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    (folder / 'Trial.msg').write_text('float64 value\\nstring unit\\n')
    idl = convert_msg_to_idl(folder, 'trial', pathlib.Path('Trial.msg'), folder)
    parse_idl_string(idl.read_text())
"""
_CPP = '#include <string>\nint main() { return std::string().size(); }\n'
_ISOLATION = """
import sys
from autograder.errors import SandboxUnavailable
from autograder.sandboxes.choose import strongest
try:
    strongest()
except SandboxUnavailable as error:
    sys.exit(f'{error.what} Lessons work, but grading does not.  -> {error.fix}')
"""


@dataclass(frozen=True)
class Finding:
    """
    The result of checking one requirement.

    :param state: ok, weak or missing
    :param fix: what to type or change; shown only if the state is not ok
    """

    name: str
    state: str
    detail: str
    fix: str = ''

    def line(self) -> str:
        """Return the finding as one line."""
        fix = f'  -> {self.fix}' if self.fix and self.state != OK else ''
        return f'{self.state:<8} {self.name:<22} {self.detail}{fix}'


def findings(places: Places, environ: Mapping[str, str]) -> Iterator[Finding]:
    """Yield the findings, each after the findings on which it depends."""
    python = interpreters.probe(str(places.python), environ)
    ros = _description(places)
    yield check_python(interpreters.find(environ, environ.get('PYTHON', '')), ros)
    yield check_venv(places, python)
    yield from check_programs(places, environ)
    if python:
        yield from check_packages(places, python.version, ros is None or ros.kind == 'wheels')
        yield check_messages(places)
    yield from check_by_running(ros)
    plan = Plan(places, environ, ros.kind, python) if python and ros else None
    yield check_workspace(places, plan.digest('workspace') if plan else '')
    yield check_kernel(places, ros)
    yield check_ros2_command(places, ros)
    ready = stamps.is_ready(places, environ)
    detail = 'complete and up to date' if ready else 'the next make command updates it'
    yield Finding('set-up', OK if ready else WEAK, detail, PREPARE)
    yield check_exchange(exchange_root(places.project, environ))
    yield check_room(
        'disk space', places.project, DISK_MB, 'free space on the disk: the venv takes 0.9 GB'
    )
    yield check_shared_memory()


def _description(places: Places) -> RosEnvironment | None:
    try:
        return ros_environment(places.venv)
    except RosEnvironmentError:
        return None


def check_python(found: Interpreter | None, ros: RosEnvironment | None) -> Finding:
    """Check the Python that the set-up would use."""
    packages = f'sudo apt-get install -y {" ".join(system.python_packages(found))}'
    if found is None:
        detail = 'no working CPython 3.10 to 3.13'
        return Finding('python', MISSING, detail, f'{packages}, or make PYTHON=...')
    detail = f'{found.release} at {found.path}'
    if not found.complete:
        fix = packages if system.python_packages(found) else 'make PYTHON=... with another Python'
        return Finding('python', MISSING, f'{detail} has no {found.lacking()}', fix)
    refusal = interpreters.wheels_refusal(found)
    if refusal and (ros is None or ros.kind == 'wheels'):
        return Finding('python', MISSING, refusal, 'environment.md: RoboStack, container, WSL2')
    return Finding('python', OK, detail)


def check_venv(places: Places, python: Interpreter | None) -> Finding:
    """Check that the virtual environment exists and that its Python runs."""
    if python:
        return Finding('venv', OK, f'{places.venv} (Python {python.release})')
    if places.python.is_symlink() or places.python.exists():
        return Finding('venv', MISSING, f'{places.python} does not run', PREPARE)
    return Finding('venv', MISSING, f'{places.venv} does not exist', PREPARE)


def check_programs(places: Places, environ: Mapping[str, str]) -> Iterator[Finding]:
    """Check the compiler by compiling a file, and make and cmake by starting them."""
    fix = system.command_to_type([tool for tool in system.TOOLS if tool.required])
    compiles = ('-x', 'c++', '-fsyntax-only', '-')
    starts = ('--version',)
    cmake = shutil.which(places.venv / 'bin' / 'cmake')
    for name, path, options, remedy in (
        ('C++ compiler', shutil.which('g++'), compiles, fix),
        ('make', shutil.which('make'), starts, fix),
        ('cmake', cmake, starts, PREPARE),
    ):
        if path is None:
            yield Finding(name, MISSING, 'not installed', remedy)
            continue
        failed, said = _try_command([path, *options], environ)
        if failed:
            yield Finding(name, MISSING, f'{path} does not work', remedy)
        else:
            yield Finding(name, OK, said.partition('\n')[0] or path)


def _try_command(command: Sequence[str], environ: Mapping[str, str]) -> tuple[str, str]:
    """Run a command with a C++ program as its input; return why it failed, and its output."""
    try:
        done = subprocess.run(
            command, env=dict(environ), input=_CPP, capture_output=True, text=True, check=False
        )
    except OSError as error:
        return str(error), ''
    last = (done.stderr.strip().splitlines() or ['it crashed'])[-1]
    return last if done.returncode else '', done.stdout


def check_packages(places: Places, python_version: str, ros: bool) -> Iterator[Finding]:
    """Compare the installed versions with the lock, with one line per purpose."""
    pins = pins_for(LOCK_FILE.read_text(encoding='utf-8'), python_version, ros=ros)
    have = installed_versions(places.site_packages())
    purposes = purposes_of(LOCK_FILE.with_suffix('.in').read_text(encoding='utf-8'))
    groups: dict[str, list[str]] = {}
    for name in pins:
        group = 'ROS 2 wheels' if is_ros(name) else purposes.get(name, 'their dependencies')
        groups.setdefault(group, []).append(name)
    for group, names in groups.items():
        bad = [
            f'{name} {have.get(name, "missing")} instead of {pins[name]}'
            for name in names
            if have.get(name) != pins[name]
        ]
        if bad:
            more = f' and {len(bad) - 1} more' if len(bad) > 1 else ''
            yield Finding(group, MISSING, bad[0] + more, ANEW)
        else:
            yield Finding(group, OK, f'{len(names)} packages as pinned')


def check_messages(places: Places) -> Finding:
    """Compare the installed message packages with those that ``messages.txt`` names."""
    name = 'further messages'
    try:
        pins = messages.wanted(stamps.messages_text())
    except StepError as error:
        return Finding(name, MISSING, str(error), error.try_this)
    packages = {messages.package_of(one) for one in pins}
    if missing := sorted(packages - further_messages(places.venv).keys()):
        detail = f'{messages.TITLE} names {missing[0]}, which is not installed'
        return Finding(name, MISSING, detail, PREPARE)
    return Finding(name, OK, f'{", ".join(sorted(packages)) or "none"} ({messages.TITLE})')


def installed_versions(site_packages: Path) -> dict[str, str]:
    """Return the versions of the packages installed in a folder, by name."""
    return {
        canonical(found.metadata['Name']): found.version
        for found in importlib.metadata.distributions(path=[str(site_packages)])
        if found.metadata['Name']
    }


def purposes_of(requirements: str) -> dict[str, str]:
    """Return the heading in requirements.in under which each package is listed, by name."""
    purposes, heading = {}, ''
    for line in requirements.splitlines():
        if line.startswith('# --- '):
            heading = line.strip('# -').strip()
        elif match := re.match(r'[A-Za-z0-9._-]+', line):
            purposes[canonical(match[0])] = heading
    return purposes


def check_by_running(ros: RosEnvironment | None) -> Iterator[Finding]:
    """Import ROS, generate messages, load the course's messages, and try the grader's sandbox."""
    for name, code, full, without, fix in (
        ('rclpy', 'import rclpy', False, MISSING, ANEW),
        ('message generators', _GENERATORS, False, MISSING, ANEW),
        ('course messages', trial_of_messages(ros.package if ros else ''), True, MISSING, PREPARE),
        ('isolation', _ISOLATION, True, WEAK, ''),
    ):
        if ros is None:
            yield Finding(name, MISSING, 'the environment is not prepared', PREPARE)
            continue
        variables = ros.variables if full else ros.base_variables
        command = [ros.python, '-W', 'ignore', '-c', code]
        failed, _ = _try_command(command, {'HOME': os.environ.get('HOME', '/tmp'), **variables})
        if failed:
            yield Finding(name, without, failed, fix)
        else:
            yield Finding(name, OK, f'tried ({ros.kind})')


def check_workspace(places: Places, wanted: str) -> Finding:
    """Check that the build of the course package is finished and has the wanted digest, if any."""
    name = places.package_name
    if not name:
        return Finding('ROS package', OK, 'the course has none')
    if not places.prefix.is_dir():
        return Finding(name, MISSING, 'not built', PREPARE)
    if not stamps.stamp_of(places.notes, 'workspace').is_file():
        return Finding(name, MISSING, 'its build did not finish', PREPARE)
    if wanted and not stamps.is_stamped(places.notes, 'workspace', wanted):
        detail = 'its sources or the packages have changed since the build'
        return Finding(name, WEAK, detail, PREPARE)
    programs = sorted(path.name for path in (places.prefix / 'lib' / name).glob('*'))
    return Finding(name, OK, f'programs: {", ".join(programs) or "none"}')


def check_kernel(places: Places, ros: RosEnvironment | None) -> Finding:
    """Check that the Jupyter kernel is installed with the described environment."""
    path = places.venv / 'share' / 'jupyter' / 'kernels' / install_files.KERNEL_NAME
    try:
        spec = json.loads((path / 'kernel.json').read_text(encoding='utf-8'))
    except (OSError, ValueError):
        return Finding('Jupyter kernel', MISSING, 'not installed', PREPARE)
    if ros is None or spec != install_files.kernel_spec(ros):
        return Finding('Jupyter kernel', WEAK, 'differs from the environment', PREPARE)
    return Finding('Jupyter kernel', OK, str(spec['display_name']))


def check_ros2_command(places: Places, ros: RosEnvironment | None) -> Finding:
    """Report which ``ros2`` is used: the installation's or the course's."""
    if ros and (real := installed_ros2(ros)):
        return Finding('ros2 command', OK, real)
    script = places.venv / 'bin' / 'ros2'
    if script.is_file():
        return Finding('ros2 command', OK, f"{script} (the course's own)")
    return Finding('ros2 command', MISSING, f'{script} does not exist', PREPARE)


def check_exchange(root: Path) -> Finding:
    """Check the modes of nbgrader's exchange, which let students remove only their own work."""
    loose = unprotected(root)
    if loose:
        fix = ' && '.join(f'chmod {mode:o} {shlex.quote(str(path))}' for path, mode in loose)
        detail = f'in {loose[0][0]}, users can remove the work of others'
        return Finding('exchange', WEAK, detail, fix)
    known = os.path.isdir(root)
    return Finding('exchange', OK, f'{root}' if known else f'{root} does not exist yet')


def check_room(name: str, folder: Path, need_mb: int, fix: str) -> Finding:
    """Check the free disk space of a folder."""
    try:
        free_mb = shutil.disk_usage(folder).free // 2**20
    except OSError:
        return Finding(name, WEAK, f'{folder} does not exist', fix)
    state = OK if free_mb >= need_mb else WEAK
    return Finding(name, state, f'{free_mb} MB free, {need_mb} MB needed', fix)


def check_shared_memory() -> Finding:
    """Check that ROS 2 can create shared memory, and that it has enough free space."""
    name = str(SHARED_MEMORY)
    try:
        system.refuse_closed_shared_memory()
    except StepError as error:
        return Finding(name, MISSING, 'you cannot create files in it', error.try_this)
    return check_room(name, SHARED_MEMORY, SHM_MB, 'in Docker: --shm-size=512m')


def run_doctor(places: Places, environ: Mapping[str, str]) -> int:
    """Print each finding as soon as it is known; return 1 if something is missing."""
    worst = 0
    for finding in findings(places, environ):
        print(finding.line(), flush=True)
        worst |= finding.state == MISSING
    if worst:
        print('Something is missing: the lines above say what to type.', file=sys.stderr)
    return int(worst)

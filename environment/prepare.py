"""
Define the steps from a new machine to a prepared environment.

system programs -> virtual environment -> packages -> further message packages -> course package
-> kernel and files -> trial -> self-check of the grader

Every step reports whether it is needed, so a second run does nothing, and an interrupted run
continues where it stopped. A virtual environment with an incomplete installation of packages is
created again: pip cannot distinguish a half-copied package from a complete one.
"""

from collections.abc import Callable, Mapping
from functools import partial
import os
from pathlib import Path
import shutil
import sys
from typing import Any

from environment import (
    clock,
    cmake_notes,
    install_files,
    interpreters,
    messages,
    packed_package,
    stamps,
    system,
)
from environment.pins import requirements_for
from environment.places import LOCK_FILE, Places, PROJECT, write_atomically
from environment.plan import make_plan, Plan
from environment.ros import trial_of_messages
from environment.steps import Job, locked, run_steps, Screen, Step, StepError

Needed = Callable[[], bool]
Work = Callable[[Plan, Job], None]


def prepare(places: Places, environ: Mapping[str, str]) -> bool:
    """Prepare the environment if needed; return False, after printing why, if a step failed."""
    if stamps.is_ready(places, environ):
        return True
    screen = Screen.of(environ)
    with locked(places.lock, screen) as handle:
        if stamps.is_ready(places, environ):
            return True
        try:
            plan = make_plan(places, environ)
        except StepError as error:
            screen.say(f'set-up: {error}')
            screen.say(f'  try: {error.try_this}' if error.try_this else '')
            return False
        places.ready.unlink(missing_ok=True)
        # Compute the digest first: if an input changes meanwhile, the next run prepares again.
        digest = stamps.whole_digest(places)
        if not run_steps(steps_of(plan), places.notes, screen, (handle,)):
            return False
        stamps.write_ready(places, environ, plan.python.version, digest)
        origin = 'PyPI' if plan.kind == 'wheels' else 'the sourced installation'
        words = f'Python {plan.python.version}, ROS 2 Jazzy from {origin}'
        screen.say(f'prepared: {places.venv} ({words})')
        if missing := system.missing_tools():
            names = ', '.join(tool.title for tool in missing)
            screen.say(f'  without {names}: lessons work, but grading does not')
            screen.say(f'  try: {system.command_to_type(missing)}')
    return True


def steps_of(plan: Plan) -> list[Step]:
    """Return the steps, in order."""

    def always() -> bool:
        return True

    def stamped(
        name: str, title: str, run: Work, needed: Needed = lambda: False, **more: Any
    ) -> Step:
        digest = partial(plan.digest, name)
        return Step(name, title, needed, partial(run, plan), digest=digest, **more)

    def stamp_is_old(name: str) -> bool:
        return not stamps.is_stamped(plan.places.notes, name, plan.digest(name))

    return [
        Step(
            'system',
            'System packages',
            lambda: (
                bool(plan.interpreter is None or not plan.interpreter.complete)
                or any(tool.required for tool in system.missing_tools())
                or bool(system.missing_tools() and system.apt_get(plan.environ))
            ),
            partial(check_system, plan),
        ),
        stamped(
            'venv',
            'Virtual environment',
            make_venv,
            lambda: stamp_is_old('packages') or not _runs(plan),
            try_this='remove the folder (make clean) and run the same command again',
        ),
        stamped(
            'packages',
            'Python packages',
            install_packages,
            about='about a minute',
            try_this='check the network, then run the same command again',
        ),
        stamped(
            'messages',
            f'Message packages of {messages.TITLE}',
            messages.install_messages,
        ),
        stamped(
            'workspace',
            f'ROS package {plan.places.package_name or "(the course has none)"}',
            build_workspace,
            about='ten to thirty seconds',
            try_this='read the whole log; make doctor lists what is missing',
        ),
        stamped(
            'clock',
            "Virtual clock of the grader's runs",
            clock.build,
            try_this='make doctor lists what is missing',
        ),
        Step(
            'files',
            'Jupyter kernel, commands and settings',
            always,
            lambda job: install_files.install_files(plan.places, plan.description()),
        ),
        Step(
            'trial',
            'Trial: import rclpy and the course messages',
            always,
            partial(try_imports, plan),
            try_this='make clean, then run the same command again; make doctor shows more',
        ),
        Step(
            'self-check',
            'Grader: run the exams on the reference solutions',
            # This copy has the hidden exams, and this machine has a sandbox.
            lambda: not plan.places.for_students and not system.missing_tools(),
            partial(try_grader, plan),
            about='ten to twenty seconds',
            try_this='lessons work; before grading, run .venv/bin/autograder self-check',
            optional=True,
        ),
    ]


def _runs(plan: Plan) -> bool:
    return interpreters.probe(str(plan.places.python), plan.clean_environ()) is not None


def check_system(plan: Plan, job: Job) -> None:
    """Install programs, find or complete the Python, and stop if the machine is unsuitable."""
    request = plan.environ.get('PYTHON', '')
    if plan.interpreter is None and request:
        raise StepError(
            f'PYTHON={request}: this is not a working CPython 3.10 to 3.13',
            'leave out PYTHON, or name a different interpreter',
        )
    system.install_missing(job, plan.environ, plan.interpreter)
    if plan.interpreter is None or not plan.interpreter.complete:
        plan.interpreter = interpreters.find(plan.environ, request)
    if plan.interpreter is None:
        raise StepError(
            'expected CPython 3.10 to 3.13, found none',
            f'type: {system.command_to_type([], system.python_packages(None))}',
        )
    if not plan.interpreter.complete:
        raise StepError(
            f'{plan.interpreter.path} has no {plan.interpreter.lacking()}',
            'install them, or name a different interpreter: make PYTHON=python3.12 ...',
        )


def make_venv(plan: Plan, job: Job) -> None:
    """Create the virtual environment from scratch; never touch a folder of unknown origin."""
    places = plan.places
    if plan.kind == 'wheels' and (refusal := interpreters.wheels_refusal(plan.python)):
        raise StepError(refusal, 'see environment.md: RoboStack, a container or WSL2')
    clear_venv(places)
    command = [plan.python.path, '-m', 'venv', str(places.venv)]
    if plan.kind == 'sourced':
        command.append('--system-site-packages')
    job.run(command, plan.clean_environ(), 'python -m venv')


def clear_venv(places: Places) -> None:
    """Empty the venv except for the notes, with the log in use; refuse links and other folders."""
    if not places.venv.exists():
        return
    if places.venv.is_symlink():
        raise StepError(
            f'{places.venv}: this is a link to {places.venv.resolve()}, which may be the '
            'environment of a different copy of the course',
            f'remove the link: rm {places.venv}',
        )
    content = {path.name for path in places.venv.iterdir()}
    if content and not content & {'pyvenv.cfg', places.notes.name}:
        raise StepError(
            f'{places.venv}: this folder exists and is not a virtual environment',
            'choose a different folder: make VENV=.venv-course ...',
        )
    for stamp in places.notes.glob('*.stamp'):
        stamp.unlink()
    for path in places.venv.iterdir():
        if path == places.notes:
            continue
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()


def install_packages(plan: Plan, job: Job) -> None:
    """Install the pins of the lock and compile them, because sandboxes cannot write the cache."""
    places, version = plan.places, plan.python.version
    lock = LOCK_FILE.read_text(encoding='utf-8')
    lines = requirements_for(lock, version, ros=plan.kind == 'wheels')
    chosen = places.notes / 'requirements.txt'
    chosen.write_text(''.join(f'{line}\n' for line in lines), encoding='utf-8')
    env = {**plan.clean_environ(), '_ROS_WHEELS_BOOTSTRAP_COMPLETE': '1'}
    python = str(places.python)
    options = ['--no-input', '--progress-bar', 'off', '--no-deps', '--no-compile']
    options += ['--disable-pip-version-check', '-r', str(chosen)]
    job.run([python, '-m', 'pip', 'install', *options], env, 'pip')
    # Some packages ship files for other Pythons, so a file that does not compile is normal.
    code = 'import compileall, sys; compileall.compile_dir(sys.argv[1], quiet=2, workers=0)'
    job.run([python, '-c', code, str(places.site_packages())], env, 'compileall')
    for suffix in ('sh', 'bash'):
        # Without these empty set-up files, colcon prints warnings.
        (places.venv / f'local_setup.{suffix}').touch()


def build_workspace(plan: Plan, job: Job) -> None:
    """Build the course's ROS package from scratch, so that removed files leave no trace."""
    places = plan.places
    for source in (PROJECT / 'environment' / 'cmake').iterdir():
        write_atomically(places.cmake / source.name, source.read_text(encoding='utf-8'))
    if places.workspace.exists():
        shutil.rmtree(places.workspace)
    places.workspace.mkdir(parents=True)
    if places.package_name:
        build_package(plan, job)


def build_package(plan: Plan, job: Job) -> None:
    """Build the course's ROS package in the empty workspace."""
    places = plan.places
    sources = package_sources(plan, job)
    env = {
        **plan.clean_environ(),
        **plan.description().base_variables,
        # Ignore the user's own defaults, which may choose a different layout.
        'COLCON_HOME': str(places.workspace / 'colcon'),
    }
    job.run(
        [str(places.venv / 'bin' / 'colcon'), '--log-base', str(places.workspace / 'log')]
        + ['build', '--base-paths', str(sources)]
        + ['--build-base', str(places.workspace / 'build')]
        + ['--install-base', str(places.workspace / 'install')]
        + ['--event-handlers', 'console_direct+']
        + ['--cmake-args', '-DBUILD_TESTING=OFF', '-DCMAKE_BUILD_TYPE=Release']
        + [f'-DPython3_EXECUTABLE={places.python}'],
        env,
        'colcon build',
        cwd=places.workspace,
    )
    if sources != places.package:
        shutil.rmtree(sources.parent)
    if not cmake_notes.keep(places):
        print(
            'CMake writes its cache in an unknown format here, so builds repeat all its checks.',
            file=job.log,
        )


def package_sources(plan: Plan, job: Job) -> Path:
    """
    Return the folder with the sources of the course's ROS package.

    A packed package is unpacked in the workspace; its modules are compiled and their sources
    removed.
    """
    package, name = plan.places.package, plan.places.package_name
    if (package / 'package.xml').is_file():
        return package
    packed = package / packed_package.FILE
    if not packed.is_file():
        raise StepError(f'{package}: expected a ROS package, found no package.xml')
    sources = plan.places.workspace / 'src' / name
    shutil.copytree(package, sources)
    packed_package.unpack(packed.read_bytes(), sources)
    job.run(
        # -b: next to the sources, which are then removed; -d: the folder's name in tracebacks.
        [str(plan.places.python), '-m', 'compileall', '-q', '-b', '-d', name]
        + ['--invalidation-mode', 'unchecked-hash', str(sources / name)],
        plan.clean_environ(),
        'compileall',
    )
    for module in (sources / name).glob('*.py'):
        module.unlink()
    return sources


def try_imports(plan: Plan, job: Job) -> None:
    """Start a new Python with the described variables, and import ROS and the messages."""
    ros = plan.description()
    command = [ros.python, '-c', trial_of_messages(ros.package)]
    job.run(command, {**plan.clean_environ(), **ros.variables}, 'python')


def try_grader(plan: Plan, job: Job) -> None:
    """
    Grade the reference solutions as a self-check; later grading runs reuse the recordings.

    Lessons work without a grader, so a machine without a working sandbox is still prepared.
    """
    ros = plan.description()
    job.run([ros.python, '-m', 'autograder', 'self-check'], plan.clean_environ(), 'self-check')


def leave_venv(places: Places) -> None:
    """Continue in the base interpreter if this Python is the venv's, which may be removed."""
    base = getattr(sys, '_base_executable', sys.executable)
    if os.path.realpath(sys.prefix) == os.path.realpath(places.venv) and base != sys.executable:
        os.execv(base, [base, '-S', '-E', '-m', 'environment', *sys.argv[1:]])

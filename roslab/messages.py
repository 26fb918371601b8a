"""
Build the learner's messages from a notebook, with colcon and ROS's message generators.

An unchanged package is not built again.  The built package becomes importable in the running
kernel.  It replaces the course's own package of the same name, unless that package was already
imported: a process cannot load two versions of the same message library.
"""

import ctypes
from dataclasses import dataclass
import hashlib
import html
import importlib
import json
import os
from pathlib import Path
import re
import shutil
import sys

from autograder.exam.exam import Cause
from autograder.judging.causes.builds import (
    diagnose,
    MISSING_AMENT_PACKAGE,
    texts_of,
    why_no_messages,
)
from autograder.submission.cells import UNSOLVED
from environment.ros import ros_environment, RosEnvironmentError
from roslab import run_command
from roslab.errors import NotHereError
from roslab.output import ElapsedTime, show
from roslab.package_files import learner_package, LearnerPackage

_DEADLINE_S = 300.0
_PRELOADED = (
    'generator_c',
    'typesupport_fastrtps_cpp',
    'typesupport_fastrtps_c',
    'typesupport_introspection_c',
    'typesupport_c',
    'generator_py',
)
"""Suffixes of message libraries, sorted so that each library follows its dependencies."""

_PARALLEL = f'-j{(os.cpu_count() or 1) + 1}'
"""Replaces colcon's default ``-jN -lN``: with -l, a busy machine builds one file at a time."""

_MARK = re.compile(r'(?m)^\[ *(\d+)(/\d+|%)\]')


@dataclass(frozen=True)
class BuildReport:
    """
    The outcome of a build.

    :param ok: whether its messages can be used
    :param messages: names such as 'Temperature'
    :param seconds: how long the build took [s], 0 if nothing had changed
    :param restart: whether the kernel must be restarted to import the built package
    """

    package: str
    ok: bool
    messages: tuple[str, ...] = ()
    seconds: float = 0.0
    diagnosis: Cause | None = None
    restart: bool = False
    log: Path | None = None

    def __bool__(self) -> bool:
        return self.ok

    def __str__(self) -> str:
        if self.diagnosis is not None:
            log = f'\n  Complete output: {self.log}' if self.log else ''
            return (
                f'{self.package} was not built.\n  {self.diagnosis.text}\n'
                f'  Try: {self.diagnosis.try_this}{log}'
            )
        how = f'built in {self.seconds:.1f} s' if self.seconds else 'unchanged, nothing to build'
        use = f'Ready: from {self.package}.msg import {", ".join(self.messages)}'
        if self.restart:
            use = (
                f'This kernel already uses a different version of {self.package}, which cannot be '
                'replaced while it runs: restart the kernel and run the cells again.'
            )
        return f'{self.package}: {how}. {use}'

    def _repr_html_(self) -> str:
        colour = '#2e7d32' if self.ok else '#c0392b'
        return (
            f'<pre style="border-left: 3px solid {colour}; padding-left: .6em; margin: .5em 0; '
            'white-space: pre-wrap; word-break: normal; overflow-wrap: anywhere">'
            f'{html.escape(str(self))}</pre>'
        )

    def _ipython_display_(self) -> None:
        """Show nothing as the value of a cell, because the report was already shown."""


def build_messages(package_dir: str | Path | None = None) -> BuildReport:
    """
    Build the learner's package and make its messages importable here.

    :param package_dir: folder of a package, by default the package in which cells are saved
    :returns: a report, already shown; it is true if the messages can be used
    :raises NotHereError: if there is no package to build
    """
    package = _package(package_dir)
    report = _unfinished(package)
    if report is None:  # the report of a failed build is falsy, so do not test its truth
        report = _built(package)
    show(str(report), report._repr_html_())
    return report


def _package(package_dir: str | Path | None) -> LearnerPackage:
    package = learner_package()
    if package_dir is not None:
        folder = Path(package_dir).resolve()
        package = LearnerPackage(folder.name, folder.parent.parent.parent)
        if package.folder != folder:
            raise NotHereError(
                f'{folder}: expected a package inside a workspace, as in ros_ws/src/{folder.name}.'
            )
    for name in ('package.xml', 'CMakeLists.txt'):
        if not (package.folder / name).is_file():
            raise NotHereError(
                f'{package.shown(package.folder / name)} does not exist yet: run the cell that '
                f'begins with %%rospkg {name} first.'
            )
    return package


def _failed(package: LearnerPackage, diagnosis: Cause, log: Path | None = None) -> BuildReport:
    return BuildReport(package.name, False, diagnosis=diagnosis, log=log)


def _unfinished(package: LearnerPackage) -> BuildReport | None:
    texts = package.files().items()
    files = [name for name, text in texts if UNSOLVED in text and not name.endswith('.py')]
    if not files:
        return None
    advice = 'replace YOUR CODE HERE in its cell and run the cell again.'
    error = f'{" and ".join(files)}: not written yet.'
    return _failed(package, Cause('unfinished', error, advice))


def _built(package: LearnerPackage) -> BuildReport:
    variables = build_variables()
    digest = _digest(package, variables)
    note = package.workspace / 'install' / '.roslab.json'
    noted = _noted(note)
    if noted.get('digest') == digest['digest']:
        return _usable(package, digest['interfaces'], 0.0)
    outcome = _colcon(package, variables, noted.get('interfaces') != digest['interfaces'])
    log = package.workspace / 'log' / 'build_messages.log'
    log.parent.mkdir(parents=True, exist_ok=True)
    log.write_text(outcome.output, encoding='utf-8')
    lacking = (_lacking if outcome.returncode == 0 else _failure)(outcome, package)
    if lacking is not None:
        return _failed(package, lacking, Path(package.shown(log)))
    note.write_text(json.dumps(digest), encoding='utf-8')
    return _usable(package, digest['interfaces'], outcome.seconds)


def build_variables() -> dict[str, str]:
    """
    Return the environment variables for building the learner's package.

    This build must not find the course's own package of the same name, so the variables that only
    the course's workspace needs are removed.

    :raises NotHereError: if the environment has not been set up
    """
    try:
        ros = ros_environment()
    except RosEnvironmentError as error:
        raise NotHereError(str(error)) from None
    kept = {name: value for name, value in os.environ.items() if name not in ros.variables}
    return {**kept, **ros.base_variables}


def _failure(outcome: run_command.Outcome, package: LearnerPackage) -> Cause:
    if outcome.returncode is None:
        error = f'The build did not end within {_DEADLINE_S:.0f} s.'
        return Cause('deadline', error, 'run the cell again.')
    return diagnose(outcome.output, texts_of(package.folder))


def _colcon(
    package: LearnerPackage, variables: dict[str, str], clean: bool
) -> run_command.Outcome:
    """Run colcon."""
    workspace = package.workspace
    # Always build into an empty install folder: libraries loaded by this kernel must not be
    # overwritten in place, and files of removed messages must disappear.
    shutil.rmtree(workspace / 'install', ignore_errors=True)
    if clean:
        shutil.rmtree(workspace / 'build', ignore_errors=True)
    command = [
        shutil.which('colcon', path=variables.get('PATH')) or 'colcon',
        *('--log-base', 'log', 'build', '--base-paths', str(package.folder)),
        *('--event-handlers', 'console_direct+'),
        *('--cmake-args', '-DBUILD_TESTING=OFF', *_generator(variables)),
    ]
    text = f'Building {package.name} with colcon (up to a minute the first time)'
    try:
        with ElapsedTime(text, always=True, progress=_progress) as elapsed:
            return run_command.run(
                command,
                cwd=workspace,
                env={**variables, 'MAKEFLAGS': _PARALLEL},
                deadline_s=_DEADLINE_S,
                on_tick=elapsed.tick,
            )
    except OSError as error:
        raise NotHereError(f'colcon could not be started: {error}. Try: make doctor') from None


def _progress(output: str) -> str:
    """
    Return the progress of a build, taken from the last progress mark of Ninja or make.

    :param output: such as ``[12/40] Building C object ...`` or ``[ 30%] Building ...``
    """
    marks = _MARK.findall(output)
    return f'{marks[-1][0]}{marks[-1][1].replace("/", " of ")}' if marks else ''


def _generator(variables: dict[str, str]) -> tuple[str, ...]:
    """Return the option that selects Ninja if it is installed; it runs more steps in parallel."""
    return ('-GNinja',) if shutil.which('ninja', path=variables.get('PATH')) else ()


def _lacking(outcome: run_command.Outcome, package: LearnerPackage) -> Cause | None:
    """Return what is missing after a build that succeeded."""
    needed = [_site_packages(package) / 'msg' / '__init__.py', *_libraries(package)]
    if not all(map(Path.is_file, needed)):
        return why_no_messages(outcome.output, texts_of(package.folder))
    index = _prefix(package) / 'share' / 'ament_index' / 'resource_index' / 'packages'
    return None if (index / package.name).is_file() else MISSING_AMENT_PACKAGE


def _usable(package: LearnerPackage, interfaces: str, seconds: float) -> BuildReport:
    names = tuple(sorted(path.stem for path in package.folder.glob('msg/*.msg')))
    loaded = _make_importable(package, interfaces)
    return BuildReport(package.name, True, names, seconds, restart=not loaded)


_loaded: dict[str, str] = {}
"""Digests of the loaded messages, by package: a process cannot unload a library."""


def _make_importable(package: LearnerPackage, interfaces: str) -> bool:
    """Let this process import the built package; False if it has loaded a different version."""
    name = package.name
    if name in _loaded:
        return _loaded[name] == interfaces
    if f'{name}.msg' in sys.modules:
        return False
    for module in [key for key in sys.modules if key.split('.')[0] == name]:
        del sys.modules[module]
    for library in _libraries(package):
        ctypes.CDLL(str(library), ctypes.RTLD_GLOBAL)
    sys.path.insert(0, str(_site_packages(package).parent))
    _put_first('AMENT_PREFIX_PATH', str(_prefix(package)))
    # For processes that cells start, such as `!ros2 interface show`; this process needs no
    # variable.
    _put_first('PYTHONPATH', str(_site_packages(package).parent))
    _put_first('LD_LIBRARY_PATH', str(_prefix(package) / 'lib'))
    importlib.invalidate_caches()
    _loaded[name] = interfaces
    return True


def _put_first(variable: str, value: str) -> None:
    parts = os.environ.get(variable, '').split(os.pathsep)
    rest = [part for part in parts if part not in ('', value)]
    os.environ[variable] = os.pathsep.join([value, *rest])


def _prefix(package: LearnerPackage) -> Path:
    return package.workspace / 'install' / package.name


def _libraries(package: LearnerPackage) -> list[Path]:
    folder = _prefix(package) / 'lib'
    return [folder / f'lib{package.name}__rosidl_{part}.so' for part in _PRELOADED]


def _site_packages(package: LearnerPackage) -> Path:
    """Return the folder with the built Python package; Debian's Python names it dist-packages."""
    found = sorted(_prefix(package).glob(f'**/*-packages/{package.name}'))
    return found[0] if found else _prefix(package) / 'none'


def _digest(package: LearnerPackage, variables: dict[str, str]) -> dict[str, str]:
    """Return digests of all inputs of the build, and of the inputs that affect messages."""
    # Include the generator: CMake refuses a build folder created by a different generator.
    base = f'{sys.version} {variables.get("AMENT_PREFIX_PATH", "")} {_generator(variables)}'
    texts = sorted(package.files().items())
    interfaces = [one for one in texts if not one[0].endswith('.py')]
    return {
        name: hashlib.sha256(json.dumps([base, files]).encode()).hexdigest()
        for name, files in (('digest', texts), ('interfaces', interfaces))
    }


def _noted(note: Path) -> dict[str, str]:
    try:
        data = json.loads(note.read_text(encoding='utf-8'))
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}

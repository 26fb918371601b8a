"""
Grade a whole ROS package: build it with colcon in the sandbox and run its executables.

The exams are unchanged; they run an executable instead of a node file.  If the build or the start
of an executable fails, the verdicts speak of a package.
"""

from __future__ import annotations

from collections.abc import Mapping
import copy
from dataclasses import replace
import json
import re
from typing import Any

from autograder.exam.exam import Exam
from autograder.judging.causes.builds import diagnose
from autograder.recording import Recording
from autograder.results import CheckResult, ExamResult, Verdict

MANIFEST = 'package.xml'
NO_EXECUTABLE, NOT_BUILT = 97, 98
MARK = 'run_package: '
"""As in inside/run_package.py, which imports nothing of the project."""

_NAME = re.compile(r'<name>\s*([A-Za-z][A-Za-z0-9_-]{0,99})\s*</name>')
_IN_CELL = re.compile(r'in line (\d+) of the cell')


def package_name(files: Mapping[str, str]) -> str:
    """
    Return the name of the package that some files form, or an empty string.

    :param files: of one package, by their path inside it
    """
    builds = 'CMakeLists.txt' in files or 'setup.py' in files
    found = _NAME.search(files.get(MANIFEST, ''))
    return found[1] if found and builds else ''


def as_package(exam: Exam, package: str) -> Exam:
    """
    Return an exam that builds the package and runs its executable instead of a node file.

    :param package: its name, from :func:`package_name`
    """
    if exam.scenario.program != 'node':
        return exam
    changed = copy.copy(exam)
    changed.scenario = replace(exam.scenario, program='package', build_type=package)
    changed.facts = {**exam.facts, 'package': package}  # a build has other limits
    changed.requires = tuple(name for name in exam.requires if not name.endswith('.py'))
    return changed


def explained(
    exam: Exam, result: ExamResult, recording: Recording | None, files: Mapping[str, str]
) -> ExamResult:
    """
    Return a result with messages about a package instead of a node file.

    :param exam: from :func:`as_package`
    :param recording: of the run, None if nothing was run
    """
    process = {} if recording is None else recording.process
    code = process.get('exit')
    facts: dict[str, Any] = {}
    if exam.scenario.program == 'package' and code == NOT_BUILT:
        output = ''.join(str(process.get(name, '')) for name in ('stderr', 'stdout'))
        facts = _not_built(output, files)
    elif exam.scenario.program == 'package' and code == NO_EXECUTABLE:
        facts = _no_executable(exam, str(process.get('stderr', '')), files)
    static = {check.name for check in exam.checks if check.static}
    checks = []
    for check in result.checks:
        if facts and check.verdict is Verdict.FAILED and check.check not in static:
            check = replace(check, **facts)
        checks.append(of_a_file(check))
    return replace(result, checks=tuple(checks))


def of_a_file(check: CheckResult) -> CheckResult:
    """Correct line numbers: a file has no magic line, which a cell's numbers count."""
    words = _IN_CELL.sub(lambda found: f'in line {int(found[1]) - 1} of the file', check.cause)
    return replace(check, cause=words)


def _not_built(output: str, files: Mapping[str, str]) -> dict[str, str]:
    found = diagnose(output, files)
    where = f'{found.where}: ' if found.where and not found.error.startswith(found.where) else ''
    return {
        'expected': 'a package that colcon builds',
        'observed': 'the build fails, so nothing could be run',
        'cause': f'{where}{found.error}'[:300],
        'cause_id': found.cause or 'build',
        'try_this': found.advice or 'Run colcon build in your workspace; read the first error.',
    }


def _no_executable(exam: Exam, said: str, files: Mapping[str, str]) -> dict[str, str]:
    name, package = exam.scenario.file.removesuffix('.py'), exam.scenario.build_type
    there = _there(said)
    observed = f'the package builds, but lib/{package} holds '
    observed += ', '.join(there['lib']) if there['lib'] else 'no executable'
    facts = {
        'expected': f'the executable {name}, as ros2 run {package} {name} starts it',
        'observed': observed,
    }
    if name in there['bin']:
        return {
            **facts,
            'cause': f'{name} is installed in bin/, where ros2 run does not look.',
            'cause_id': 'script_folder',
            'try_this': f'In setup.cfg: [install] install_scripts=$base/lib/{package}',
        }
    if 'setup.py' in files and 'CMakeLists.txt' not in files:
        return {
            **facts,
            'cause': f'setup.py makes no executable {name}.',
            'cause_id': 'entry_point_missing',
            'try_this': f"In console_scripts of setup.py: '{name} = {package}.MODULE:main'",
        }
    return {
        **facts,
        'cause': f'CMakeLists.txt installs no executable {name}.',
        'cause_id': 'executable_not_installed',
        'try_this': f'install(PROGRAMS ... DESTINATION lib/${{PROJECT_NAME}}), file name {name}.',
    }


def _there(said: str) -> dict[str, list[str]]:
    """Return the list that run_package has written; students can forge it, so it only explains."""
    found: dict[str, list[str]] = {'lib': [], 'bin': []}
    lines = [line for line in said.splitlines() if line.startswith(MARK)]
    try:
        data = json.loads(lines[-1].removeprefix(MARK)) if lines else {}
    except ValueError:
        return found
    for word in found:
        names = data.get(word) if isinstance(data, dict) else None
        if isinstance(names, list):
            found[word] = [str(name)[:60] for name in names[:8]]
    return found

"""
Grade a complete ROS package: build it with colcon in the sandbox and run its executables.

The checks of an exam do not change, but an executable runs instead of a node file.  If the build
fails or the executable is missing, the feedback describes this problem.
"""

from collections.abc import Mapping
import copy
from dataclasses import replace
import re
from typing import Any

from autograder.exam.exam import Exam, Run
from autograder.judging.causes.builds import installed, NOT_BUILT, why_no_program
from autograder.recording import Recording
from autograder.results import ExamResult, Verdict

MANIFEST = 'package.xml'

_NAME = re.compile(r'<name>\s*([A-Za-z][A-Za-z0-9_-]{0,99})\s*</name>')
_IN_CELL = re.compile(r'^Lines? [\d, and]+(?=[:,])')


def package_name(files: Mapping[str, str]) -> str:
    """Return the package name in the manifest; empty if colcon could not build the files."""
    builds = 'CMakeLists.txt' in files or 'setup.py' in files
    found = _NAME.search(files.get(MANIFEST, ''))
    return found[1] if found and builds else ''


def as_package(exam: Exam, package: str) -> Exam:
    """Return an exam that builds the package and runs its executable instead of a node file."""
    if exam.scenario.program != 'node':
        return exam
    changed = copy.copy(exam)
    first, *later = (
        replace(one, program='package', build_type=package) for one in exam.scenario.starts
    )
    changed.scenario = replace(first, again=next(iter(later), None))
    changed.facts = {**exam.facts, **changed.scenario.package_facts}
    changed.requires = tuple(name for name in exam.requires if not name.endswith('.py'))
    return changed


def explained(
    exam: Exam, result: ExamResult, recording: Recording | None, files: Mapping[str, str]
) -> ExamResult:
    """Return a result whose messages describe a package instead of a notebook's cells."""
    run = Run(files, recording or Recording({}, ()), exam.facts)
    facts: dict[str, Any] = {}
    if why := why_no_program(run):
        if run.recording.process['exit'] == NOT_BUILT:
            expected = 'a package that colcon can build'
            observed = 'the build fails, so nothing could be run'
        else:
            name, package = run.facts['executable'], run.facts['package']
            there = ', '.join(installed(run)['lib']) or 'no executable'
            expected = f'the executable {name}, which ros2 run {package} {name} starts'
            observed = f'the package builds, but lib/{package} contains {there}'
        facts = {'expected': expected, 'observed': observed, 'cause': why.text}
        facts |= {'cause_id': why.cause_id, 'try_this': why.try_this}
    static = {check.name for check in exam.checks if check.static}
    checks = []
    for check in result.checks:
        if facts and check.verdict is Verdict.FAILED and check.check not in static:
            check = replace(check, **facts)
        # A cell's line numbers include its magic line.
        cause = _IN_CELL.sub(_without_magic_line, check.cause)
        checks.append(replace(check, cause=cause))
    return replace(result, checks=tuple(checks))


def _without_magic_line(place: re.Match[str]) -> str:
    return re.sub(r'\d+', lambda line: str(int(line[0]) - 1), place[0])

"""Explain why the executable of a package did not start: build, install, entry point."""

from __future__ import annotations

from collections.abc import Mapping
import json
import re
from typing import Any

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.builds import build_cause, diagnose, output_of
from autograder.judging.causes.text_table import cause_of
from autograder.judging.causes.tracebacks import traceback_of

NO_EXECUTABLE, NOT_BUILT = 97, 98
MARK = 'run_package: '
"""Start of the line from ``inside/run_package.py``, which imports nothing from the project."""
_NO_ENTRY = re.compile(
    r"No module named '(?P<module>[\w.]{1,80})'"
    r"|module '(?P<place>[\w.]{1,80})' has no attribute '(?P<function>\w{1,60})'"
)


def why_no_program(run: Run) -> Cause | None:
    """Return why a package has no program to run, None if it has one or is not a package."""
    process: Mapping[str, Any] = run.recording.process
    code = process.get('exit') if run.facts.get('package') else None
    if code == NOT_BUILT:
        return build_cause(diagnose(output_of(run), run.files))
    if code == NO_EXECUTABLE:
        return _why_no_executable(run)
    return _why_no_entry(run) if code is not None else None


def _why_no_entry(run: Run) -> Cause | None:
    """Explain an entry point that names a missing package, module or function."""
    trace, package = traceback_of(run), run.facts['package']
    found = _NO_ENTRY.search(trace.error) if trace is not None and not trace.line else None
    if found is None:
        return None
    words = {**found.groupdict(), 'executable': run.facts['executable'], 'package': package}
    if found['function']:
        return cause_of('entry_point_function', **words)
    return cause_of('no_modules' if found['module'] == package else 'entry_point_module', **words)


def _why_no_executable(run: Run) -> Cause:
    name, package = run.facts['executable'], run.facts['package']
    there = installed(run)
    others = [one for one in there['others'] if one != package]
    if name in there['bin'] or (others and not there['lib']):
        folder = 'bin/' if name in there['bin'] else f'lib/{others[0]}/'
        return cause_of('script_folder', executable=name, folder=folder, package=package)
    if 'setup.py' in run.files and 'CMakeLists.txt' not in run.files:
        has = f'; it makes {", ".join(there["lib"])}' if there['lib'] else ''
        return cause_of('entry_point_missing', executable=name, has=has, package=package)
    return cause_of('executable_not_installed', executable=name)


def installed(run: Run) -> dict[str, list[str]]:
    """
    Return the installed files that ``run_package`` lists.

    Students can forge this list, so it only explains.
    """
    found: dict[str, list[str]] = {'lib': [], 'bin': [], 'others': []}
    said = str(run.recording.process.get('stderr', ''))
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

"""
Explain in one line why a package was not built, or why its executable did not start.

The tables ``of_builds.txt`` and ``of_python_builds.txt`` list mistakes that learners make in a
package.  Each is recognised by the actual output of the tools (ROS 2 Jazzy, colcon, CMake).
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
import json
from pathlib import Path
import re

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.text_table import cause_of, Row, rows_of
from autograder.judging.causes.tracebacks import traceback_of
from autograder.recording import Recording

_CMAKE = re.compile(
    r'^CMake Error (?:at|in) (?P<place>CMakeLists\.txt(?::\d+)?)?[^\n]*\n'
    r'(?P<said>(?:[ \t]+\S[^\n]*\n?|\n(?=[ \t]+\S))*)',
    re.MULTILINE,
)
_FOLDERS = re.compile(r'(?<![\w.)}>/])(?:/[\w.+-]+)+/')
_ERROR_LINE = re.compile(r'^(?!ninja: ).*\berror:|^CMake Error: |\wError: |^[\w.]+\.Invalid\w+: ')
_NO_ENTRY = re.compile(
    r"No module named '(?P<module>[\w.]{1,80})'"
    r"|module '(?P<place>[\w.]{1,80})' has no attribute '(?P<function>\w{1,60})'"
    r"|(?P<called>'module' object is not callable)"
)
LONGEST = 240
"""Maximum length of a tool's message in feedback [characters]."""
NO_EXECUTABLE, NOT_BUILT = 97, 98
MARK = 'run_package: '
"""Start of the line from ``inside/run_package.py``, which imports nothing from the project."""

MISSING_AMENT_PACKAGE = cause_of('missing_ament_package')
NO_MESSAGES = cause_of('no_messages')


def output_of(recording: Recording) -> str:
    """Return everything that a program or a build printed."""
    return ''.join(str(recording.process.get(name, '')) for name in ('stderr', 'stdout'))


def why_build_failed(found: Cause) -> Cause:
    """Return a cause from :func:`diagnose`, or the first error of the build if it is unknown."""
    return found if found.cause_id else cause_of('build', error=found.text)


def texts_of(folder: Path) -> dict[str, str]:
    """Return the files of a package that may contain the mistake, relative path to text."""
    paths = [folder / 'package.xml', folder / 'CMakeLists.txt', *sorted(folder.glob('msg/*.msg'))]
    return {
        path.relative_to(folder).as_posix(): path.read_text(encoding='utf-8', errors='replace')
        for path in paths
        if path.is_file()
    }


def diagnose(output: str, files: Mapping[str, str]) -> Cause:
    """
    Return why a build failed; the text begins with the file and, if known, the line.

    If the mistake is not in the tables, the cause has no name, and its text is the decisive line.

    :param output: everything that the build printed; untrusted
    :param files: files of the package, relative path to text, in which to find the mistake
    """
    text = ' '.join(output.split())
    for row in mistakes(python='setup.py' in files):
        if match := re.search(row.when, text):
            groups = match.groupdict()
            found, where = row.cause(**groups), _where(row, groups, files)
            known = not where or found.text.startswith(where)
            return found if known else replace(found, text=f'{where}: {found.text}')
    return Cause('', _decisive_line(output), 'Read the log, above all its first error.')


def why_no_messages(output: str, files: Mapping[str, str]) -> Cause:
    """Return why a package that was built has no messages that a program can use."""
    found = diagnose(output, files)
    return found if found.cause_id else NO_MESSAGES


def mistakes(python: bool) -> list[Row]:
    """Return the rows for a package, each with the text and the file of the line to change."""
    rows = [*rows_of('of_builds.txt')]
    if not python:
        return rows
    manifest = [row for row in rows if row.more[1:] == ['package.xml']]
    others = [row for row in manifest if row.cause_id != 'wrong_build_type']
    return [*rows_of('of_python_builds.txt'), *others]


def _where(row: Row, groups: Mapping[str, str], files: Mapping[str, str]) -> str:
    place, name, *_ = (*(one.format(**groups) for one in row.more), *_NO_PLACE[len(row.more) :])
    if place.startswith('#'):
        return f'{name}, line {place[1:]}'
    messages = sorted(path for path in files if path.startswith('msg/'))
    names = messages if name == 'msg' else [name]
    found = _line_with(re.compile(re.escape(place)), files, names) if place else ''
    return found or ('' if name == 'msg' else name)


_NO_PLACE = ('', 'CMakeLists.txt')
_WITH_COMMENTS = ('CMakeLists.txt', 'setup.py', 'setup.cfg')


def _line_with(pattern: re.Pattern[str], files: Mapping[str, str], names: Iterable[str]) -> str:
    """Return the first file and line with a match outside comments; empty if there is none."""
    for name in names:
        for number, line in enumerate(files.get(name, '').splitlines(), 1):
            if name in _WITH_COMMENTS:  # the lesson's comments name the commands too
                line = line.partition('#')[0]
            if pattern.search(f' {" ".join(line.split())} '):
                return f'{name}, line {number}'
    return ''


def _decisive_line(output: str) -> str:
    """Return the first error in the output, or otherwise its last line, as complete sentences."""
    for error in _CMAKE.finditer(output):
        # If execute_process() failed, a later line contains its error.
        if 'execute_process' not in error['said'].lstrip().partition('\n')[0]:
            place = f'{error["place"].replace(":", ", line ")}: ' if error['place'] else ''
            return _sentences(place + ' '.join(error['said'].split()))
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    # Ignore ninja's error about a missing build.ninja: an earlier CMake error is the reason.
    errors = filter(_ERROR_LINE.search, lines)
    return _sentences(next(errors, (lines or ['The build printed nothing.'])[-1]))


def _sentences(text: str) -> str:
    """Return the first complete sentences of a text, without absolute folder names."""
    text = _FOLDERS.sub('', text)
    if len(text) <= LONGEST:
        return text
    end = text.rfind('. ', 0, LONGEST)
    return text[: end + 1] if end > 0 else f'{text[:LONGEST].rpartition(" ")[0]} …'


# -- the executable of a package ---------------------------------------------------------------


def why_no_program(run: Run) -> Cause | None:
    """Return why a package has no program to run; None if it has one or is not required."""
    code = run.recording.process.get('exit') if run.facts.get('package') else None
    if code == NOT_BUILT:
        return why_build_failed(diagnose(output_of(run.recording), run.files))
    if code == NO_EXECUTABLE:
        return _why_no_executable(run)
    return _why_no_entry(run) if code else None


def _why_no_entry(run: Run) -> Cause | None:
    """Explain an entry point that names a missing package, module or function, or no function."""
    trace, package = traceback_of(run), run.facts['package']
    found = _NO_ENTRY.search(trace.error) if trace is not None and not trace.line else None
    if found is None:
        return None
    words = {**found.groupdict(), 'executable': run.facts['executable'], 'package': package}
    if found['module'] == package:
        return cause_of('no_modules', **words)
    kind = 'entry_point_module' if found['module'] else 'entry_point_function'
    why = cause_of('entry_point_without_function' if found['called'] else kind, **words)
    entry = re.compile(rf'\b{re.escape(run.facts["executable"])}\s*=\s*[\w.]')
    place = _line_with(entry, run.files, ['setup.py', 'setup.cfg'])
    return replace(why, text=f'{place}: {why.text}') if place else why


def _why_no_executable(run: Run) -> Cause:
    name, package = run.facts['executable'], run.facts['package']
    there = installed(run)
    others = [one for one in there['others'] if one != package]
    if name in there['bin'] or (others and not there['lib']):
        folder = 'bin/' if name in there['bin'] else f'lib/{others[0]}/'
        return cause_of('script_folder', executable=name, folder=folder, package=package)
    if 'setup.py' in run.files and 'CMakeLists.txt' not in run.files:
        has = f'; it defines {", ".join(there["lib"])}' if there['lib'] else ''
        return cause_of('entry_point_missing', executable=name, has=has, package=package)
    return cause_of('executable_not_installed', executable=name)


def installed(run: Run) -> dict[str, list[str]]:
    """
    Return the names of executables and of ``lib`` folders that ``run_package`` lists.

    Students can forge this list, so it is used only for explanations.
    """
    said = str(run.recording.process.get('stderr', ''))
    lines = [line.removeprefix(MARK) for line in said.splitlines() if line.startswith(MARK)]
    try:
        data = json.loads((lines or ['{}'])[-1])
    except ValueError:
        data = {}
    data = data if isinstance(data, dict) else {}
    names = {word: data.get(word) for word in ('lib', 'bin', 'others')}
    return {
        word: [str(name)[:60] for name in found[:8]] if isinstance(found, list) else []
        for word, found in names.items()
    }

"""
Explain failed builds in one line.

The tables ``of_builds.txt`` and ``of_python_builds.txt`` list mistakes that learners make in a
package.  Each is recognised by the actual output of the tools (ROS 2 Jazzy, colcon, CMake).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
import re

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.text_table import rows_of


@dataclass(frozen=True)
class Mistake:
    """
    One kind of mistake.

    :param pattern: regular expression, searched in the output after all white space is replaced by
        single spaces
    :param error: the decisive words; ``{name}`` is replaced by a group of the pattern
    :param advice: what to change; may contain the same groups
    :param cause: short stable name
    :param place: text that identifies the line to change, or ``#`` and the line number
    :param file: the file to change; ``msg`` is the .msg file that contains ``place``
    """

    pattern: str
    error: str
    advice: str
    cause: str
    place: str = ''
    file: str = 'CMakeLists.txt'


@dataclass(frozen=True)
class Diagnosis:
    """
    The reason why a build failed.

    :param cause: short stable name, empty if the mistake is not in the table
    :param error: the decisive line
    :param advice: one line about what to change
    :param where: file and, if known, line
    """

    cause: str
    error: str
    advice: str
    where: str


_CMAKE = re.compile(
    r'^CMake Error (?:at|in) (?P<place>CMakeLists\.txt(?::\d+)?)?[^\n]*\n'
    r'(?P<said>(?:[ \t]+\S[^\n]*\n?|\n(?=[ \t]+\S))*)',
    re.MULTILINE,
)
_FOLDERS = re.compile(r'(?<![\w.)}>/])(?:/[\w.+-]+)+/')
_ERROR_LINE = re.compile(r'^(?!ninja: ).*\berror:|^CMake Error: |\wError: |^[\w.]+\.Invalid\w+: ')
LONGEST = 240
"""Maximum length of a tool's message in feedback [characters]."""


def _mistakes(name: str) -> tuple[Mistake, ...]:
    return tuple(Mistake(*rest, *head.split('|')) for head, *rest in rows_of(name))


MISTAKES = _mistakes('of_builds.txt')
PYTHON_MISTAKES = (
    *_mistakes('of_python_builds.txt'),
    *(one for one in MISTAKES if one.file == 'package.xml' and one.cause != 'wrong_build_type'),
)
MISSING_AMENT_PACKAGE = Diagnosis(
    'missing_ament_package',
    'The package was built, but ROS 2 cannot find it: nothing was registered.',
    'Make ament_package() the last line of CMakeLists.txt.',
    'CMakeLists.txt',
)
NO_MESSAGES = Diagnosis(
    'no_messages',
    'The package was built without a message.',
    'Call rosidl_generate_interfaces(${PROJECT_NAME} "msg/Name.msg" ...) there.',
    'CMakeLists.txt',
)


def output_of(run: Run) -> str:
    """Return everything that a program or a build printed."""
    return ''.join(str(run.recording.process.get(name, '')) for name in ('stderr', 'stdout'))


def build_cause(found: Diagnosis) -> Cause:
    """Return the cause of a failed build; its text begins with the file and line."""
    if not found.cause:
        advice = 'Build the package yourself and read the first error.'
        return Cause('build', f'colcon stops: {found.error}', advice)
    known = not found.where or found.error.startswith(found.where)
    place = '' if known else f'{found.where}: '
    return Cause(found.cause, f'{place}{found.error}', found.advice)


def texts_of(folder: Path) -> dict[str, str]:
    """
    Return the files of a package that may contain the mistake, relative path to text.

    :param folder: the package's folder
    """
    paths = [folder / 'package.xml', folder / 'CMakeLists.txt', *sorted(folder.glob('msg/*.msg'))]
    return {
        path.relative_to(folder).as_posix(): path.read_text(encoding='utf-8', errors='replace')
        for path in paths
        if path.is_file()
    }


def diagnose(output: str, files: Mapping[str, str]) -> Diagnosis:
    """
    Return the diagnosis of a failed build.

    :param output: everything that the build printed; untrusted
    :param files: files of the package, relative path to text, to find the line of the mistake
    """
    text = ' '.join(output.split())
    for mistake in PYTHON_MISTAKES if 'setup.py' in files else MISTAKES:
        match = re.search(mistake.pattern, text)
        if match:
            groups = match.groupdict()
            return Diagnosis(
                mistake.cause,
                mistake.error.format_map(groups),
                mistake.advice.format_map(groups),
                _where(mistake, groups, files),
            )
    return Diagnosis('', _decisive_line(output), 'Read the log; the first error counts.', '')


def _where(mistake: Mistake, groups: Mapping[str, str], files: Mapping[str, str]) -> str:
    name, place = mistake.file.format_map(groups), mistake.place.format_map(groups)
    if place.startswith('#'):
        return f'{name}, line {place[1:]}'
    messages = sorted(path for path in files if path.startswith('msg/'))
    for path in messages if name == 'msg' else [name]:
        for number, line in enumerate(files.get(path, '').splitlines(), 1):
            if place and place in f' {" ".join(line.split())} ':
                return f'{path}, line {number}'
    return '' if name == 'msg' else name


def _decisive_line(output: str) -> str:
    """Return the first error in the output, or otherwise its last line, as complete sentences."""
    for error in _CMAKE.finditer(output):
        # If execute_process() failed, a later line contains its error.
        if 'execute_process' not in error['said'].lstrip().partition('\n')[0]:
            place = f'{error["place"].replace(":", ", line ")}: ' if error['place'] else ''
            return _sentences(place + ' '.join(error['said'].split()))
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    for line in lines:
        # Skip ninja's error about a missing build.ninja, which follows from an earlier error of
        # CMake.
        if _ERROR_LINE.search(line):
            return _sentences(line)
    return _sentences(lines[-1]) if lines else 'The build printed nothing.'


def _sentences(text: str) -> str:
    """Return the first complete sentences of a text, without absolute folder names."""
    text = _FOLDERS.sub('', text)
    if len(text) <= LONGEST:
        return text
    end = text.rfind('. ', 0, LONGEST)
    return text[: end + 1] if end > 0 else f'{text[:LONGEST].rpartition(" ")[0]} …'

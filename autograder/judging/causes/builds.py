"""
What a failed build means, in one line.

A table of the mistakes that learners make in ``.msg`` files, ``package.xml`` and
``CMakeLists.txt``, each recognised by what the tools really print (ROS 2 Jazzy, colcon, CMake).
The first entry that matches wins, so entries that explain others stand first.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
import re

from autograder.judging.text_table import rows


@dataclass(frozen=True)
class Mistake:
    """
    One kind of mistake.

    :param pattern: found in the output, in which all white space is one space
    :param error: the decisive words; ``{name}`` stands for a group of the pattern
    :param advice: what to change; may use the same groups
    :param cause: short stable name
    :param place: text of the line to change, to find its number, or ``#`` and the number
    :param file: the file to change; ``msg`` is the one that has the place
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
    Why a build failed.

    :param cause: short stable name, empty if the mistake is not in the table
    :param error: the decisive line
    :param advice: one line on what to change
    :param where: file and, where known, line
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
"""Characters of what a tool says that are passed on."""

_TABLE = r"""
xml_not_well_formed|#{number}|package.xml
The manifest contains invalid XML: (?P<what>[^:]+: line (?P<number>\d+), column \d+)
package.xml is not well-formed XML: {what}.
Look at that line and the one before: every <tag> needs its </tag>, spelled alike.

wrong_build_type|build_type|package.xml
(?:colcon_ros\.task\.ament_python|setup\.py', '--help-commands')
package.xml asks for a pure Python build, which makes no messages.
Write <export><build_type>ament_cmake</build_type></export>: only ament_cmake packages can have
  messages.

manifest_rule||package.xml
catkin_pkg\.package\.InvalidPackage: (?:Error\(s\) in package \S+ )?(?P<what>.*?)(?= CMake Error|
  Traceback|$)
{what}
package.xml needs name, version (as in 0.1.0), description, maintainer with email, and license.

missing_group|member_of_group|package.xml
must include '(?P<tag><member_of_group>rosidl_interface_packages</member_of_group>)'
package.xml does not say that the package has messages.
Add the line {tag} to package.xml.

name_mismatch|project(
package name '(?P<xml>[^']{1,80})' in \S* does not match current PROJECT_NAME
  '(?P<cmake>[^']{1,80})'
package.xml says '{xml}', CMakeLists.txt says project({cmake}).
Write the same name in both files: small letters, digits and underscores.

comma
The target name "[^",]{0,200},[^"]{0,200}" is reserved|the passed file '[^']{0,200},' doesn
There is a comma between the names.
Between the names in parentheses stand spaces and no commas:
  rosidl_generate_interfaces(${{PROJECT_NAME}} "msg/Name.msg" ...).

package_name|<name>{name}</name>|package.xml
'(?P<name>[^' ]{1,80})' is an invalid package name
'{name}' cannot be the name of a package.
Use small letters, digits and underscores, in package.xml and in project(...) alike.

missing_find_package_generators|rosidl_generate_interfaces
Unknown CMake command "rosidl_generate_interfaces"
CMake does not know rosidl_generate_interfaces().
Add find_package(rosidl_default_generators REQUIRED) above it.

missing_find_package_ament|ament_package
Unknown CMake command "ament_package"
CMake does not know ament_package().
Add find_package(ament_cmake REQUIRED) after project(...).

unknown_command|#{number}
CMakeLists\.txt:(?P<number>\d+) \(\w+\): Unknown CMake command "(?P<command>\w+)"
CMake does not know {command}().
Check the spelling, and that the find_package(...) it comes from is above it.

missing_find_package|{dependency}
the passed dependency '(?P<dependency>\w+)' has not been found before using
'{dependency}' is used in DEPENDENCIES but was not looked for.
Add find_package({dependency} REQUIRED) above rosidl_generate_interfaces().

package_not_found|{dependency}
By not providing "Find(?P<dependency>\w+_(?:msgs|srvs))\.cmake"
There is no package '{dependency}'.
Check its spelling. Message packages of others are installed if environment/messages.txt names
  them.

package_not_found|{dependency}
By not providing "Find(?P<dependency>\w+)\.cmake"
There is no package '{dependency}'.
Check its spelling, as in builtin_interfaces, rosidl_default_generators, ament_cmake.

dependencies_keyword|{file}
the passed file '(?P<file>\w+_interfaces|\w+_msgs)' doesn't exist
CMakeLists.txt names '{file}' as a file, and it is a package.
Write DEPENDENCIES before the packages: DEPENDENCIES {file}.

file_not_listed|{file}
the passed file '(?P<file>[^']*)' doesn't exist
CMakeLists.txt names '{file}', and there is no such file.
Name it from the package folder with the same capitals, as in "msg/Name.msg".

no_file_listed|rosidl_generate_interfaces
rosidl_generate_interfaces\(\) called without any interface files
rosidl_generate_interfaces() is given no message file.
Name the file behind the target, as in "msg/Name.msg".

ament_package_first|ament_package
rosidl_generate_interfaces\(\) must be called before ament_package\(\)
ament_package() is above rosidl_generate_interfaces().
Move ament_package() to the last line.

cmake_syntax|#{number}
CMakeLists\.txt:(?P<number>\d+): Parse error\. (?P<what>[^.]*)\.
CMake cannot read the file: {what}.
Look for a bracket or a quote that was opened and not closed, in or above that line.

missing_minimum_required
No cmake_minimum_required command is present
cmake_minimum_required() is missing.
Make cmake_minimum_required(VERSION 3.16) the first line.

python_install_twice|ament_python_install_package
ament_python_install_package(?:\(\)|\.cmake)|"ament_cmake_python_copy_\w+" because another
rosidl_generate_interfaces() already makes the Python package of this name.
Remove ament_python_install_package(${{PROJECT_NAME}}).

dotted_type|{line}|msg/{message}.msg
Error processing '(?P<line>[^']*)' of '\S+/(?P<message>\w+)': '+(?P<name>\w+(?:\.\w+)+)' is an
  invalid message name
'{name}' is written as in Python.
In a .msg file a type of another package has one slash, as in builtin_interfaces/Time.

field_order|{line}|msg/{message}.msg
Error processing '(?P<line>[^']*)' of '\S+/(?P<message>\w+)': '+(?P<name>\w+:)' is an invalid
  message name
'{line}' has the name first.
A field is a type, a space, a name, as in: string name

unknown_type|{line}|msg/{message}.msg
Error processing '(?P<line>[^']*)' of '\S+/(?P<message>\w+)': '+(?P<name>[^' ]*)' is an invalid
  message name
There is no type '{name}'.
Numbers are float64, float32, int32 and so on, texts are string; a type of a package is written
  package/Type.

bad_field_name|{line}|msg/{message}.msg
Error processing '(?P<line>[^']*)' of '\S+/(?P<message>\w+)': '+(?P<name>[^' ]*)' is an invalid
  field name
'{name}' cannot be the name of a field.
Use lower-case letters, digits and single underscores, as in my_field.

msg_in_type|{line}|msg/{message}.msg
Error processing '(?P<line>[^']*)' of '\S+/(?P<message>\w+)':
  '(?P<package>\w+)/msg/(?P<type>\w+)'
'{package}/msg/{type}' has one part too many.
Inside a .msg file the type is {package}/{type}.

incomplete_field|{line}|msg/{message}.msg
Error with: \S+ (?P<message>\w+) (?P<line>\S+) .*InvalidFieldDefinition
'{line}' is no complete field.
A field is a type, a space, a name, as in: string name

indented_line||msg
the constant type '' must be a primitive type|Error processing ' [^']{0,200}' of
A line of the .msg file begins with a space.
Begin every constant and every field at the left edge.

duplicate_field| {name}|msg
the fields iterable contains duplicate names: (?P<name>\w+)
Two fields are called '{name}'.
Give one of them another name.

missing_dependencies|rosidl_generate_interfaces
^(?=.*type_description).*?KeyError: '(?P<dependency>\w+)'
A message uses a type of '{dependency}', and CMake was not told.
Add DEPENDENCIES {dependency} inside rosidl_generate_interfaces(), and find_package({dependency}
  REQUIRED) above it.

type_without_package|{type} |msg
No such file or directory: '\S*/msg/(?P<type>\w+)\.json'
'{type}' was looked for in this package.
A type of another package is written package/Type, as in builtin_interfaces/Time.

reserved_word| {name}|msg
struct\.h:\d+:\d+: error: .{0,400}?\| \S{1,80} (?P<name>\w+);\s
'{name}' is a word that C or C++ keeps for itself.
Give the field another name.

nothing_to_build||package.xml
ignoring unknown package|Summary: 0 packages
colcon found no package.
package.xml needs <name>, <version> and the other required tags.
"""
"""Rows of four: cause, place and file; what is found in the output; the error; the advice."""

_PYTHON_TABLE = r"""
not_a_python_package|build_type|package.xml
does not appear to contain CMakeLists\.txt
package.xml does not say that the package is built with setup.py.
Write <export><build_type>ament_python</build_type></export>.

setup_py|#{number}|setup.py
exec\(code, g\) File "<string>", line (?P<number>\d+).{0,300}?
  (?P<what>\w{1,20}Error: [^.\[]{1,60}?) ?(?:\.|\[|File|Traceback)
Python stops in setup.py: {what}.
Is a comma, a quote or a bracket missing in that line or the one above? Is each name spelled right?

not_a_file|{file}|setup.py
can't copy '(?P<file>[^']{1,80})': doesn't exist
data_files of setup.py has '{file}', and there is no such file.
Name each file from the package folder; the one in resource/ has the name of the package.
"""
"""The same for packages with a setup.py."""


def _mistakes(table: str) -> tuple[Mistake, ...]:
    return tuple(
        Mistake(pattern, error, advice, *head.split('|'))
        for head, pattern, error, advice in rows(table)
    )


MISTAKES = _mistakes(_TABLE)
PYTHON_MISTAKES = (
    *_mistakes(_PYTHON_TABLE),
    *(one for one in MISTAKES if one.file == 'package.xml' and one.cause != 'wrong_build_type'),
)
MISSING_AMENT_PACKAGE = Diagnosis(
    'missing_ament_package',
    'It was built, but ROS 2 cannot find it: nothing was registered.',
    'Make ament_package() the last line of CMakeLists.txt.',
    'CMakeLists.txt',
)
NO_MESSAGES = Diagnosis(
    'no_messages',
    'It was built, but no message was made.',
    'Call rosidl_generate_interfaces(${PROJECT_NAME} "msg/Name.msg" ...) there.',
    'CMakeLists.txt',
)


def texts_of(folder: Path) -> dict[str, str]:
    """
    Return the texts of a package that a mistake may lie in, by their path inside it.

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
    Find the decisive line of a failed build.

    :param output: all that the build printed; it may come from anybody
    :param files: texts of the package by their path inside it, to name the line of the mistake
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
    """Return the first words that look like an error, or the last line: whole sentences."""
    for error in _CMAKE.finditer(output):
        # What an execute_process() has ended with is in a later line.
        if 'execute_process' not in error['said'].lstrip().partition('\n')[0]:
            place = f'{error["place"].replace(":", ", line ")}: ' if error['place'] else ''
            return _sentences(place + ' '.join(error['said'].split()))
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    for line in lines:
        # That there is no build.ninja follows from what CMake has said.
        if _ERROR_LINE.search(line):
            return _sentences(line)
    return _sentences(lines[-1]) if lines else 'The build printed nothing.'


def _sentences(text: str) -> str:
    """Return the first whole sentences of a text, without the folders of this machine."""
    text = _FOLDERS.sub('', text)
    if len(text) <= LONGEST:
        return text
    end = text.rfind('. ', 0, LONGEST)
    return text[: end + 1] if end > 0 else f'{text[:LONGEST].rpartition(" ")[0]} …'

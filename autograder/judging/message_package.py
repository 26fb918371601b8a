"""
What exams about a message package have in common: its three files, and how its build ended.

Bodies of checks as in :mod:`autograder.judging.checks`, for ``.msg`` files and ``package.xml``; a
build is explained from what the tools printed, by :mod:`autograder.judging.causes.builds`.  All of
it reads text that may come from anybody.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
import re
import xml.etree.ElementTree as ElementTree

from autograder.exam.exam import Cause, Failed, Run
from autograder.judging.causes.builds import diagnose, NO_MESSAGES
from autograder.judging.causes.ended import close_name

Fields = Sequence[tuple[str, str]]
"""Types and names of fields, in order."""

PRIMITIVE = re.compile(r'bool|byte|char|float32|float64|u?int(?:8|16|32|64)|w?string')
_ELEMENT = re.compile(r'[\w/]*')
_BOUNDS = (
    (re.compile(r'\[(\d+)\]$'), '[{0}] is exactly {0}'),
    (re.compile(r'\[<=(\d+)\]$'), '[<={0}] is at most {0}'),
    (re.compile(r'<=(\d+)$'), '<={0} is at most {0} characters'),
)
ENDED = {
    'waits_outside': 'it waited for something that never came',
    'cpu_limit': 'it used more than 30 s of processor time, three times what it needs',
    'memory_limit': 'it used more than 1 GiB of memory',
    'output_limit': 'it printed more than 8 MB',
}


def fields_of(text: str) -> list[tuple[str, str]]:
    """
    Read a message definition as (type, name) pairs, in order, without constants.

    :param text: a .msg file; a line that is no field gives its own words back
    """
    found = []
    for line in text.splitlines():
        words = line.partition('#')[0].split()
        name, behind = words[1] if len(words) > 1 else '', words[2] if len(words) > 2 else ''
        constant = '=' in name.replace('<=', '') or behind.startswith('=')
        if words and not constant:
            found.append((words[0], name))
    return found


def require_fields(text: str, wanted: Fields) -> None:
    """
    Fail unless a message definition has exactly some fields, in their order.

    :param text: a .msg file
    """
    found = fields_of(text)
    if found == list(wanted):
        return
    right = sum(field in found for field in wanted)
    raise Failed(
        expected='; '.join(' '.join(field) for field in wanted),
        observed='; '.join(' '.join(field) for field in found)[:300] or 'no field',
        share=0.0 if len(found) > len(wanted) + 2 else round(right / (2 * len(wanted)), 2),
        why=_why_fields(found, wanted, text),
    )


def _why_fields(found: Fields, wanted: Fields, text: str) -> Cause:
    types = {name: kind for kind, name in wanted}
    wrong = [field for field in found if field not in wanted]
    if wrong:
        cause = _why_line(*wrong[0], types) or _why_type(*wrong[0], types)
        more = '; '.join(' '.join(field).strip()[:40] for field in wrong[1:4])
        return replace(cause, text=f'{cause.text} Also to mend: {more}' if more else cause.text)
    names = [name for _, name in found]
    missing = [name for name in types if name not in names]
    for line in map(str.strip, text.splitlines()):
        code = line.partition('#')[0]
        if any(re.search(rf'\b{name}\b', code) for name in missing):
            return Cause(
                'field_line',
                f'This line defines no field: {line[:60]}',
                'A field is: type, space, name, and perhaps a default. An = makes a constant.',
            )
    if missing:
        return Cause(
            'field_missing',
            f'{", ".join(missing)} {"is" if len(missing) == 1 else "are"} missing.',
            'Add one line for each field: the type first, then the name.',
        )
    twice = next((name for name in names if names.count(name) > 1), '')
    if twice:
        return Cause('field_twice', f'{twice} stands there twice.', 'Remove one of the lines.')
    place = next(number for number, name in enumerate(types) if names[number] != name)
    return Cause(
        'field_order',
        f'{names[place]} stands where {list(types)[place]} belongs.',
        'Put the fields in the order of the table: order is part of a message type.',
    )


def _why_line(kind: str, name: str, types: Mapping[str, str]) -> Cause | None:
    """Explain a line that is not written as a field is."""
    line = f'{kind} {name}'.strip()[:60]
    bare = _ELEMENT.match(name)[0]  # type: ignore[index]  # it matches anything
    if bare in types and name != bare:
        right = f'{types[bare]} {bare}'
        if name[len(bare)] in '[<':
            return Cause(
                'bound_behind_name',
                f'The bound stands behind the name in: {line}',
                f'It belongs to the type: {right}',
            )
        return Cause(
            'punctuation', f'{name[len(bare) :][:5]!r} is too much in: {line}', f'Write: {right}'
        )
    first = kind.rstrip(':')
    if first in types:
        return Cause(
            'name_first',
            f'The name stands before the type in: {line}',
            f'The type comes first: {types[first]} {first}',
        )
    if name.startswith(('<', '[')):
        return Cause('split_type', f'A space divides the type in: {line}', 'Write no space in it.')
    if not name:
        return Cause(
            'field_line', f'This line defines no field: {line}', 'A field is: type, space, name.'
        )
    return None


def _why_type(kind: str, name: str, types: Mapping[str, str]) -> Cause:
    """Explain a field of which the name or the type is wrong."""
    kind, shown = kind[:60], name[:40]
    if name.isupper():
        return Cause(
            'constant_without_equals',
            f'{kind} {shown} is read as a field, and there is no such field.',
            'A constant has an = sign between its name and its value.',
        )
    if name not in types:
        near = close_name(name, types)
        return Cause(
            'field_name',
            f'There is no field {shown!r} in the specification.',
            f'Did you mean {near}?' if near else 'Compare with the table.',
        )
    wanted = types[name]
    element, right = (_ELEMENT.match(one)[0] for one in (kind, wanted))  # type: ignore[index]
    package, _, last = wanted.partition('/')
    if last and '.' in kind:
        return Cause(
            'dotted_type',
            f'{kind} is Python; in a .msg file a type of another package has a slash.',
            f'Write {wanted}.',
        )
    if kind == f'{package}/msg/{last}':
        return Cause(
            'msg_in_type',
            f'{kind} is the name on the command line; a .msg file leaves the /msg out.',
            f'Write {wanted}.',
        )
    if last and kind == last:
        return Cause(
            'type_without_package',
            f'{kind} alone is looked for in your own package.',
            f'Write {wanted}.',
        )
    if element == right:
        return Cause(
            'bound',
            f'{kind} {shown} has another bound, or none.',
            f'{_bound_of(wanted)}: {wanted} {name}',
        )
    known = '/' in kind or PRIMITIVE.fullmatch(element)
    return Cause(
        'field_type' if known else 'unknown_type',
        f'{shown} has the type {kind}' + ('.' if known else ', which .msg files do not know.'),
        f'Its type is {wanted}.',
    )


def _bound_of(wanted: str) -> str:
    for pattern, text in _BOUNDS:
        if match := pattern.search(wanted):
            return text.format(match[1])
    return 'No bound is asked for'


@dataclass(frozen=True)
class Declaration:
    """
    Something that ``package.xml`` has to say (REP 149).

    :param line: how the lesson writes it
    :param name: the package or group
    :param ways: sets of tags that all say it
    :param why: what it is good for
    """

    line: str
    name: str
    ways: tuple[str, ...]
    why: str


DECLARATIONS = (
    Declaration(
        '<buildtool_depend>ament_cmake</buildtool_depend>',
        'ament_cmake',
        ('buildtool_depend',),
        'ament_cmake builds this package, and has to be there first.',
    ),
    Declaration(
        '<buildtool_depend>rosidl_default_generators</buildtool_depend>',
        'rosidl_default_generators',
        ('buildtool_depend', 'build_depend', 'depend'),
        'The generators turn the .msg file into code while the package is built.',
    ),
    Declaration(
        '<depend>builtin_interfaces</depend>',
        'builtin_interfaces',
        ('depend', 'build_depend exec_depend'),
        'Time is a type of builtin_interfaces, when the package is built and when it is used.',
    ),
    Declaration(
        '<exec_depend>rosidl_default_runtime</exec_depend>',
        'rosidl_default_runtime',
        ('exec_depend', 'depend'),
        'Programs that use the message need the runtime of generated code.',
    ),
    Declaration(
        '<member_of_group>rosidl_interface_packages</member_of_group>',
        'rosidl_interface_packages',
        ('member_of_group',),
        'By this group ROS 2 knows packages that have messages.',
    ),
)


def require_declarations(text: str, package: str) -> None:
    """
    Fail unless a package.xml declares what generating and using its message needs.

    :param text: a package.xml
    :param package: name that the package must have
    """
    try:
        root = ElementTree.fromstring(text)  # noqa: S314 - expat refuses bombs
    except ElementTree.ParseError as error:
        raise Failed(
            expected='a well-formed package.xml',
            observed=f'XML that cannot be read: {error}',
            why=Cause('xml', 'A tag is not closed, or is misspelled.', 'Look at that line.'),
        ) from None
    have = {(child.tag, (child.text or '').strip()) for child in root}
    missing = {
        one.line: _why_not_declared(one, have)
        for one in DECLARATIONS
        if not any({(tag, one.name) for tag in way.split()} <= have for way in one.ways)
    }
    name, kind = root.findtext('name', '').strip(), root.findtext('export/build_type', '').strip()
    if name != package:
        missing = {f'<name>{package}</name>': f'The package is called {name[:40]!r}.', **missing}
    if kind != 'ament_cmake':
        line = '<export><build_type>ament_cmake</build_type></export>'
        missing[line] = 'Only packages of type ament_cmake can have messages.'
    if missing:
        total = len(DECLARATIONS) + 2
        first = next(iter(missing))
        raise Failed(
            expected='the declarations of the lesson, all of them',
            observed='missing: ' + ', '.join(missing),
            share=round(0.5 * (1 - len(missing) / total), 2) if len(missing) < total // 2 else 0,
            why=Cause('manifest', missing[first], f'Write {first}.'),
        )


def _why_not_declared(wanted: Declaration, have: set[tuple[str, str]]) -> str:
    for tag, name in sorted(have):
        if name == wanted.name:
            return f'{name} is declared by <{tag[:40]}>, which says something else. {wanted.why}'
    return wanted.why


def why_no_build(run: Run) -> Cause:
    """Explain a message package of which no message came, from how its build ended."""
    process = run.recording.process
    killed = str(process.get('killed', ''))
    if killed:
        how = ENDED.get(killed, 'it used more than it may')
        return Cause(
            killed,
            f'The build was ended: {how}.',
            'Run build_messages() in the notebook; look for a command that does not end.',
        )
    output = ''.join(str(process.get(name, '')) for name in ('stderr', 'stdout'))
    found = diagnose(output, run.files)
    if not found.cause and 'Traceback' in output and 'echo_node.py' in output:
        found = NO_MESSAGES
    where = '' if found.error.startswith(found.where) else f'{found.where}: '
    return Cause(
        found.cause or 'build',
        f'{where}{found.error}' if found.cause else f'colcon stops: {found.error}',
        found.advice if found.cause else 'Run build_messages() and read the first error.',
    )

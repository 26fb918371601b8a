"""
Lesson 04, part 1: the message of a weather station, and its package.

Constants and defaults are no part of a type's hash, so the file answers for them.  If the fields
are right, the package is built, and the hash of the built type is read from the graph.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
import re

from autograder.exam import Cause, Exam, Failed, Run
from autograder.exams.visible.temperature_message import (
    fields_of,
    missing_or_disordered,
    no_such_field,
)
from autograder.scenario import Scenario

MSG, MANIFEST, CMAKE = 'msg/Station.msg', 'package.xml', 'CMakeLists.txt'
TYPE = 'station_interfaces/msg/Station'
TYPE_HASH = 'RIHS01_a7dcc7281cddb471d19921562db327cb7292409acdde3aff436ea7690039ebb3'
"""Of names, types and order, as the generators compute it for the reference."""
FIELDS = (
    ('builtin_interfaces/Time', 'stamp'),
    ('float64', 'temperature'),
    ('string<=12', 'station_id'),
    ('float32[3]', 'wind'),
    ('uint8[<=8]', 'states'),
)
CONSTANTS = {'OK': 0, 'STALE': 1, 'BROKEN': 2}
DEFAULT = -40.0
_CONSTANT = re.compile(r'(\S+)\s+(\w+)\s*=\s*(\S+)')


def constants_of(text: str) -> dict[str, tuple[str, str]]:
    """
    Read the constants of a message definition as name to (type, value).

    :param text: a .msg file
    """
    found = {}
    for line in text.splitlines():
        match = _CONSTANT.fullmatch(line.partition('#')[0].strip())
        if match and not match[1].endswith('<'):
            found[match[2]] = (match[1], match[3])
    return found


def defines_the_fields(run: Run) -> None:
    """Station.msg has exactly the five fields, with these types and in this order."""
    found = fields_of(run.files.get(MSG, ''))
    if tuple(found) == FIELDS:
        return
    right = sum(field in found for field in FIELDS)
    raise Failed(
        expected='; '.join(' '.join(field) for field in FIELDS),
        observed='; '.join(' '.join(field) for field in found)[:300] or 'no field',
        share=0.0 if len(found) > len(FIELDS) + 2 else round(right / (2 * len(FIELDS)), 2),
        why=_why_fields(found, run.files.get(MSG, '')),
    )


def _why_fields(found: Sequence[tuple[str, str]], text: str) -> Cause:
    types = {name: kind for kind, name in FIELDS}
    for kind, name in found:
        if name not in types:
            return no_such_field(name, types)
        if kind == types[name]:
            continue
        if '[' in types[name] or '<=' in types[name]:
            return Cause(
                'bound',
                f'{kind[:40]} {name} has another bound, or none.',
                f'Its type is {types[name]}: [3] is exactly three, [<=8] at most eight.',
            )
        return Cause(
            'field_type', f'{name} has the type {kind[:40]}.', f'Its type is {types[name]}.'
        )
    missing = [name for _, name in FIELDS if name not in {name for _, name in found}]
    if missing:
        for line in map(str.strip, text.splitlines()):
            if any(re.search(rf'\b{name}\b', line.partition('#')[0]) for name in missing):
                return Cause(
                    'field_line',
                    f'This line defines no field: {line[:60]}',
                    'A field is: type, space, name, and perhaps a default. A bound belongs to the '
                    'type, and = makes a constant.',
                )
    return missing_or_disordered(missing)


def names_the_states(run: Run) -> None:
    """It has the constants OK, STALE and BROKEN of type uint8 with the values 0, 1 and 2."""
    found = constants_of(run.files.get(MSG, ''))
    wrong = [name for name, value in CONSTANTS.items() if not _is(found, name, value)]
    if not wrong and len(found) == len(CONSTANTS):
        return
    name = wrong[0] if wrong else next(name for name in found if name not in CONSTANTS)
    raise Failed(
        expected='uint8 OK=0; uint8 STALE=1; uint8 BROKEN=2',
        observed='; '.join(f'{k} {name}={v}' for name, (k, v) in found.items())[:200]
        or 'no constant',
        why=Cause(
            'constant',
            f'{name[:40]} is missing, has another type or value, or is not asked for.',
            'A constant is a type, a name in capitals, = and a value: uint8 STALE=1.',
        ),
    )


def _is(found: Mapping[str, tuple[str, str]], name: str, value: int) -> bool:
    kind, text = found.get(name, ('', ''))
    try:
        return kind in ('uint8', 'byte', 'char') and int(text, 0) == value
    except ValueError:
        return False


def starts_at_the_lowest(run: Run) -> None:
    """A new message has the temperature -40.0, by a default in the file, and no other default."""
    words = [
        line.partition('#')[0].split()
        for line in run.files.get(MSG, '').splitlines()
        if '=' not in line.partition('#')[0].replace('<=', '')
    ]
    defaults = {line[1]: ' '.join(line[2:]) for line in words if len(line) > 2}
    text = defaults.get('temperature', '')
    try:
        right = float(text) == DEFAULT and len(defaults) == 1
    except ValueError:
        right = False
    if not right:
        raise Failed(
            expected='float64 temperature -40.0, and no other default',
            observed='; '.join(f'{name} {value}' for name, value in defaults.items())[:200]
            or 'no default',
            why=Cause(
                'default',
                'A default stands behind the name, without =; it makes the value of a new '
                'message.',
                'Write: float64 temperature -40.0',
            ),
        )


def builds_the_type(run: Run) -> None:
    """The package builds with colcon, and the built type is the one that is asked for."""
    ends = run.recording.endpoints('publisher', '/echo_out')
    hashes = {str(end.get('type_hash', '')) for end in ends if end['type'] == TYPE}
    if TYPE_HASH in hashes:
        return
    output = ''.join(str(run.recording.process.get(name, '')) for name in ('stdout', 'stderr'))
    if ends:
        raise Failed(
            expected=f'{TYPE} with the fields of the table',
            observed='a type of the same name that other programs do not understand',
            why=Cause(
                'different_type', 'The hash of the type differs.', 'Compare the fields again.'
            ),
        )
    raise Failed(expected='a package that builds', observed='no built message', why=_why(output))


ADVICE = (
    ('KeyError', 'dependencies', 'Add DEPENDENCIES builtin_interfaces to the generating command.'),
    ('rosidl_interface_packages', 'manifest', 'Add the <member_of_group> to package.xml.'),
    ('Could not find a package configuration', 'find_package', 'Check each find_package(...).'),
    (
        'has not been found before',
        'find_package',
        'Find builtin_interfaces first.',
    ),
    ('Unknown CMake command', 'cmake', 'Is its find_package(...) missing above?'),
    ('Error(s) in package', 'xml', 'Look at package.xml.'),
    ('invalid XML', 'xml', 'Look at package.xml: every tag must be closed.'),
)


def _why(output: str) -> Cause:
    for sign, cause_id, advice in ADVICE:
        if sign in output:
            line = next(line for line in output.splitlines() if sign in line).strip()
            return Cause(cause_id, f'colcon stops: {line[:200]}', advice)
    return Cause(
        'build', 'colcon stops, or makes no message.', 'Run build_messages() and read its advice.'
    )


def build() -> Exam:
    """Return the exam; there is nothing in it to vary."""
    exam = Exam(
        'station_message',
        title='The type of a weather station',
        assignment='04_messages',
        part=1,
        cells=('station_msg', 'station_package_xml', 'station_cmakelists'),
        requires=(MSG, MANIFEST, CMAKE),
        scenario=Scenario(program='build', build_type=TYPE, appear_s=50.0, first_log_s=0.0),
        read='Part 2: The package',
    )
    exam.check(points=3, static=True)(defines_the_fields)
    exam.check(points=2, static=True)(names_the_states)
    exam.check(points=2, static=True)(starts_at_the_lowest)
    exam.check(points=3, needs=['defines_the_fields'])(builds_the_type)
    return exam


exam = build()

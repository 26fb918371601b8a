"""
Lesson 07, part 1: the message, its package.xml and its CMakeLists.txt.

Three checks read the files; the fourth builds the package with colcon in the sandbox and lets a
message of the built type travel to a probe that holds the reference type, and back.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
import random
import re
from typing import Any
import xml.etree.ElementTree as ElementTree

from autograder.causes import close_name
from autograder.exam import Cause, Exam, Failed, Run
from autograder.scenario import Feed, Scenario

FIELDS = (
    ('float64', 'temperature_value'),
    ('string', 'unit'),
    ('builtin_interfaces/Time', 'timestamp'),
    ('string', 'sensor_id'),
)
TYPE = 'temp_monitor_pkg/msg/Temperature'
LONGEST_CMAKE = 20_000  # characters; the lesson's file has 700
MSG, MANIFEST, CMAKE = 'msg/Temperature.msg', 'package.xml', 'CMakeLists.txt'


def fields_of(text: str) -> list[tuple[str, str]]:
    """
    Read a message definition as (type, name) pairs, in order, without constants.

    :param text: a .msg file; a line that is no field gives its own words back
    """
    found = []
    for line in text.splitlines():
        words = line.partition('#')[0].split()
        constant = len(words) > 1 and ('=' in words[1] or (words[2:3] and words[2][0] == '='))
        if words and not constant:
            found.append((words[0], words[1] if len(words) > 1 else ''))
    return found


def defines_the_fields(run: Run) -> None:
    """Temperature.msg has exactly the four fields, with these types and in this order."""
    found = fields_of(_text(run, MSG))
    expected = '; '.join(' '.join(field) for field in FIELDS)
    if tuple(found) == FIELDS:
        return
    right = sum(field in found for field in FIELDS)
    raise Failed(
        expected=expected,
        observed='; '.join(' '.join(field) for field in found)[:300] or 'no field',
        share=0.0 if len(found) > len(FIELDS) + 2 else round(right / (2 * len(FIELDS)), 2),
        why=_why_fields(found),
    )


def _why_fields(found: Sequence[tuple[str, str]]) -> Cause | None:
    types = {name: kind for kind, name in FIELDS}
    for kind, name in found:
        if '.' in kind:
            return Cause(
                'dotted_type',
                f'{kind} is Python; in a .msg file a type of another package has a slash.',
                'Write builtin_interfaces/Time.',
            )
        if name in types and kind != types[name]:
            return Cause(
                'field_type',
                f'The field {name} has the type {kind[:40]}.',
                f'Its type is {types[name]}.',
            )
        if name not in types:
            return no_such_field(name, types)
    missing = [name for _, name in FIELDS if name not in {name for _, name in found}]
    return missing_or_disordered(missing)


def no_such_field(name: str, types: Mapping[str, str]) -> Cause:
    """
    Explain a field that nobody asked for.

    :param types: type of each field that is asked for, by name
    """
    near = close_name(name, types)
    return Cause(
        'field_name',
        f'There is no field {name[:40]!r} in the specification.',
        f'Did you mean {near}?' if near else 'Compare with the table.',
    )


def missing_or_disordered(missing: Sequence[str]) -> Cause:
    """
    Explain fields that are all right by themselves and not right together.

    :param missing: names of fields that are not there
    """
    if missing:
        verb = 'is' if len(missing) == 1 else 'are'
        return Cause(
            'field_missing',
            f'{", ".join(missing)} {verb} missing.',
            'Add one line for each field: the type first, then the name.',
        )
    return Cause('field_order', 'The order is different.', 'Order is part of a message type.')


def declares_its_dependencies(run: Run) -> None:
    """package.xml declares what generating and using the message needs."""
    try:
        root = ElementTree.fromstring(_text(run, MANIFEST))  # noqa: S314 - expat refuses bombs
    except ElementTree.ParseError as error:
        raise Failed(
            expected='a well-formed package.xml',
            observed=f'XML that cannot be read: {error}',
            why=Cause('xml', 'A tag is not closed, or is misspelled.', 'Look at that line.'),
        ) from None
    have = {(child.tag, (child.text or '').strip()) for child in root}
    missing = [wanted for wanted, ways in _declarations() if not any(way <= have for way in ways)]
    if root.findtext('name', '').strip() != 'temp_monitor_pkg':
        missing.insert(0, '<name>temp_monitor_pkg</name>')
    kind = root.findtext('export/build_type', '').strip()
    if kind != 'ament_cmake':
        missing.append('<export><build_type>ament_cmake</build_type></export>')
    if missing:
        total = len(_declarations()) + 2
        raise Failed(
            expected='the declarations of the lesson, all of them',
            observed='missing: ' + ', '.join(missing),
            share=round(0.5 * (1 - len(missing) / total), 2) if len(missing) < total // 2 else 0,
            why=Cause(
                'manifest',
                'Without the group or a generator, nothing is generated or nothing is found.',
                f'Add {missing[0]}.',
            ),
        )


def _declarations() -> list[tuple[str, list[set[tuple[str, str]]]]]:
    """Return each needed declaration with the sets of tags that declare it (REP 149)."""

    def ways(name: str, *alternatives: str) -> list[set[tuple[str, str]]]:
        return [{(tag, name) for tag in tags.split()} for tags in alternatives]

    generators, runtime = 'rosidl_default_generators', 'rosidl_default_runtime'
    return [
        (
            '<buildtool_depend>ament_cmake</buildtool_depend>',
            ways('ament_cmake', 'buildtool_depend'),
        ),
        (
            f'<buildtool_depend>{generators}</buildtool_depend>',
            ways(generators, 'buildtool_depend', 'build_depend', 'depend'),
        ),
        (
            '<depend>builtin_interfaces</depend>',
            ways('builtin_interfaces', 'depend', 'build_depend exec_depend'),
        ),
        (f'<exec_depend>{runtime}</exec_depend>', ways(runtime, 'exec_depend', 'depend')),
        (
            '<member_of_group>rosidl_interface_packages</member_of_group>',
            ways('rosidl_interface_packages', 'member_of_group'),
        ),
    ]


def commands_of(text: str) -> list[tuple[str, list[str]]]:
    """
    Read a CMake file as (command, arguments) pairs.

    :param text: command names are lower-cased, comments and quotes dropped, and variables of
        ``set``, ``list(APPEND)`` and ``project`` put in; bracket arguments and generator
        expressions are not understood, and lessons do not use them
    """
    bare = re.sub(r'#[^\n]*', '', text[:LONGEST_CMAKE])
    variables: dict[str, str] = {}
    found = []
    for match in re.finditer(r'(?<!\w)([A-Za-z_]\w{0,63})\s{0,99}\(([^()]*)\)', bare):
        name = match[1].lower()
        given = re.sub(r'\$\{(\w+)\}', lambda used: variables.get(used[1], used[0]), match[2])
        words = re.findall(r'[^\s";]+', given)
        if name == 'project' and words:
            variables['PROJECT_NAME'] = words[0]
        elif name == 'set' and words:
            variables[words[0]] = ' '.join(words[1:])
        elif name == 'list' and words[:1] == ['APPEND'] and len(words) > 1:
            variables[words[1]] = ' '.join([variables.get(words[1], ''), *words[2:]])
        found.append((name, words))
    return found


def generates_the_interface(run: Run) -> None:
    """CMakeLists.txt finds the generators and generates the message with its dependency."""
    if travelled(run):
        return  # however it is written, it does what it has to
    found = commands_of(_text(run, CMAKE))
    packages = {words[0] for name, words in found if name == 'find_package' and words}
    generated = [words for name, words in found if name == 'rosidl_generate_interfaces']
    words = generated[0] if generated else []
    wanted = (
        ('project(temp_monitor_pkg)', ('project', ['temp_monitor_pkg']) in _heads(found)),
        ('find_package(ament_cmake REQUIRED)', 'ament_cmake' in packages),
        (
            'find_package(rosidl_default_generators REQUIRED)',
            'rosidl_default_generators' in packages,
        ),
        (f'rosidl_generate_interfaces(${{PROJECT_NAME}} "{MSG}" ...)', MSG in words),
        ('DEPENDENCIES builtin_interfaces', 'builtin_interfaces' in _after_dependencies(words)),
        ('ament_package()', any(name == 'ament_package' for name, _ in found)),
    )
    missing = [text for text, there in wanted if not there]
    if missing:
        raise Failed(
            expected='the commands of the lesson, all of them',
            observed='missing: ' + ', '.join(missing),
            share=round(0.5 * (1 - len(missing) / len(wanted)), 2) if len(missing) < 3 else 0,
            why=Cause(
                'cmake',
                'CMake generates only what it is told to, from packages that it has found.',
                f'Add {missing[0]}.',
            ),
        )


def _heads(found: Sequence[tuple[str, list[str]]]) -> list[tuple[str, list[str]]]:
    return [(name, words[:1]) for name, words in found]


def _after_dependencies(words: list[str]) -> list[str]:
    return words[words.index('DEPENDENCIES') :] if 'DEPENDENCIES' in words else []


def travelled(run: Run) -> bool:
    """Tell whether all messages came back unchanged in the type that was built."""
    inputs = [event['data'] for event in run.recording.of('input')]
    echoed = [event.get('data') for event in run.recording.messages('/echo_out')]
    return bool(inputs == run.facts['sent'] and echoed == inputs)


def builds_and_travels(run: Run) -> None:
    """The package builds with colcon, and its message travels between two programs unchanged."""
    recording = run.recording
    if travelled(run):
        return
    echoed = recording.messages('/echo_out')
    expected = f'{len(run.facts["sent"])} messages sent and received back unchanged'
    if not recording.nodes:
        raise Failed(
            expected='a package that builds', observed='no built message', why=_why_no_build(run)
        )
    ends = recording.endpoints('subscription', '/echo_in')
    raise Failed(
        expected=expected,
        observed=f'the package builds, but {len(echoed)} messages come back',
        why=Cause(
            'different_type',
            f'Your type is a different one: {ends[0]["type"] if ends else "no Temperature"}.',
            'Name, field types and field order all belong to a message type.',
        ),
    )


ADVICE = (
    (
        "KeyError: 'builtin_interfaces'",
        'cmake',
        'Add DEPENDENCIES builtin_interfaces to rosidl_generate_interfaces(...).',
    ),
    ('is an invalid message name', 'dotted_type', 'Write builtin_interfaces/Time, with a slash.'),
    ('Could not find a package configuration file', 'find_package', 'Check find_package(...).'),
    ('rosidl_interface_packages', 'manifest', 'Add the <member_of_group> to package.xml.'),
    ('Unknown CMake command', 'cmake', 'Is its find_package(...) missing above?'),
    ('Error(s) in package', 'xml', 'Look at package.xml.'),
    ('InvalidResourceName', 'field_type', 'Look at the types in Temperature.msg.'),
    ('InvalidSpecification', 'field_name', 'Look at the field names in Temperature.msg.'),
    ('UnknownMessageType', 'field_type', 'Look at the types in Temperature.msg.'),
)


def _why_no_build(run: Run) -> Cause | None:
    text = ''.join(str(run.recording.process.get(name, '')) for name in ('stdout', 'stderr'))
    killed = str(run.recording.process.get('killed', ''))
    if killed:
        return Cause(
            killed, 'The build was ended: it used more than it may.', 'Build it yourself.'
        )
    if run.recording.process.get('exit') is None:
        return Cause('endless_build', 'The build does not come to an end.', 'Build it yourself.')
    for sign, cause_id, advice in ADVICE:
        if sign in text:
            return Cause(cause_id, f'colcon stops: {_line_with(text, sign)}', advice)
    return Cause(
        'build',
        f'colcon stops: {_line_with(text, "rror")}',
        'Run build_messages() in the notebook and read the first error.',
    )


def _line_with(text: str, sign: str) -> str:
    lines = [line.strip() for line in text.splitlines() if sign in line]
    return lines[0][:200] if lines else 'no error line was printed'


def _text(run: Run, name: str) -> str:
    return run.files.get(name, '')


def random_reading(draw: random.Random) -> dict[str, Any]:
    """Return a message with values nobody can know; binary fractions travel exactly."""
    return {
        'temperature_value': draw.randrange(-4000, 12500) / 64,
        'unit': ''.join(draw.choices('CFKcelsiu', k=7)),
        'timestamp': {'sec': draw.randrange(1, 2**31), 'nanosec': draw.randrange(10**9)},
        'sensor_id': f'sensor_{draw.randrange(10**6)}',
    }


def build(sent: Sequence[dict[str, Any]]) -> Exam:
    """
    Return the exam for some messages that have to travel.

    :param sent: fields of each message
    """
    exam = Exam(
        'temperature_message',
        title='The Temperature message and its package',
        assignment='07_temperature_monitor',
        part=1,
        cells=('temperature_msg', 'package_xml', 'cmakelists'),
        requires=(MSG, MANIFEST, CMAKE),
        scenario=Scenario(
            program='build',
            build_type=TYPE,
            watch={'/echo_out': TYPE},
            feed={'/echo_in': TYPE},
            steps=(Feed('/echo_in', tuple(sent)),),
            appear_s=50.0,
            first_log_s=0.0,
        ),
        read='Part 1: The message',
        facts={'sent': list(sent)},
    )
    exam.check(points=3, static=True)(defines_the_fields)
    exam.check(points=2, static=True)(declares_its_dependencies)
    exam.check(points=2, static=True)(generates_the_interface)
    exam.check(points=3, needs=['defines_the_fields'])(builds_and_travels)
    return exam


exam = build([random_reading(random.Random(number)) for number in (1, 2)])  # noqa: S311

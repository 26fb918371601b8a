"""
Lesson 04, part 1: the message of a weather station, and its package.

The hash of a type does not cover constants and defaults, and a build needs less of package.xml
than users of the package do.  So static checks read the .msg file and package.xml.  If the fields
are right, the grader builds the package and reads the hash of the built type from the graph.
"""

from collections.abc import Mapping, Sequence
import re
from typing import Any

from autograder.exam.exam import Cause, Exam, Failed, Run, Scenario
from autograder.exam.words import Causes
from autograder.judging.causes.ended import close_name
from autograder.judging.message_package import (
    require_declarations,
    require_fields,
    require_registered,
    why_no_build,
)

MSG, MANIFEST, CMAKE = 'msg/Station.msg', 'package.xml', 'CMakeLists.txt'
PACKAGE = 'station_interfaces'
TYPE = f'{PACKAGE}/msg/Station'
TYPE_HASH = 'RIHS01_a7dcc7281cddb471d19921562db327cb7292409acdde3aff436ea7690039ebb3'
"""Hash of the reference type, which covers names, types and order of the fields."""
FIELDS = (
    ('builtin_interfaces/Time', 'stamp'),
    ('float64', 'temperature'),
    ('string<=12', 'station_id'),
    ('float32[3]', 'wind'),
    ('uint8[<=8]', 'states'),
)
CONSTANTS = {'OK': 0, 'STALE': 1, 'BROKEN': 2}
DEFAULT = -40.0
WHY = Causes(__file__)
_CONSTANT = re.compile(r'(\S+)\s+(\w+)\s*=\s*(\S+)')


def constants_of(text: str) -> dict[str, tuple[str, str]]:
    """Return the constants of a message definition as name -> (type, value)."""
    found = {}
    for line in _lines(text):
        match = _CONSTANT.fullmatch(line)
        if match and not match[1].endswith('<'):
            found[match[2]] = (match[1], match[3])
    return found


def defines_the_fields(run: Run) -> None:
    """Station.msg has exactly the five fields, with these types and in this order."""
    require_fields(run.files.get(MSG, ''), FIELDS)


def names_the_states(run: Run) -> None:
    """It has the constants OK, STALE and BROKEN of type uint8 with the values 0, 1 and 2."""
    text = run.files.get(MSG, '')
    found = constants_of(text)
    right = {
        name
        for name, (kind, value) in found.items()
        if kind == 'uint8' and whole(value) == CONSTANTS.get(name)
    }
    wrong = [name for name in CONSTANTS if name not in right]
    others = [name for name in found if name not in CONSTANTS]
    named = [field for _, field in FIELDS]
    if wrong or others:
        raise Failed(
            expected='uint8 OK=0; uint8 STALE=1; uint8 BROKEN=2',
            observed='; '.join(f'{kind} {name}={value}' for name, (kind, value) in found.items())[
                :200
            ]
            or 'no constant',
            why=_why_constant(wrong[0], found, text)
            if wrong
            else WHY.of('field' if others[0] in named else 'constant_extra', name=others[0][:40]),
        )


def whole(text: str) -> int | None:
    """Return the integer in a string, such as 2, 02, 0x2 or 0b10; None if it is not an integer."""
    for base in (10, 0):
        try:
            return int(text, base)
        except ValueError:
            continue
    return None


def _why_constant(name: str, found: Mapping[str, tuple[str, str]], text: str) -> Cause:
    """Explain a constant that is wrong or missing."""
    kind, value = found.get(name, ('', ''))
    words: dict[str, Any] = {'name': name, 'right': f'uint8 {name}={CONSTANTS[name]}'}
    if kind and kind != 'uint8':
        return WHY.of('constant_type', kind=kind[:40], **words)
    if kind:
        more = '' if whole(value) is not None else ', which is not a whole number'
        return WHY.of('constant_value', value=f'{value[:20]}{more}', **words)
    other = next((one for one in found if one.upper() == name), '') or close_name(name, found)
    if other and other not in CONSTANTS:
        return WHY.of('constant_name', other=other[:40], **words)
    line = next((one for one in _lines(text) if re.search(rf'(?i)\b{name}\b', one)), '')
    return WHY.of('constant_line' if line else 'constant_missing', line_text=line[:60], **words)


def _lines(text: str) -> list[str]:
    """Return the lines of a message definition without their comments."""
    return [line.partition('#')[0].strip() for line in text.splitlines()]


def starts_at_the_lowest(run: Run) -> None:
    """A new message has the temperature -40.0, the only default in the file."""
    lines = _lines(run.files.get(MSG, ''))
    words = [line.split() for line in lines if '=' not in line.replace('<=', '')]
    defaults = {
        line[1]: ' '.join(line[2:]) for line in words if line[2:] and line[1].isidentifier()
    }
    if list(defaults) == ['temperature'] and number(defaults['temperature']) == DEFAULT:
        return
    raise Failed(
        expected='float64 temperature -40.0, and no other default',
        observed='; '.join(f'{name} {value}' for name, value in defaults.items())[:200]
        or 'no default',
        why=_why_default(defaults, lines),
    )


def number(text: str) -> float | None:
    """Return the number that a text consists of; None if it is not a number."""
    try:
        return float(text)
    except ValueError:
        return None


def _why_default(defaults: Mapping[str, str], lines: Sequence[str]) -> Cause:
    for line in lines:
        if re.search(r'\btemperature\b', line) and '=' in line:
            return WHY.of('default_with_equals', line_text=line[:60])
    others = [name for name in defaults if name != 'temperature']
    if others:
        return WHY.of('other_default', name=others[0][:40], value=defaults[others[0]][:40])
    if value := defaults.get('temperature', ''):
        more = '' if number(value) is not None else ', which is not a number'
        return WHY.of('default_value', value=f'{value[:40]}{more}')
    return WHY['no_default']


def declares_its_dependencies(run: Run) -> None:
    """package.xml declares everything that is needed to generate and use the message."""
    require_declarations(run.files.get(MANIFEST, ''), PACKAGE)


def builds_the_type(run: Run) -> None:
    """The package builds with colcon, and the built type is the required one."""
    ends = run.recording.endpoints('publisher', '/echo_out')
    if TYPE_HASH in {str(end.get('type_hash', '')) for end in ends if end['type'] == TYPE}:
        require_registered(run.files.get(CMAKE, ''))
        return
    if ends:
        raise Failed(
            expected=f'{TYPE} with the fields of the table',
            observed='a type of the same name with a different definition',
        )
    raise Failed(
        expected='a package that builds', observed='no built message', why=why_no_build(run)
    )


def build() -> Exam:
    """Return the exam, which has no inputs."""
    exam = Exam(
        'station_message',
        title='The type of a weather station',
        assignment='04_messages',
        part=1,
        cells=('station_msg', 'station_package_xml', 'station_cmakelists'),
        requires=(MSG, MANIFEST, CMAKE),
        scenario=Scenario(
            program='build',
            build_type=TYPE,
        ),
        read='Part 2: The package',
    )
    exam.check(points=3, static=True, read='Part 1: The text')(defines_the_fields)
    exam.check(points=1, static=True, read='Defaults and constants')(names_the_states)
    exam.check(points=1, static=True, read='Defaults and constants')(starts_at_the_lowest)
    exam.check(points=2, static=True)(declares_its_dependencies)
    exam.check(points=3, needs=['defines_the_fields'])(builds_the_type)
    return exam


exam = build()

"""
Lesson 07, part 1: the message, its package.xml and its CMakeLists.txt.

Three checks read the files.  The fourth builds the package with colcon in the sandbox; messages of
the built type then travel to the probe, which has the reference type, and back.
"""

from collections.abc import Sequence
import random
from typing import Any

from autograder.exam.exam import Exam, Failed, Feed, Run, Scenario
from autograder.exam.words import Causes
from autograder.judging.message_package import (
    commands_of,
    mistake_in_build,
    require_declarations,
    require_fields,
    require_registered,
    why_no_build,
)

FIELDS = (
    ('float64', 'temperature_value'),
    ('string', 'unit'),
    ('builtin_interfaces/Time', 'timestamp'),
    ('string', 'sensor_id'),
)
TYPE = 'temp_monitor_pkg/msg/Temperature'
NEEDED = ('builtin_interfaces', 'rosidl_default_generators')
MSG, MANIFEST, CMAKE = 'msg/Temperature.msg', 'package.xml', 'CMakeLists.txt'
WHY = Causes(__file__)


def defines_the_fields(run: Run) -> None:
    """Temperature.msg has exactly the four fields, with these types and in this order."""
    require_fields(run.files.get(MSG, ''), FIELDS)


def declares_its_dependencies(run: Run) -> None:
    """package.xml declares everything that is needed to generate and use the message."""
    require_declarations(run.files.get(MANIFEST, ''), 'temp_monitor_pkg')


def _require_required(found: Sequence[tuple[str, list[str]]]) -> None:
    """Fail if ``find_package`` looks for a needed package without ``REQUIRED``."""
    for name, words in found:
        if name == 'find_package' and words[:1] and words[0] in NEEDED and 'REQUIRED' not in words:
            raise WHY.failed('not_required', share=0.5, package=words[0], words=' '.join(words))


def generates_the_interface(run: Run) -> None:
    """CMakeLists.txt finds the generators and generates the message with its dependency."""
    require_registered(run.files.get(CMAKE, ''))
    found = commands_of(run.files.get(CMAKE, ''))
    if travelled(run):
        _require_required(found)
        return  # a working file may have any form
    packages = {words[0] for name, words in found if name == 'find_package' and words}
    words = next((words for name, words in found if name == 'rosidl_generate_interfaces'), [])
    projects = [words[:1] for name, words in found if name == 'project']
    listed = MSG in words and words[:1] in projects
    wanted = (
        ('project(temp_monitor_pkg)', ['temp_monitor_pkg'] in projects),
        ('find_package(ament_cmake REQUIRED)', 'ament_cmake' in packages),
        (
            'find_package(rosidl_default_generators REQUIRED)',
            'rosidl_default_generators' in packages,
        ),
        (f'rosidl_generate_interfaces(${{PROJECT_NAME}} "{MSG}" ...)', listed),
        ('DEPENDENCIES builtin_interfaces', 'builtin_interfaces' in _after('DEPENDENCIES', words)),
        ('ament_package()', any(name == 'ament_package' for name, _ in found)),
    )
    missing = [text for text, there in wanted if not there]
    if missing:
        mistake = mistake_in_build(run)
        here = mistake.cause_id and mistake.text.startswith(CMAKE)
        known = why_no_build(run) if here else None
        share = round(0.5 * (1 - len(missing) / len(wanted)), 2) if len(missing) < 3 else 0
        raise WHY.failed('cmake', known, share=share, first=missing[0], all=', '.join(missing))


def _after(word: str, words: list[str]) -> list[str]:
    return words[words.index(word) :] if word in words else []


def travelled(run: Run) -> bool:
    """Return whether all messages came back unchanged with the built type."""
    inputs = [event['data'] for event in run.recording.of('input')]
    echoed = [event.get('data') for event in run.recording.messages('/echo_out')]
    return bool(inputs == run.facts['sent'] and echoed == inputs)


def builds_and_travels(run: Run) -> None:
    """The package builds with colcon, and its message travels between two programs unchanged."""
    if travelled(run):
        return
    if not run.recording.nodes:
        raise Failed(
            expected='a package that builds', observed='no built message', why=why_no_build(run)
        )
    ends = run.recording.endpoints('subscription', '/echo_in')
    kind = ends[0]['type'] if ends else 'no Temperature'
    sent, back = run.facts['sent'], run.recording.messages('/echo_out')
    raise WHY.failed('different_type', type=kind, sent=len(sent), back=len(back))


def random_reading(draw: random.Random) -> dict[str, Any]:
    """Return a message with random values; binary fractions travel without rounding."""
    return {
        'temperature_value': draw.randrange(-4000, 12500) / 64,
        'unit': ''.join(draw.choices('CFKcelsiu', k=7)),
        'timestamp': {'sec': draw.randrange(1, 2**31), 'nanosec': draw.randrange(10**9)},
        'sensor_id': f'sensor_{draw.randrange(10**6)}',
    }


def build(sent: Sequence[dict[str, Any]]) -> Exam:
    """Return the exam for some messages that the probe sends."""
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
        ),
        read='Part 1: The message',
        facts={'sent': list(sent)},
    )
    exam.check(points=3, static=True, read='Exercise 1.1: the message file')(defines_the_fields)
    exam.check(points=2, static=True, read='Exercise 1.2: the manifest')(declares_its_dependencies)
    exam.check(points=2, static=True, read='Exercise 1.3: the build rules')(
        generates_the_interface
    )
    exam.check(points=3, needs=['defines_the_fields'], read='Build it')(builds_and_travels)
    return exam


exam = build([random_reading(random.Random(number)) for number in (1, 2)])  # noqa: S311

"""The files of a message package, and the causes of their failures."""

import re

from handmade_runs import failure
import pytest

from autograder.exam.exam import Run
from autograder.judging.message_package import require_declarations, require_fields, why_no_build
from autograder.recording import Recording
from exams.visible import station_message, temperature_message

WANTED = (('pkg_a/Time', 'stamp'), ('float64[<=4]', 'values'), ('string', 'unit'))
RIGHT = 'pkg_a/Time stamp\nfloat64[<=4] values\nstring unit\n'
MISTAKES = {
    'field_missing': ('string unit\n', ''),
    'field_twice': ('string unit\n', 'string unit\nstring unit\n'),
    'field_order': (RIGHT, 'float64[<=4] values\npkg_a/Time stamp\nstring unit\n'),
    'field_line': ('string unit', 'string unit = m'),
    'field_name': (' unit', ' units'),
    'field_type': ('float64[<=4]', 'float32[<=4]'),
    'unknown_type': ('string', 'str'),
    'bound': ('[<=4]', '[4]'),
    'bound_behind_name': ('float64[<=4] values', 'float64 values[<=4]'),
    'split_type': ('float64[<=4]', 'float64 [<=4]'),
    'punctuation': ('unit\n', 'unit;\n'),
    'name_first': ('string unit', 'unit: string'),
    'dotted_type': ('pkg_a/Time', 'pkg_a.msg.Time'),
    'msg_in_type': ('pkg_a/Time', 'pkg_a/msg/Time'),
    'type_without_package': ('pkg_a/Time', 'Time'),
    'constant_without_equals': ('string unit\n', 'string unit\nuint8 OK 0\n'),
}
MANIFEST = """<package format="3">
  <name>words</name>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <build_depend>rosidl_default_generators</build_depend>
  <build_depend>builtin_interfaces</build_depend>
  <exec_depend>builtin_interfaces</exec_depend>
  <depend>rosidl_default_runtime</depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
STATES = 'uint8 OK=0\nuint8 STALE=1\nuint8 BROKEN=2\n'
CONSTANTS = {
    'constant_missing': ('uint8 STALE=1\n', ''),
    'constant_name': ('BROKEN', 'broken'),
    'constant_type': ('uint8 OK', 'int32 OK'),
    'constant_value': ('OK=0', 'OK=1'),
    'constant_line': ('OK=0', 'OK: 0'),
    'constant_extra': ('uint8 OK=0', 'uint8 LOST=3\nuint8 OK=0'),
    'constant_for_default': ('uint8 OK=0', 'float64 temperature=-40.0\nuint8 OK=0'),
}
DEFAULTS = {
    'no_default': 'float64 temperature',
    'default_value': 'float64 temperature -4',
    'default_with_equals': 'float64 temperature = -40.0',
    'other_default': 'float64 temperature -40.0\nfloat32[3] wind [0, 0, 0]',
}


def station(text):
    """Return a run whose only file is Station.msg."""
    return Run({'msg/Station.msg': text}, Recording({}, ()))


class TestFields:
    @pytest.mark.parametrize(
        'text',
        [RIGHT, RIGHT.replace(' ', '\t'), f'# stamp unit\nuint8 A=1\n{RIGHT}uint8 B = 2 # x\n'],
    )
    def test_correct_fields_pass_in_any_layout(self, text):
        require_fields(text, WANTED)

    @pytest.mark.parametrize('cause', MISTAKES)
    def test_each_mistake_has_a_name(self, cause):
        failed = failure(require_fields, RIGHT.replace(*MISTAKES[cause]), WANTED)

        assert failed.why.cause_id == cause
        assert failed.share < 0.6

    def test_the_bound_is_explained(self):
        failed = failure(require_fields, RIGHT.replace('[<=4]', '[]'), WANTED)

        assert failed.why.try_this == '[<=4] is at most 4: float64[<=4] values'

    def test_further_wrong_lines_are_named_too(self):
        """Otherwise a learner would see the next mistake only after another build."""
        text = RIGHT.replace('string', 'str').replace('float64[<=4] values', 'float values')
        failed = failure(require_fields, text, WANTED)

        assert failed.why.text.endswith('Also fix: str unit')

    def test_many_lines_earn_nothing(self):
        assert failure(require_fields, RIGHT + 'bool b\n' * 9, WANTED).share == 0.0


class TestDeclarations:
    def test_other_tags_that_say_the_same_pass(self):
        require_declarations(MANIFEST, 'words')

    @pytest.mark.parametrize('line', MANIFEST.splitlines()[1:-1])
    def test_each_line_is_needed(self, line):
        failed = failure(require_declarations, MANIFEST.replace(line, ''), 'words')

        assert failed.why.cause_id == 'manifest'
        assert 0 < failed.share < 0.5

    def test_a_tag_that_says_something_else_is_named(self):
        text = MANIFEST.replace(
            'depend>rosidl_default_runtime</', 'test_depend>rosidl_default_runtime</test_'
        )

        assert '<test_depend>' in failure(require_declarations, text, 'words').why.text

    def test_what_is_no_xml_is_said_to_be_none(self):
        failed = failure(require_declarations, MANIFEST.replace('</name>', '<name>'), 'words')

        assert failed.why.cause_id == 'xml'
        assert 'line' in failed.observed


class TestStation:
    @pytest.mark.parametrize('cause', CONSTANTS)
    def test_each_mistake_in_a_constant_has_a_name(self, cause):
        text = STATES.replace(*CONSTANTS[cause])

        assert failure(station_message.names_the_states, station(text)).why.cause_id == cause

    @pytest.mark.parametrize('one', ['1', '01', '0x1', '0b1', '  1  # late'])
    def test_numbers_are_read_as_the_generators_read_them(self, one):
        station_message.names_the_states(station(STATES.replace('STALE=1', f'STALE = {one}')))

    @pytest.mark.parametrize('cause', DEFAULTS)
    def test_each_mistake_in_the_default_has_a_name(self, cause):
        run = station(DEFAULTS[cause])

        assert failure(station_message.starts_at_the_lowest, run).why.cause_id == cause


MISMATCH = "package name 'b' in '/x' does not match current PROJECT_NAME 'a'. You must"
NO_IMPORT = 'Traceback (most recent call last):\n  File "/grader/inside/echo_node.py", line 19\n'


class TestBuild:
    @pytest.mark.parametrize(
        ('process', 'cause_id', 'words'),
        [
            ({'killed': 'cpu_limit', 'stderr': 'CMake Error: half a word'}, 'cpu_limit', '30 s'),
            # Virtual time stands still during a build, so a limit ends a build that waits.
            (
                {'exit': None, 'killed': 'waits_outside'},
                'waits_outside',
                'too long for something outside',
            ),
            ({'stderr': MISMATCH}, 'name_mismatch', r'^CMakeLists\.txt, line 1: '),
            # The package builds, but programs cannot import its message.
            ({'stderr': f'{NO_IMPORT}ModuleNotFoundError: x'}, 'no_messages', ''),
            ({'stderr': 'foo.c:1:2: error: no such thing\n'}, 'build', 'no such thing'),
        ],
    )
    def test_failed_build_has_its_cause(self, process, cause_id, words):
        facts = {'exit': 1, 'killed': '', 'stdout': '', 'stderr': '', **process}
        event = {'event': 'process', **facts}

        cause = why_no_build(Run({'CMakeLists.txt': 'project(a)\n'}, Recording({}, (event,))))

        assert cause.cause_id == cause_id
        assert re.search(words, cause.text)

    @pytest.mark.parametrize(
        ('target', 'missing'), [('words', False), ('${PROJECT_NAME}', False), ('word', True)]
    )
    def test_messages_are_generated_for_the_project(self, target, missing):
        """Programs that use a message look for libraries that are named after the package."""
        commands = f'project(words)\nrosidl_generate_interfaces({target} "msg/Temperature.msg")\n'
        run = Run(
            {'CMakeLists.txt': f'{commands}ament_package()\n'}, Recording({}, ()), {'sent': [1]}
        )

        failed = failure(temperature_message.generates_the_interface, run)

        assert ('"msg/Temperature.msg"' in failed.observed) is missing

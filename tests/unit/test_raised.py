"""Exceptions of beginners are told in their words, with the place and the repair."""

from __future__ import annotations

import pytest

from autograder.judging import raised
from autograder.judging.exam import Run
from autograder.runs.recording import Recording

CODE = """import rclpy

class Talker(Node):
    def __init__(self):
        self.create_timer(1.0, self.speak())

rclpy.spin(node)
"""


def trace(error, line=5, code=CODE):
    """Return what is read off a program that died of an error in a line of CODE."""
    stderr = (
        'Traceback (most recent call last):\n'
        '  File "/grader/inside/run_node.py", line 40, in main\n    runpy\n'
        f'  File "/submission/talker.py", line {line}, in speak\n    x\n{error}\n'
    )
    process = {'event': 'process', 'exit': 1, 'killed': '', 'stdout': '', 'stderr': stderr}
    return raised.traceback_of(Run({'talker.py': code}, Recording({}, (process,))))


def cause(error, line=5):
    """Return how an error is explained."""
    return raised.exception_cause(trace(error, line))


@pytest.mark.parametrize(
    ('error', 'cause_id', 'words'),
    [
        (
            'rclpy.exceptions.InvalidNodeNameException: Invalid node name: node name must not '
            'contain characters other than alphanumerics or',
            'invalid_name',
            'line 6',
        ),
        (
            'rclpy.exceptions.InvalidTopicNameException: Invalid topic name: topic name must not '
            'contain characters other than',
            'invalid_topic',
            'line 6',
        ),
        (
            "rclpy.exceptions.NotInitializedException: ('rclpy.init() has not been called', "
            "'cannot create node')",
            'no_init',
            'before ROS is ready',
        ),
        ('RuntimeError: Context.init() must only be called once', 'init_twice', 'second time'),
        (
            'rclpy._rclpy_pybind11.InvalidHandle: cannot use Destroyable because destruction was '
            'requested',
            'destroyed_early',
            'after it was destroyed',
        ),
        ('ValueError: generator already executing', 'nested_spin', 'A callback spins'),
        ('RuntimeError: Executor is already spinning', 'nested_spin', 'A callback spins'),
        (
            "rclpy.exceptions.ParameterNotDeclaredException: ('Invalid access to undeclared "
            "parameter(s)', ['Limit'])",
            'not_declared',
            'has not declared',
        ),
        (
            "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class 'str'>",
            'not_a_message',
            'no message',
        ),
        (
            'TypeError: RcutilsLogger.info() takes 2 positional arguments but 3 were given',
            'log_arguments',
            'one text',
        ),
        (
            'ValueError: Logger severity cannot be changed between calls.',
            'one_level_a_place',
            'two levels',
        ),
        (
            "AttributeError: 'Talker' object has no attribute '_default_callback_group'",
            'no_super_init',
            'parent class',
        ),
        (
            "TypeError: Node.__init__() missing 1 required positional argument: 'node_name'",
            'no_super_init',
            'parent class',
        ),
        (
            "AttributeError: property 'publishers' of 'Talker' object has no setter",
            'reserved_name',
            'Every node already has',
        ),
        (
            "AttributeError: type object 'module' has no attribute '_TYPE_SUPPORT'",
            'not_a_type',
            'no message class',
        ),
        (
            'rclpy.qos.InvalidQoSProfileException: Invalid QoSProfile: History and/or depth '
            'settings are required.',
            'no_depth',
            'without a depth',
        ),
        (
            "TypeError: cannot pickle 'rclpy._rclpy_pybind11.rmw_qos_profile_t' object",
            'deep_copy',
            'deepcopy()',
        ),
        (
            "AssertionError: The 'temperature_value' field must be of type 'float'",
            'field_value',
            "must be of type 'float'",
        ),
        (
            'AssertionError: Invalid arguments passed to constructor: temp, unit',
            'no_field',
            'that it does not have',
        ),
        (
            "AttributeError: 'Temperature' object has no attribute 'temperatur_value'. Did you "
            "mean: 'temperature_value'?",
            'no_field',
            'A Temperature has no field temperatur_value',
        ),
        (
            "AttributeError: 'Talker' object has no attribute 'publsher'. Did you mean: "
            "'publisher'?",
            'no_attribute',
            "Did you mean: 'publisher'",
        ),
        (
            "AttributeError: 'LifecycleNode' object has no attribute 'register_on_configure'",
            'no_attribute',
            'register_on_configure',
        ),
        ("NameError: name 'Node' is not defined", 'missing_import', 'never imported'),
        ("NameError: name 'self' is not defined", 'unknown_name', 'never made'),
        ("NameError: name 'messsage' is not defined", 'unknown_name', 'never made'),
        ("ModuleNotFoundError: No module named 'rclpi'", 'import', 'rclpi'),
        (
            "ModuleNotFoundError: No module named 'station_interfaces'",
            'message_not_built',
            'no message package',
        ),
        (
            "ModuleNotFoundError: No module named 'sensor_msgs'",
            'message_not_built',
            'no message package',
        ),
        (
            "ImportError: cannot import name 'QosProfile' from 'rclpy.qos' (/usr/lib/qos.py)",
            'import',
            'QosProfile',
        ),
        ('IndentationError: unexpected indent', 'indentation', 'spaces at the beginning'),
        ("SyntaxError: expected ':'", 'syntax', 'cannot read the file'),
        ('AssertionError', 'assertion', 'says no more'),
        ('ZeroDivisionError: float division by zero', 'exception', 'ZeroDivisionError'),
    ],
    ids=lambda value: value if isinstance(value, str) and ' ' not in value else '',
)
def test_errors_of_beginners_have_a_name_of_their_own(error, cause_id, words):
    """The texts are those that Python and rclpy print."""
    found = cause(error)

    assert found.cause_id == cause_id
    assert words in found.text
    assert found.try_this


def test_the_import_that_is_missing_is_written_out():
    """The repair is the line to write."""
    assert cause("NameError: name 'Node' is not defined").try_this.endswith(
        'from rclpy.node import Node'
    )
    assert cause("NameError: name 'math' is not defined").try_this.endswith('import math')


def test_a_method_that_is_called_is_told_from_one_with_the_wrong_arguments():
    """Where the line itself calls it, the brackets are one pair too many."""
    called = cause("TypeError: Talker.speak() missing 1 required positional argument: 'event'")
    handed = cause('TypeError: Talker.hear() takes 1 positional argument but 2 were given', 7)

    assert called.cause_id == 'called_not_passed'
    assert 'self.speak' in called.try_this
    assert handed.cause_id == 'callback_arguments'
    assert 'hear() gets another number' in handed.text


def test_a_message_made_with_a_wrong_field_is_named_if_the_line_shows_it():
    """So that the line to type is a whole one."""
    error = 'AssertionError: Invalid arguments passed to constructor: temp'
    code = CODE.replace('self.create_timer(1.0, self.speak())', 'text = String(temp=1)')

    told = raised.exception_cause(trace(error, code=code))
    unknown = cause(error)

    assert told.text.startswith('A String is made with a field that it does not have')
    assert told.try_this == 'ros2 interface show std_msgs/msg/String lists the fields.'
    assert "with the type's name" in unknown.try_this


def test_what_is_found_out_while_spinning_names_no_line():
    """The line that spins is innocent."""
    handed = cause('TypeError: Talker.hear() takes 1 positional argument but 2 were given', 7)

    assert 'line' not in handed.text.replace('def line', '')


def test_paths_of_the_machine_are_cut():
    """An import error shows where a module lies."""
    error = "ImportError: cannot import name 'QosProfile' from 'rclpy.qos' (/usr/lib/qos.py)"

    assert '/usr' not in cause(error).text

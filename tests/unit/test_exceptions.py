"""Explain beginners' exceptions with the line and a fix."""

from pathlib import Path
import re

import pytest

from autograder.exam.exam import Run
from autograder.judging.causes import exceptions as raised
from autograder.judging.causes.tracebacks import traceback_of
from autograder.recording import Recording

CODE = """import rclpy

class Talker(Node):
    def __init__(self):
        self.create_timer(1.0, self.speak())

rclpy.spin(node)
"""


SPUN = """  File "/venv/site-packages/rclpy/executors.py", line 111, in await_or_execute
    return callback(*args)
"""


def trace(error, line=5, code=CODE, below=''):
    """Return the traceback of a program that an exception ended at the given line."""
    stderr = (
        'Traceback (most recent call last):\n'
        '  File "/grader/inside/run_node.py", line 40, in main\n    runpy\n'
        f'  File "/submission/talker.py", line {line}, in speak\n    x\n{below}{error}\n'
    )
    process = {'event': 'process', 'exit': 1, 'killed': '', 'stdout': '', 'stderr': stderr}
    return traceback_of(Run({'talker.py': code}, Recording({}, (process,))))


def cause(error, line=5, below=''):
    return raised.exception_cause(trace(error, line, below=below))


def at(code, error, below=''):
    """Return the explanation of an error in the last line of some code."""
    return raised.exception_cause(trace(error, len(code.splitlines()), code, below))


def cases(section):
    """
    Yield the cases of a section of ``exceptions.txt``: code, exception, cause, words.

    The first line of a case is the cause with words of its explanation. Below it are the line of
    code, except in the first section, and the exception.
    """
    text = Path(__file__).with_name('exceptions.txt').read_text(encoding='utf-8').strip()
    for case in re.split(r'\n(?! )', text.partition(f'# {section}\n')[2].partition('\n\n')[0]):
        head, *lines = case.split('\n    ')
        cause_id, _, words = head.partition(': ')
        yield pytest.param(*lines, cause_id, words, id=f'{cause_id}, {words}')


@pytest.mark.parametrize(('error', 'cause_id', 'words'), list(cases('without a line')))
def test_errors_of_beginners_have_a_name_of_their_own(error, cause_id, words):
    found = cause(error)

    assert found.cause_id == cause_id
    assert words in found.text
    assert found.try_this


def test_a_called_method_is_distinguished_from_wrong_arguments():
    """A method that should be passed was called: the line has a pair of brackets too many."""
    error = "TypeError: Talker.speak() missing 1 required positional argument: 'event'"
    called = at(
        'class Talker(Node):\n    def speak(self, event):\n        pass\n'
        '        self.create_timer(1.0, self.speak())',
        error,
    )
    handed = cause(
        'TypeError: Talker.hear() takes 1 positional argument but 2 were given', 7, SPUN
    )

    assert called.cause_id == 'called_not_passed'
    assert 'self.speak' in called.try_this
    assert handed.cause_id == 'callback_arguments'
    assert 'hear() gets the wrong number' in handed.text
    assert 'Line' not in handed.text  # the line that spins did not cause the error


def test_a_message_made_with_a_wrong_field_is_named_if_the_line_shows_it():
    error = 'AssertionError: Invalid arguments passed to constructor: temp'
    code = CODE.replace('self.create_timer(1.0, self.speak())', 'text = String(temp=1)')

    found = raised.exception_cause(trace(error, code=code))
    unknown = cause(error)

    assert 'sets a field that String does not have' in found.text
    assert found.try_this == 'ros2 interface show std_msgs/msg/String lists the fields.'
    assert "with the type's name" in unknown.try_this


SPEAKER = """from std_msgs.msg import Float64, Header, String
class Speaker(Node):
    def __init__(self, place):
        self.create_subscription(Float64, 'readings', self.take, 10)
    def take(self, reading):
"""


@pytest.mark.parametrize(('line', 'error', 'cause_id', 'words'), list(cases('arguments')))
def test_wrong_arguments_are_explained_by_what_is_called(line, error, cause_id, words):
    """Wrong arguments to an rclpy function are not blamed on the learner's def lines."""
    found = at(f'{SPEAKER}{line}', error)

    assert found.cause_id == cause_id
    assert found.line == 6
    assert words in f'{found.text} {found.try_this}'


def test_callbacks_with_wrong_arguments_are_known_by_the_executor_below():
    """A lambda, and an error from rclpy's own check of the callback, are recognised too."""
    lambdas = at(
        'rclpy.spin(node)',
        'TypeError: Talker.__init__.<locals>.<lambda>() takes 0 positional arguments but 1 was '
        'given',
        SPUN,
    )
    none = 'RuntimeError: Subscription.__init__(): callback should be either be callable with one'
    called = at("self.create_subscription(String, 'chatter', self.take(), 10)", none)
    without = at("self.create_subscription(String, 'chatter', self.take, 10)", none)

    assert lambdas.cause_id == without.cause_id == 'callback_arguments'
    assert lambdas.text.startswith('A callback gets')
    assert called.cause_id == 'called_not_passed'
    assert called.try_this.endswith('self.take.')


@pytest.mark.parametrize(
    ('line', 'wanted', 'words'),
    [
        ('m.stamp = self.get_clock().now()', "a sub message of type 'Time'", 'Add .to_msg()'),
        ('m.pose = 1', "a sub message of type 'Pose'", 'Assign a whole Pose'),
        ('m.stamp.sec = time.time()', "of type 'int'", 'now().to_msg()'),
        ('m.data = 3.0', "of type 'int'", 'int(value)'),
        ('m.data = self.count', "of type 'str'", 'str(value), or the field of a message'),
        ('m.data = 25', "of type 'float'", '25.0 instead of 25'),
        ('m.data = 1', "of type 'bool'", 'True or False'),
        ('m.data = 300', 'an unsigned integer in [0, 255]', 'within the limits'),
        (
            "m.data = 'abc'",
            "a set or sequence and each value of type 'float' and each double in [-17976931348623",
            'a list of such values',
        ),
        ('m.data = reading', "of type 'float'", 'use reading.data.'),
        ('out = Float64(data=reading)', "of type 'float'", 'use reading.data.'),
    ],
)
def test_repair_of_a_field_goes_by_the_type_that_is_wanted(line, wanted, words):
    name = 'sec' if '.sec' in line else 'stamp' if '.stamp' in line else 'data'
    name = 'pose' if '.pose' in line else name

    found = at(f'{SPEAKER}{line}', f"AssertionError: The '{name}' field must be {wanted}")

    assert found.cause_id == ('stamp_value' if 'to_msg' in words else 'field_value')
    assert words in found.try_this
    assert '17976' not in found.text


@pytest.mark.parametrize(
    'error',
    [
        "unsupported operand type(s) for +=: 'float' and 'Float64'",
        'must be real number, not Float64',
        "'>' not supported between instances of 'Float64' and 'float'",
        "'<' not supported between instances of 'float' and 'Float64'",
        "float() argument must be a string or a real number, not 'Float64'",
        "type Float64 doesn't define __round__ method",
        'unsupported format string passed to Float64.__format__',
    ],
)
def test_whole_message_in_place_of_its_value_is_reported(error):
    """The callback names the message, and the type of the message names the field."""
    used = at(f'{SPEAKER}        self.total += reading', f'TypeError: {error}')
    elsewhere = at(f'{SPEAKER}        compare(it)', f'TypeError: {error}')

    assert used.cause_id == 'whole_message'
    assert used.try_this == 'Use the field: reading.data.'
    assert elsewhere.try_this == 'Use the field: message.data.'


def test_whole_message_of_several_fields_or_of_text_is_reported():
    """If a message has several fields, or is used as a string, no field is chosen."""
    several = at(
        f'{SPEAKER}Header() > 1', "TypeError: '>' not supported between 'Header' and 'int'"
    )
    text = at(
        f'{SPEAKER}String().split()', "AttributeError: 'String' object has no attribute 'split'"
    )

    assert 'ros2 interface show std_msgs/msg/Header' in several.try_this
    assert text.cause_id == 'whole_message'


@pytest.mark.parametrize(('line', 'error', 'cause_id', 'words'), list(cases('evidence')))
def test_evidence_in_the_error_and_its_line_is_used(line, error, cause_id, words):
    found = at(f'{SPEAKER}{line}', error)

    assert found.cause_id == cause_id
    assert words in found.try_this


@pytest.mark.parametrize(
    ('line', 'error', 'words'),
    [
        (
            'rclpy.spin(Talker)',
            "TypeError: 'property' object is not iterable",
            'Talker(), not the',
        ),
        (
            'rclpy.spin(None)',
            "AttributeError: 'NoneType' object has no attribute 'executor'",
            'Node',
        ),
        ('rclpy.spin(A())', "AttributeError: 'A' object has no attribute 'subscriptions'", 'Node'),
    ],
)
def test_line_that_spins_something_else_than_a_node_is_named(line, error, words):
    """The learner must fix the line that spins, although the executor raises the exception."""
    found = at(line, error, SPUN)

    assert found.cause_id in ('class_for_object', 'spins_no_node')
    assert found.line == 1
    assert words in found.try_this


def test_what_nobody_can_explain_is_reported_with_its_line():
    """Feedback has no traceback, so it quotes the line of an unknown exception."""
    error = 'ZeroDivisionError: float division by zero'
    looked_at = at('self.mean = self.total / 0.0', error)
    own = at("raise Exception('unknown unit')", 'Exception: unknown unit')
    spun = at('rclpy.spin(node)', error, SPUN)

    assert looked_at.try_this == 'Look at that line: self.mean = self.total / 0.0'
    assert own.cause_id == 'exception'
    assert (own.line, own.text) == (1, 'An exception was raised: Exception: unknown unit')
    assert "raise Exception('unknown unit')" in own.try_this
    assert 'Start the node in a cell' in spun.try_this


def test_raise_that_passes_an_exception_on_is_reported():
    """A program that re-raises its exception does not lack an except clause."""
    code = 'try:\n    f()\nexcept UnknownUnit:\n    raise  # again\nraise UnknownUnit(unit)'

    found = at(code, 'UnknownUnit: K')

    assert found.cause_id == 'exception'
    assert 'catches the exception and raises it again' in found.try_this


def test_paths_of_the_machine_are_cut():
    error = "ImportError: cannot import name 'QosProfile' from 'rclpy.qos' (/usr/lib/qos.py)"

    assert '/usr' not in cause(error).text

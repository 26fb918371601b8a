"""Explain beginners' exceptions with the line and a fix."""

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
    """Return the explanation of an error."""
    return raised.exception_cause(trace(error, line, below=below))


def at(code, error, below=''):
    """Return the explanation of an error in the last line of some code."""
    return raised.exception_cause(trace(error, len(code.splitlines()), code, below))


@pytest.mark.parametrize(
    ('error', 'cause_id', 'words'),
    [
        (
            'rclpy.exceptions.InvalidNodeNameException: Invalid node name: node name must not '
            'contain characters other than alphanumerics or',
            'invalid_name',
            'not allowed',
        ),
        (
            'rclpy.exceptions.InvalidTopicNameException: Invalid topic name: topic name must not '
            'contain characters other than',
            'invalid_topic',
            'not allowed',
        ),
        (
            "rclpy.exceptions.NotInitializedException: ('rclpy.init() has not been called', "
            "'cannot create node')",
            'no_init',
            'before rclpy.init()',
        ),
        ('RuntimeError: Context.init() must only be called once', 'init_twice', 'second time'),
        (
            'rclpy._rclpy_pybind11.InvalidHandle: cannot use Destroyable because destruction was '
            'requested',
            'destroyed_early',
            'already destroyed',
        ),
        ('RuntimeError: coroutine raised StopIteration', 'used_up', 'end of its iterator'),
        (
            'OverflowError: cannot convert float infinity to integer',
            'infinite',
            'cannot be infinite',
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
            'not a message',
        ),
        (
            'TypeError: RcutilsLogger.info() takes 2 positional arguments but 3 were given',
            'log_arguments',
            'one string',
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
            'without a name',
        ),
        (
            "AttributeError: property 'publishers' of 'Talker' object has no setter",
            'reserved_name',
            'every node already has',
        ),
        (
            "AttributeError: type object 'module' has no attribute '_TYPE_SUPPORT'",
            'not_a_type',
            'not a message class',
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
            'that the message does not have',
        ),
        (
            "AttributeError: 'Temperature' object has no attribute 'temperatur_value'. Did you "
            "mean: 'temperature_value'?",
            'no_field',
            'The type Temperature has no field temperatur_value',
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
        ('IndentationError: unexpected indent', 'indentation', 'spaces at the beginning'),
        ("SyntaxError: expected ':'", 'syntax', 'cannot read the file'),
        ('AssertionError', 'assertion', 'without a message'),
        ('ZeroDivisionError: float division by zero', 'exception', 'ZeroDivisionError'),
    ],
    ids=lambda value: value if isinstance(value, str) and ' ' not in value else '',
)
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


def test_a_message_made_with_a_wrong_field_is_named_if_the_line_shows_it():
    error = 'AssertionError: Invalid arguments passed to constructor: temp'
    code = CODE.replace('self.create_timer(1.0, self.speak())', 'text = String(temp=1)')

    found = raised.exception_cause(trace(error, code=code))
    unknown = cause(error)

    assert 'sets a field that String does not have' in found.text
    assert found.try_this == 'ros2 interface show std_msgs/msg/String lists the fields.'
    assert "with the type's name" in unknown.try_this


def test_what_is_found_out_while_spinning_names_no_line():
    """The line that spins is not named, because it did not cause the error."""
    handed = cause(
        'TypeError: Talker.hear() takes 1 positional argument but 2 were given', 7, SPUN
    )

    assert 'Line' not in handed.text


SPEAKER = """from std_msgs.msg import Float64, Header, String
class Speaker(Node):
    def __init__(self, place):
        self.create_subscription(Float64, 'readings', self.take, 10)
    def take(self, reading):
"""


@pytest.mark.parametrize(
    ('line', 'error', 'cause_id', 'words'),
    [
        (
            'rclpy.spin()',
            "TypeError: spin() missing 1 required positional argument: 'node'",
            'spins_no_node',
            'rclpy.spin(node)',
        ),
        (
            'self.publisher.publish()',
            "TypeError: Publisher.publish() missing 1 required positional argument: 'msg'",
            'arguments',
            "missing 1 required positional argument: 'msg'",
        ),
        (
            'self.create_timer(1.0)',
            "TypeError: Node.create_timer() missing 1 required positional argument: 'callback'",
            'arguments',
            'create_timer(1.0, self.callback)',
        ),
        (
            'node = rclpy.create_node()',
            "TypeError: create_node() missing 1 required positional argument: 'node_name'",
            'arguments',
            "create_node('name')",
        ),
        (
            "String(f'hello {n}')",
            'TypeError: String.__init__() takes 1 positional argument but 2 were given',
            'by_name',
            'String(data=...)',
        ),
        (
            "Header('here')",
            'TypeError: Header.__init__() takes 1 positional argument but 2 were given',
            'by_name',
            'ros2 interface show std_msgs/msg/Header',
        ),
        (
            'QoSProfile(10)',
            'TypeError: QoSProfile.__init__() takes 1 positional argument but 2 were given',
            'by_name',
            'QoSProfile(depth=10)',
        ),
        (
            'Duration(0.3)',
            'TypeError: Duration.__init__() takes 1 positional argument but 2 were given',
            'by_name',
            'Duration(seconds=0.3)',
        ),
        (
            'Duration(sec=1)',
            "TypeError: Duration.__init__() got an unexpected keyword argument 'sec'",
            'by_name',
            "keyword argument 'sec'",
        ),
        (
            'Speaker()',
            "TypeError: Speaker.__init__() missing 1 required positional argument: 'place'",
            'arguments',
            'def __init__(...)',
        ),
        (
            'self.take()',
            "TypeError: Speaker.take() missing 1 required positional argument: 'reading'",
            'arguments',
            'def take(...)',
        ),
        (
            "self.create_publisher(String, 'chatter', qos=10)",
            "TypeError: Node.create_publisher() got an unexpected keyword argument 'qos'",
            'arguments',
            "create_publisher($type, '$topic', 10)",
        ),
        (
            "self.create_publisher(String, 'chatter', queue_size=10)",
            "TypeError: Node.create_publisher() got an unexpected keyword argument 'queue_size'",
            'queue_size',
            'the third argument',
        ),
    ],
)
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


@pytest.mark.parametrize(
    ('line', 'error', 'cause_id', 'words'),
    [
        (
            'if value < LOWEST_C:',
            "TypeError: '<' not supported between instances of 'str' and 'float'",
            'compares_types',
            'check the name of each',
        ),
        (
            "self.get_logger.info('x')",
            "AttributeError: 'function' object has no attribute 'info'",
            'not_called',
            'Add the parentheses: get_logger().info',
        ),
        (
            'self.publisher.publish(msg)',
            "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class "
            "'std_msgs.msg._string.Metaclass_String'>",
            'not_a_message',
            'Create one with String()',
        ),
        (
            'm.timestamp.sec = 3',
            "AttributeError: 'property' object has no attribute 'sec'",
            'class_for_object',
            'Create the object with parentheses',
        ),
        (
            'self.get_logger().info(3)',
            'TypeError: rclpy_logging_rcutils_log(): incompatible function arguments. The '
            'following argument types are supported:',
            'log_arguments',
            'into one f-string',
        ),
        (
            "self.create_subscription(String, 'chatter', 10, self.take)",
            "TypeError: Expected QoSProfile or int, but received <class 'method'>",
            'no_depth',
            'Pass the arguments in this order',
        ),
        (
            'self.create_timer(self.take, 1.0)',
            "TypeError: float() argument must be a string or a real number, not 'method'",
            'argument_order',
            'the period in seconds first',
        ),
        (
            "self.create_publisher('chatter', String, 10)",
            'TypeError: rclpy_resolve_name(): incompatible function arguments. The following '
            'argument types are supported:',
            'argument_order',
            'the type first',
        ),
        (
            'count += 1',
            "UnboundLocalError: cannot access local variable 'count' where it is not associated "
            'with a value',
            'local_name',
            'self.count',
        ),
        (
            'count += 1',
            "UnboundLocalError: local variable 'count' referenced before assignment",
            'local_name',
            'self.count',
        ),
    ],
)
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

"""Test claims about messages with the real parser, generators and classes."""

from array import array
import keyword
import subprocess
import sys

from builtin_interfaces.msg import Time
import numpy
import pytest
from rcl_interfaces.msg import Log
from rclpy.serialization import deserialize_message, serialize_message
from rosidl_adapter.parser import (
    InvalidFieldDefinition,
    InvalidResourceName,
    InvalidSpecification,
    InvalidValue,
    parse_message_string,
    Type,
    UnknownMessageType,
)
from std_msgs.msg import Float64, Int32, String

from temp_monitor_pkg.msg import Num, Temperature

claim = pytest.mark.claim
pytestmark = pytest.mark.ros
# The parser raises its own exceptions for most rules, and built-in ones for the rest.
REFUSALS = (
    NameError,
    NotImplementedError,
    TypeError,
    ValueError,
    InvalidFieldDefinition,
    InvalidResourceName,
    InvalidSpecification,
    InvalidValue,
    UnknownMessageType,
)


def parse(text):
    return parse_message_string('lab', 'Sample', text)


def through_the_wire(message):
    return deserialize_message(serialize_message(message), type(message))


@claim('M8', 'C3')
def test_types_of_other_packages_are_written_with_one_slash():
    """Dots and three parts are refused; a bare name means the same package."""
    assert Type('builtin_interfaces/Time').pkg_name == 'builtin_interfaces'
    assert Type('Time', context_package_name='lab').pkg_name == 'lab'
    for wrong in ('builtin_interfaces.msg.Time', 'builtin_interfaces/msg/Time'):
        with pytest.raises(REFUSALS):
            Type(wrong, context_package_name='lab')


@claim('M9')
@pytest.mark.parametrize('name', ['float', 'double', 'int', 'str', 'boolean'])
def test_names_without_a_size_are_refused(name):
    """The parser reads them as messages of the same package, which need a capital letter."""
    with pytest.raises(REFUSALS):
        parse(f'{name} value')


@claim('M9')
@pytest.mark.parametrize('name', ['float32', 'float64', 'int8', 'uint64', 'bool', 'byte', 'char'])
def test_names_with_a_size_are_primitive(name):
    assert parse(f'{name} value').fields[0].type.is_primitive_type()
    assert parse('string a\nwstring b').fields[1].type.is_primitive_type()


@claim('M10')
def test_names_follow_their_rules():
    """Fields are in lower_snake, constants in UPPER and messages in CamelCase."""
    for wrong in ('int32 Value', 'int32 a__b', 'int32 a_', 'int32 1st', 'int32 lower=1'):
        with pytest.raises(REFUSALS):
            parse(wrong)
    with pytest.raises(REFUSALS):
        Type('lab/sample_two')
    assert parse('int32 UPPER=1').constants[0].name == 'UPPER'


@claim('M11')
def test_field_occurs_once_and_keywords_pass():
    """The parser does not check for Python keywords."""
    with pytest.raises(REFUSALS):
        parse('int32 a\nint32 a')
    assert keyword.iskeyword('class')
    assert parse('float64 class').fields[0].name == 'class'
    with pytest.raises(SyntaxError):
        compile('message.class = 1.0', 'cell', 'exec')


@claim('M12')
def test_primitive_fields_have_defaults_and_nested_ones_do_not():
    """A constant has an equals sign, a default a space."""
    parsed = parse('string unit "Celsius"\nfloat64 t 20.0\nint32 LIMIT=30')

    assert [field.default_value for field in parsed.fields] == ['Celsius', 20.0]
    assert parsed.constants[0].value == 30
    with pytest.raises(REFUSALS):
        parse('builtin_interfaces/Time t 5')


@claim('M13')
def test_arrays_and_strings_have_bounds():
    """Arrays are unbounded, fixed or bounded; strings may be bounded."""
    types = [f.type for f in parse('int32[] a\nint32[3] b\nint32[<=5] c\nstring<=10 d').fields]

    assert [t.is_array for t in types] == [True, True, True, False]
    assert [(t.array_size, t.is_upper_bound) for t in types[:3]] == [
        (None, False),
        (3, False),
        (5, True),
    ]
    assert types[3].string_upper_bound == 10


@claim('M14')
def test_comments_are_kept_with_their_field():
    (field,) = parse('float64 value  # in degrees Celsius').fields

    assert 'in degrees Celsius' in field.annotations['comment']


@claim('M15', 'C31')
def test_whole_number_in_a_float_field_is_garbage_without_checks():
    """With checks, the number is refused; without them, it changes or ends the process."""
    with pytest.raises(AssertionError):
        Float64(check_fields=True).data = 25
    text = """
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Float64
unchecked = Float64(check_fields=False)
unchecked.data = 25
print(deserialize_message(serialize_message(unchecked), Float64).data)
"""
    run = subprocess.run([sys.executable, '-c', text], capture_output=True, text=True, check=False)

    if run.returncode:  # types from apt, which are not built for release
        assert 'PyFloat_Check(field)' in run.stderr
    else:
        assert abs(float(run.stdout)) < 1e-300


@claim('M15')
def test_checks_are_off_unless_they_are_asked_for():
    """Plain Jazzy reports no error; this course sets a variable that switches the checks on."""
    text = 'from std_msgs.msg import Float64\nFloat64().data = 25\n'
    for value, code in (('', 0), ('1', 1)):
        run = subprocess.run(
            [sys.executable, '-c', text],
            env={**__import__('os').environ, 'ROS_PYTHON_CHECK_FIELDS': value},
            capture_output=True,
            check=False,
        )
        assert run.returncode == code, run.stderr


@claim('M16')
def test_of_numpy_only_float64_is_a_float():
    message = Float64(check_fields=True)
    message.data = numpy.float64(21.5)
    assert through_the_wire(message).data == 21.5
    for other in (numpy.float32(21.5), numpy.int64(21)):
        with pytest.raises(AssertionError):
            message.data = other


@claim('M17')
def test_unknown_attributes_are_refused_and_unknown_keywords_only_with_checks():
    with pytest.raises(AttributeError):
        String().date = 'typo'
    with pytest.raises(AssertionError):
        String(check_fields=True, date='typo')
    assert String(check_fields=False, date='typo').data == ''


@claim('M18')
def test_classes_describe_themselves():
    """A class gives the names and types of its fields without an object."""
    assert Num.get_fields_and_field_types()['num'] == 'int64'
    assert len(Temperature.SLOT_TYPES) == len(Temperature.get_fields_and_field_types())


@claim('M19')
def test_message_may_change_after_it_was_published(world):
    node, heard = world.node(), []
    node.create_subscription(Int32, 'numbers', heard.append, 10)
    publisher, message = node.create_publisher(Int32, 'numbers', 10), Int32(data=1)
    publisher.publish(message)
    message.data = 2
    world.spin_until(lambda: heard, what='the message')
    assert heard[0].data == 1

    kept = []
    for number in range(3):
        message.data = number
        kept.append(message)
    assert [entry.data for entry in kept] == [2, 2, 2]


@claim('M20', 'C17')
def test_stamp_is_printed_with_nine_digits():
    """1.005 s printed without leading zeros looks like a second and a half."""
    stamp = Time(sec=1, nanosec=5_000_000)

    assert f'{stamp.sec}.{stamp.nanosec}' == '1.5000000'
    assert f'{stamp.sec}.{stamp.nanosec:09d}' == '1.005000000'


@claim('M21', 'C19', 'C26')
def test_standard_primitives_carry_no_meaning():
    """A Float64 has a number, and neither unit nor time; a Temperature has both."""
    assert set(Float64.get_fields_and_field_types()) == {'data'}
    assert {'unit', 'timestamp'} <= set(Temperature.get_fields_and_field_types())


@claim('M22', 'C18')
def test_same_number_means_different_things_in_two_units():
    """86 °F is 30 °C."""
    from temp_monitor_pkg.units import to_celsius

    assert to_celsius(86.0, 'Fahrenheit') == pytest.approx(30.0)
    assert to_celsius(86.0, 'Celsius') == 86.0


@claim('M13')
def test_numeric_arrays_are_arrays():
    """A field of numbers is an array.array, not a list."""
    from rcl_interfaces.msg import ParameterValue

    assert isinstance(ParameterValue().integer_array_value, array)
    assert Log.WARN in (30, b'\x1e')


@claim('C21')
def test_unused_import_is_what_linters_of_a_package_refuse():
    """ament_flake8 includes rule F401; any linter with this rule finds the import."""
    text = 'from std_msgs.msg import String\n\nprint("no text message here")\n'
    said = subprocess.run(
        [sys.executable, '-m', 'ruff', 'check', '--isolated', '--select', 'F401', '-'],
        input=text,
        capture_output=True,
        text=True,
        check=False,
    )

    assert said.returncode == 1
    assert 'F401' in said.stdout

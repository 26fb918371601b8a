"""Properties of the temperature logic for any input, and files that describe the package."""

import ast
import math
from pathlib import Path
import re
from xml.etree import ElementTree

from hypothesis import given, settings
from hypothesis import strategies as st
import pytest

from temp_monitor_pkg import units
from temp_monitor_pkg.heating_profile import Heating, SENSOR_MAX_C, SENSOR_MIN_C, SimulatedSensor
from temp_monitor_pkg.threshold import Finding, judge
from temp_monitor_pkg.units import from_celsius, to_celsius, UNITS

PACKAGE = Path(__file__).parents[2] / 'temp_monitor_pkg'
SOURCE = PACKAGE / 'temp_monitor_pkg'

# Set no time limit for a single example: a busy machine must not make a test fail.
untimed = settings(deadline=None)

any_float = st.floats()
plausible_c = st.floats(min_value=-100.0, max_value=200.0)


@untimed
@given(value_c=plausible_c, unit=st.sampled_from(UNITS))
def test_units_there_and_back_is_the_same_temperature(value_c, unit):
    assert to_celsius(from_celsius(value_c, unit), unit) == pytest.approx(value_c, abs=1e-9)


@untimed
@given(value=any_float, unit=st.one_of(st.sampled_from(UNITS), st.text()), limit_c=plausible_c)
def test_judge_any_reading_is_judged_without_an_exception(value, unit, limit_c):
    finding = judge(value, unit, limit_c).finding

    assert (finding is Finding.UNKNOWN_UNIT) == (unit not in UNITS)
    if unit == 'Celsius':
        assert (finding is Finding.TOO_HOT) == (value > limit_c)
        assert (finding is Finding.NOT_A_NUMBER) == math.isnan(value)


@untimed
@given(limit_c=plausible_c)
def test_judge_threshold_itself_is_normal_and_the_next_number_is_not(limit_c):
    above_c = math.nextafter(limit_c, math.inf)

    assert judge(limit_c, 'Celsius', limit_c).finding is Finding.NORMAL
    assert judge(above_c, 'Celsius', limit_c).finding is Finding.TOO_HOT


@untimed
@given(value_c=plausible_c, limit_c=plausible_c)
def test_judge_words_never_name_two_equal_numbers(value_c, limit_c):
    judgement = judge(value_c, 'Celsius', limit_c)
    if judgement.finding is Finding.TOO_HOT:
        numbers = re.findall(r'-?\d[\d.e+-]*', judgement.text)
        assert len(set(numbers)) == 2


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(min_value=0, max_value=2**31 - 1),
    rate_hz=st.sampled_from([0.5, 1.0, 4.0, 10.0]),
)
def test_sensor_default_heating_warns_within_a_minute_at_any_rate(seed, rate_hz):
    sensor = SimulatedSensor(Heating(), seed)
    values = []
    for _ in range(int(60 * rate_hz)):
        values.append(sensor.read())
        sensor.advance(1.0 / rate_hz)

    assert min(values) < 30.0 < max(values)
    assert all(math.isfinite(value) and SENSOR_MIN_C <= value <= SENSOR_MAX_C for value in values)


def test_messages_have_exactly_the_fields_of_the_course():
    reading = ['float64 temperature_value', 'string unit', 'builtin_interfaces/Time timestamp']
    number = ['int64 num', 'string description', 'float64[] values']
    wanted = {'Temperature.msg': [*reading, 'string sensor_id'], 'Num.msg': number}
    for name, fields in wanted.items():
        lines = (PACKAGE / 'msg' / name).read_text(encoding='utf-8').splitlines()
        found = [' '.join(line.split()) for line in lines if not line.startswith('#')]
        assert [line for line in found if line] == fields


def test_package_xml_declares_what_interfaces_need():
    """Without these declarations, the messages do not build, or build but do not work."""
    root = ElementTree.parse(PACKAGE / 'package.xml').getroot()
    declared = {(element.tag, element.text) for element in root}

    assert root.get('format') == '3'
    assert {
        ('buildtool_depend', 'ament_cmake'),
        ('buildtool_depend', 'rosidl_default_generators'),
        ('depend', 'builtin_interfaces'),
        ('exec_depend', 'rclpy'),
        ('exec_depend', 'rosidl_default_runtime'),
        ('member_of_group', 'rosidl_interface_packages'),
    } <= declared
    assert root.findtext('export/build_type') == 'ament_cmake'


def test_launch_file_is_python_with_the_expected_entry():
    """The launch system is not on PyPI, so the test can only parse the file, not run it."""
    source = (PACKAGE / 'launch' / 'temp_monitor.launch.py').read_text(encoding='utf-8')
    functions = [node.name for node in ast.parse(source).body if hasattr(node, 'name')]

    assert functions == ['generate_launch_description']


@pytest.mark.ros
def test_built_package_is_the_source():
    installed = Path(units.__file__).parent
    stale = [
        path.name
        for path in SOURCE.glob('*.py')
        if (installed / path.name).read_bytes() != path.read_bytes()
    ]

    assert not stale, f'{stale}: changed since the build; run `make test` to build it again'


def test_no_module_shadows_the_generated_package():
    """An __init__.py in the source folder would hide the messages from a Python started there."""
    assert not (SOURCE / '__init__.py').exists()
    assert not (PACKAGE / '__init__.py').exists()

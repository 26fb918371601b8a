"""Test the decisions and numbers of the package, without ROS."""

import math

import pytest

from temp_monitor_pkg.heating_profile import Heating, SENSOR_MAX_C, SENSOR_MIN_C, SimulatedSensor
from temp_monitor_pkg.threshold import Finding, judge
from temp_monitor_pkg.units import from_celsius, to_celsius, UnknownUnitError

JUST_ABOVE_30 = math.nextafter(30.0, 31.0)


@pytest.mark.parametrize(
    ('fahrenheit', 'celsius'), [(32.0, 0.0), (86.0, 30.0), (212.0, 100.0), (-40.0, -40.0)]
)
def test_conversion_known_pairs_are_exact(fahrenheit: float, celsius: float) -> None:
    """Well-known temperatures convert exactly, in both directions."""
    assert to_celsius(fahrenheit, 'Fahrenheit') == celsius
    assert from_celsius(celsius, 'Fahrenheit') == fahrenheit
    assert to_celsius(celsius, 'Celsius') == from_celsius(celsius, 'Celsius') == celsius


@pytest.mark.parametrize('unit', ['Kelvin', 'celsius', 'Celsius ', 'C', ''])
def test_conversion_unknown_unit_is_refused(unit: str) -> None:
    """Only the two agreed spellings are valid units; the error quotes the received unit."""
    with pytest.raises(UnknownUnitError, match='expected') as caught:
        to_celsius(20.0, unit)
    assert repr(unit) in str(caught.value)
    with pytest.raises(UnknownUnitError):
        from_celsius(20.0, unit)


@pytest.mark.parametrize(
    ('value', 'unit', 'finding'),
    [
        (29.999, 'Celsius', Finding.NORMAL),
        (30.0, 'Celsius', Finding.NORMAL),
        (JUST_ABOVE_30, 'Celsius', Finding.TOO_HOT),
        (-35.0, 'Celsius', Finding.NORMAL),
        (35.0, 'Fahrenheit', Finding.NORMAL),
        (86.0, 'Fahrenheit', Finding.NORMAL),
        (86.1, 'Fahrenheit', Finding.TOO_HOT),
        (math.inf, 'Celsius', Finding.TOO_HOT),
        (-math.inf, 'Celsius', Finding.NORMAL),
        (math.nan, 'Celsius', Finding.NOT_A_NUMBER),
        (math.nan, 'Fahrenheit', Finding.NOT_A_NUMBER),
        (35.0, 'Kelvin', Finding.UNKNOWN_UNIT),
        (math.nan, '', Finding.UNKNOWN_UNIT),
    ],
)
def test_judge_every_kind_of_reading_has_its_finding(
    value: float, unit: str, finding: Finding
) -> None:
    """Only a reading strictly above the threshold is too hot; invalid ones are recognised."""
    judgement = judge(value, unit, 30.0)

    assert judgement.finding is finding
    assert bool(judgement.text) == (finding is not Finding.NORMAL)


def test_judge_words_show_the_difference_that_decided() -> None:
    """The log shows two decimals, or more if the reading would otherwise look equal."""
    assert judge(31.256, 'Celsius', 30.0).text.startswith('31.26 degrees Celsius')
    assert '30.001' in judge(30.001, 'Celsius', 30.0).text


def test_heating_is_above_30_within_a_minute_and_comes_back() -> None:
    """The default cycle crosses 30 degrees while heating and again while cooling."""
    heating = Heating()
    hot = [second for second in range(91) if heating.temperature_c(second) > 30.0]

    assert hot == list(range(hot[0], hot[-1] + 1)), 'one hot stretch in each cycle'
    assert 10 < hot[0] < 60
    assert hot[-1] < 90
    assert heating.temperature_c(90.0) == pytest.approx(heating.coolest_c)


@pytest.mark.parametrize(
    ('heating', 'name'),
    [
        (Heating(coolest_c=30.0, warmest_c=30.0), 'coolest_c'),
        (Heating(coolest_c=math.nan), 'coolest_c'),
        (Heating(cycle_s=0.0), 'cycle_s'),
        (Heating(cycle_s=math.nan), 'cycle_s'),
    ],
)
def test_heating_impossible_cycle_is_named(heating: Heating, name: str) -> None:
    """The error message for an impossible cycle names the wrong value."""
    assert name in heating.problem()
    assert Heating().problem() == ''


def _series(seed: int, count: int = 90) -> list:
    sensor = SimulatedSensor(Heating(), seed)
    values = []
    for _ in range(count):
        values.append(sensor.read())
        sensor.advance(1.0)
    return values


def test_sensor_same_seed_same_readings() -> None:
    """Equal seeds give equal readings, different seeds give different ones."""
    assert _series(7) == _series(7)
    assert _series(7) != _series(8)


@pytest.mark.parametrize('seed', range(50))
def test_sensor_any_seed_warns_within_a_minute_and_recovers(seed: int) -> None:
    """For any seed, drift and noise never hide the crossing of 30 degrees, and readings vary."""
    values = _series(seed)

    assert values[0] < 30.0
    assert max(values[:60]) > 30.0
    assert values[-1] < 30.0
    assert len(set(values)) > 45


def test_sensor_reading_outside_its_range_is_clipped() -> None:
    """A temperature outside the sensor's range gives the nearest limit of the range."""
    assert SimulatedSensor(Heating(124.9, 500.0, 2.0), 1).read() <= SENSOR_MAX_C
    hot = SimulatedSensor(Heating(200.0, 300.0, 2.0), 1)
    cold = SimulatedSensor(Heating(-90.0, -80.0, 2.0), 1)

    assert hot.read() == SENSOR_MAX_C
    assert cold.read() == SENSOR_MIN_C

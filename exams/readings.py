"""
Specify a temperature monitor: readings, the expected warnings, and typical mistakes.

The exams ``temperature_subscriber`` and ``warning_check`` use this specification.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate
import math
import operator
from typing import Any

from autograder.exam.slips import Compare, NO_WARNING, warning_slips
from autograder.exam.specification import each, Rule, Slip
from autograder.exam.words import Causes
from autograder.judging.numbers import shows

THRESHOLD_C = 30.0
UNITS = ('Celsius', 'Fahrenheit')
SENSORS = ('temp_sensor_01', 'temp_sensor_02', '')

WHY = Causes(__file__, THRESHOLD_C=THRESHOLD_C)


@dataclass(frozen=True)
class Reading:
    """
    One message that the probe sends.

    :param kind: description that feedback may show, without the value of a hidden reading
    :param behind_s: how far the clock of its sensor is behind; whole seconds [s]
    """

    value: float
    kind: str
    unit: str = 'Celsius'
    behind_s: int = 0

    @property
    def celsius(self) -> float | None:
        """Return the value in degrees Celsius, None for an unknown unit."""
        if self.unit == 'Celsius':
            return self.value
        return (self.value - 32.0) / 1.8 if self.unit == 'Fahrenheit' else None

    @property
    def hot(self) -> bool:
        """Return whether the reading is strictly above the threshold, so that a warning is due."""
        return self.celsius is not None and self.celsius > THRESHOLD_C

    @property
    def odd(self) -> bool:
        """Return whether the reading is unusual: in an unknown unit, NaN or infinite."""
        return self.group in ('unknown', 'nan') or math.isinf(self.value)

    @property
    def group(self) -> str:
        """Return the group: ``hot``, ``cool``, ``Fahrenheit``, ``unknown`` or ``nan``."""
        if self.celsius is None or math.isnan(self.celsius):
            return 'unknown' if self.celsius is None else 'nan'
        return self.unit if self.unit == 'Fahrenheit' else 'hot' if self.hot else 'cool'

    @property
    def numbers(self) -> tuple[float, float]:
        """Return the value as received and in Celsius."""
        return self.value, self.value if self.celsius is None else self.celsius

    def is_in(self, text: str) -> bool:
        """Return whether a text shows the value, as received or in Celsius, within about 0.05."""
        return shows(text, *self.numbers)

    def message(self, number: int) -> dict[str, Any]:
        """Return the fields of the message."""
        # Two successive readings share stamp and sensor, so a node that drops readings with an
        # equal stamp loses one, and the hidden exam can send one message twice: readings 1 and 2.
        pair = _pair(number)
        return {
            'temperature_value': self.value,
            'unit': self.unit,
            'timestamp': {'sec': 100 + pair - self.behind_s, 'nanosec': 250_000_000},
            'sensor_id': sensor_of(number),
        }


def _pair(number: int) -> int:
    return (number + 1) // 2


def sensor_of(number: int) -> str:
    """Return the sensor of a reading; the specification has no rule about it."""
    return SENSORS[_pair(number) % len(SENSORS)]


def warns(
    hot: Compare = operator.gt,
    celsius: Callable[[Reading], float | None] = lambda one: one.celsius,
) -> Rule:
    """
    Return the rule of a monitor, which gives the number of warnings for each reading.

    :param hot: the monitor's comparison, by default the correct one
    :param celsius: the monitor's conversion, by default the correct one; None causes no warning
    """

    def warnings(reading: Reading) -> int:
        value = celsius(reading)
        return int(value is not None and hot(value, THRESHOLD_C))

    return each(warnings)


def takes_for(known: Callable[[str], str]) -> Rule:
    """Return the rule of a monitor that takes some unknown units for known ones."""
    return warns(celsius=lambda one: replace(one, unit=known(one.unit)).celsius)


def _with_factor(factor: float, reading: Reading) -> float | None:
    return (reading.value - 32.0) * factor if reading.unit == 'Fahrenheit' else reading.celsius


def _without_brackets(reading: Reading) -> float | None:
    return reading.value - 32.0 / 1.8 if reading.unit == 'Fahrenheit' else reading.celsius


def keeps_last(readings: Sequence[Reading]) -> list[int]:
    """Return the warnings of a monitor that repeats its last verdict after an unknown unit."""
    warnings, hot = [], False
    for one in readings:
        hot = hot if one.celsius is None else one.hot
        warnings.append(int(hot))
    return warnings


def keeps_fahrenheit(readings: Sequence[Reading]) -> Sequence[int]:
    """Return the warnings of a monitor that converts every reading after one in Fahrenheit."""
    met = accumulate((one.unit == 'Fahrenheit' for one in readings), operator.or_)
    known = zip(readings, (now and one.unit in UNITS for one, now in zip(readings, met)))
    return warns()([replace(one, unit='Fahrenheit') if it else one for one, it in known])


UNIT_SLIPS = (
    WHY.slip('keeps_last', keeps_last),
    WHY.slip('keeps_unit', keeps_fahrenheit),
    WHY.slip(
        'ignores_unit',
        warns(celsius=lambda one: None if one.celsius is None else one.value),
        warns(celsius=lambda one: one.value),
    ),
    WHY.slip(
        'too_large',
        warns(celsius=partial(_with_factor, 0.6)),
        warns(celsius=_without_brackets),
    ),
    WHY.slip(
        'wrong_conversion', warns(celsius=lambda one: one.value if one.unit == 'Celsius' else None)
    ),
    WHY.slip(
        'rounded_factor',
        *(warns(celsius=partial(_with_factor, factor)) for factor in (0.5555, 0.5556, 0.556)),
    ),
    WHY.slip(
        'first_letter',
        takes_for(lambda unit: next((one for one in UNITS if unit[:1] == one[0]), unit)),
        takes_for(lambda unit: next((one for one in UNITS if unit[:1].upper() == one[0]), unit)),
    ),
    WHY.slip(
        'part_of_a_unit',
        takes_for(lambda unit: next((one for one in UNITS if unit in one), unit)),
        takes_for(lambda unit: 'Celsius' if unit in 'Celsius' else unit),
        takes_for(lambda unit: 'Fahrenheit' if unit in 'Fahrenheit' else unit),
    ),
    WHY.slip(
        'empty_unit',
        takes_for(lambda unit: unit or 'Celsius'),
        takes_for(lambda unit: unit or 'Fahrenheit'),
    ),
    WHY.slip('any_case', takes_for(str.capitalize)),
    WHY.slip(
        'other_is_fahrenheit',
        takes_for(lambda unit: 'Celsius' if unit == 'Celsius' else 'Fahrenheit'),
    ),
    WHY.slip(
        'unknown_unit',
        warns(celsius=lambda one: one.value if one.celsius is None else one.celsius),
    ),
)


def slips(burst: int = 0) -> tuple[Slip, ...]:
    """Return the slips of a monitor; the last ``burst`` readings are sent together."""
    found = warning_slips(warns, str(THRESHOLD_C), burst, UNIT_SLIPS)
    return (*found, Slip.of(NO_WARNING, each(lambda one: 0)))

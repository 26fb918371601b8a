"""
Specify a temperature monitor: readings, the expected warnings, and causes of mistakes.

The exam ``temperature_subscriber`` compares recordings with this specification.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
import math
import operator
from typing import Any

from autograder.exam.exam import Cause
from autograder.exam.slips import Compare, NO_WARNING, warning_slips
from autograder.exam.specification import each, Rule, Slip
from autograder.judging.numbers import shows

THRESHOLD_C = 30.0
UNITS = ('Celsius', 'Fahrenheit')


@dataclass(frozen=True)
class Reading:
    """
    One message that the probe sends.

    :param kind: description that feedback may show, without the value of a hidden reading
    """

    value: float
    kind: str
    unit: str = 'Celsius'

    @property
    def celsius(self) -> float | None:
        """Return the value in degrees Celsius, None for an unknown unit."""
        if self.unit == 'Celsius':
            return self.value
        return (self.value - 32.0) / 1.8 if self.unit == 'Fahrenheit' else None

    @property
    def hot(self) -> bool:
        """Return whether a warning is due: strictly above the threshold."""
        return self.celsius is not None and self.celsius > THRESHOLD_C

    @property
    def odd(self) -> bool:
        """Return whether the reading is not a proper temperature: an unknown unit or NaN."""
        return self.group in ('unknown', 'nan')

    @property
    def group(self) -> str:
        """Return the group: ``hot``, ``cool``, ``Fahrenheit``, ``unknown`` or ``nan``."""
        if self.celsius is None or math.isnan(self.celsius):
            return 'unknown' if self.celsius is None else 'nan'
        return self.unit if self.unit == 'Fahrenheit' else 'hot' if self.hot else 'cool'

    @property
    def numbers(self) -> tuple[float, float]:
        """Return the value as it came and in Celsius."""
        return self.value, self.value if self.celsius is None else self.celsius

    def is_in(self, text: str) -> bool:
        """Return whether a text contains the value, raw or in Celsius, with any rounding."""
        return shows(text, *self.numbers)

    def message(self, number: int) -> dict[str, Any]:
        """Return the fields of the message."""
        # Two successive readings share a stamp: a node that drops readings with an equal stamp
        # loses one.  Readings 1 and 2 do, so the hidden exam can send one message twice.
        return {
            'temperature_value': self.value,
            'unit': self.unit,
            'timestamp': {'sec': 100 + (number + 1) // 2, 'nanosec': 250_000_000},
            'sensor_id': 'temp_sensor_01',
        }


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
    """
    Return the rule of a monitor that reads some unknown units as known ones.

    :param known: returns the unit that the monitor assumes for a given unit
    """
    return warns(celsius=lambda one: replace(one, unit=known(one.unit)).celsius)


def _with_factor(factor: float, reading: Reading) -> float | None:
    return (reading.value - 32.0) * factor if reading.unit == 'Fahrenheit' else reading.celsius


NO_UNIT = Cause(
    'unit_text',
    'Your node logs an ERROR for readings in Celsius, as if their unit were unknown.',
    "Compare with the whole words, letter by letter: msg.unit == 'Celsius', 'Fahrenheit'.",
)
ONE_LINE = Cause(
    'several_errors',
    'Your node logs more than one ERROR line for one reading in an unknown unit.',
    'Put everything into one line, call self.get_logger().error(...) in one place, and subscribe '
    'once.',
)
NEEDLESS_ERROR = Cause(
    'needless_error',
    'Your node handles a reading in a known unit correctly, but also logs an ERROR line.',
    'Log an ERROR only for unknown units: remove that self.get_logger().error(...).',
)
LOGGED_TWICE = Cause(
    'logged_twice',
    'Your node logs more than one INFO line with the value of each reading.',
    'Call self.get_logger().info(...) with the value once in the callback, and subscribe once.',
)
NOT_LOGGED = Cause(
    'not_logged',
    'Your node logs no INFO line for a reading.',
    'Call self.get_logger().info(...) first in the callback: before any if and any return.',
)
NO_VALUE = Cause(
    'no_value',
    'Your INFO line does not contain the value of the reading, or lacks its decimals.',
    "Put msg.temperature_value into the text: f'{msg.temperature_value:.2f}'.",
)
TO_STDERR = Cause(
    'print_instead_of_logger',
    'Your code writes to stderr, which is not the log of the node.',
    'Use self.get_logger().error(...): it also goes to the topic /rosout.',
    act='stderr@to:create_subscription()',
)
NO_ERROR = Cause(
    'no_error',
    'Your node logs no ERROR line for a reading in an unknown unit.',
    'For any unit that you do not know: self.get_logger().error(...), return.',
    closer=[TO_STDERR],
)
ERROR_ONCE = Cause(
    'error_once',
    'Your node logs an ERROR line for the first reading in an unknown unit, but not when the same '
    'unit comes again.',
    'Log one ERROR line for every reading in an unknown unit, without once= and without a list of '
    'units already seen.',
)
BURST_IS_CUT = Cause(
    'burst_is_cut',
    'Your node handles single readings, but only some of several readings that arrive at once.',
    'Is the depth of your subscription 10? If so, your callback stores only the newest reading: '
    'log and compare in the callback itself.',
)
FAHRENHEIT_REFUSED = Cause(
    'fahrenheit_refused',
    'Your node logs an ERROR for readings in Fahrenheit, as if their unit were unknown.',
    "Add a branch for the whole word, letter by letter: if msg.unit == 'Fahrenheit', celsius = "
    '(value - 32) / 1.8.',
)
UNKNOWN_UNIT = Cause(
    'unknown_unit',
    f'A number without a known unit cannot be compared with {THRESHOLD_C:g} °C.',
    'For any unit that you do not know: self.get_logger().error(...), return.',
)
ONLY_WARNED = Cause(
    'only_warned',
    f'For a reading above {THRESHOLD_C:g} °C, your node logs a WARN line, but no INFO line.',
    'Log both: call self.get_logger().info(...) for each reading, before you compare.',
)
KEEPS_UNIT = Cause(
    'keeps_unit',
    'Your node uses the unit of an earlier reading, so it does not convert this one.',
    'Look at msg.unit of each reading: one sensor may send readings in both units.',
    act='setdefault() | kept_first',
)
UNIT_SLIPS = (
    Slip(
        'ignores_unit',
        'The number is compared without conversion, or the conversion gives another number.',
        'Look at msg.unit first: celsius = (value - 32) / 1.8 for Fahrenheit.',
        warns(celsius=lambda one: None if one.celsius is None else one.value),
        warns(celsius=lambda one: one.value),
        closer=[KEEPS_UNIT],
    ),
    Slip(
        'wrong_conversion',
        'Your node warns about warm readings in Celsius, but not in Fahrenheit: it does not '
        'compare them, or its conversion gives too small a number.',
        'celsius = (value - 32) / 1.8, with / and not //. Try yours: 86 °F must give 30, and '
        '86.9 °F 30.5.',
        warns(celsius=lambda one: one.value if one.unit == 'Celsius' else None),
    ),
    Slip(
        'rounded_factor',
        'Your conversion from Fahrenheit uses a rounded number.',
        'Write celsius = (value - 32) / 1.8, or * 5 / 9, and round nothing.',
        *(warns(celsius=partial(_with_factor, factor)) for factor in (0.5555, 0.5556, 0.556)),
    ),
    Slip(
        'first_letter',
        'Your node accepts a unit that only begins like Celsius or Fahrenheit.',
        "Compare the whole word: msg.unit == 'Celsius'.",
        takes_for(lambda unit: next((one for one in UNITS if unit[:1] == one[0]), unit)),
        takes_for(lambda unit: next((one for one in UNITS if unit[:1].upper() == one[0]), unit)),
    ),
    Slip(
        'part_of_a_unit',
        'Your node accepts a unit that is empty or only part of the word.',
        "Compare with ==, not with in: msg.unit == 'Celsius'.",
        takes_for(lambda unit: next((one for one in UNITS if unit in one), unit)),
    ),
    Slip(
        'any_case',
        'Your node accepts a unit with different capital letters, such as celsius.',
        "Compare the received text, without lower() or upper(): msg.unit == 'Celsius'.",
        takes_for(str.capitalize),
    ),
    Slip.of(
        UNKNOWN_UNIT,
        warns(celsius=lambda one: one.value if one.celsius is None else one.celsius),
    ),
)


def slips(burst: int = 0) -> tuple[Slip, ...]:
    """Return the slips of a monitor, with ``burst`` readings at the end that are sent at once."""
    found = warning_slips(warns, str(THRESHOLD_C), burst, UNIT_SLIPS)
    return (*found, Slip.of(NO_WARNING, each(lambda one: 0)))

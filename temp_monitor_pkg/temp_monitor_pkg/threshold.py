"""Decide whether a single reading is above the threshold of the monitor."""

from dataclasses import dataclass
from enum import Enum
import math

from temp_monitor_pkg.units import to_celsius, UnknownUnitError


class Finding(Enum):
    """The result of judging a reading."""

    NORMAL = 'normal'
    TOO_HOT = 'too hot'
    NOT_A_NUMBER = 'not a number'
    UNKNOWN_UNIT = 'unknown unit'


@dataclass(frozen=True)
class Judgement:
    """A finding with the text for the log, which is empty if there is nothing to add."""

    finding: Finding
    text: str = ''


def judge(value: float, unit: str, threshold_c: float) -> Judgement:
    """
    Compare one reading with the threshold.

    Only a reading strictly above the threshold is too hot; an equal reading is normal.

    :param value: the reading, in ``unit``
    :param unit: the unit given in the reading
    :param threshold_c: the threshold [degree Celsius], finite
    :returns: the finding and its text; no reading makes this function raise an exception
    """
    try:
        value_c = to_celsius(value, unit)
    except UnknownUnitError as error:
        return Judgement(Finding.UNKNOWN_UNIT, f'reading ignored, {error}')
    if math.isnan(value_c):
        # Every comparison with NaN is false: without this branch, a dead sensor would look cool.
        return Judgement(Finding.NOT_A_NUMBER, 'reading ignored, the value is not a number')
    if value_c > threshold_c:
        return Judgement(Finding.TOO_HOT, _too_hot(value_c, threshold_c))
    return Judgement(Finding.NORMAL)


def _too_hot(value_c: float, threshold_c: float) -> str:
    shown, limit = f'{value_c:.2f}', f'{threshold_c:.2f}'
    if shown == limit:  # two decimals would not show that the reading is above the limit
        shown, limit = repr(value_c), repr(threshold_c)
    return f'{shown} degrees Celsius is above the threshold of {limit}'

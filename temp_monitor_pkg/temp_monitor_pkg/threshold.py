"""The monitor's one decision: what a single reading means for the threshold."""

from dataclasses import dataclass
from enum import Enum
import math

from temp_monitor_pkg.units import to_celsius, UnknownUnitError


class Finding(Enum):
    """What a reading turned out to be."""

    NORMAL = 'normal'
    TOO_HOT = 'too hot'
    NOT_A_NUMBER = 'not a number'
    UNKNOWN_UNIT = 'unknown unit'


@dataclass(frozen=True)
class Judgement:
    """A finding with the words for the log; no words where there is nothing to add."""

    finding: Finding
    text: str = ''


def judge(value: float, unit: str, threshold_c: float) -> Judgement:
    """
    Compare one reading with the threshold.

    Too hot means strictly above: a reading equal to the threshold is normal.

    :param value: the reading, in ``unit``
    :param unit: the unit that came with the reading
    :param threshold_c: the threshold [degree Celsius], finite
    :returns: the finding and its words; this function does not raise for any reading
    """
    try:
        value_c = to_celsius(value, unit)
    except UnknownUnitError as error:
        return Judgement(Finding.UNKNOWN_UNIT, f'reading ignored, {error}')
    if math.isnan(value_c):
        # Every comparison with NaN is false, so without this branch a dead sensor looks cool.
        return Judgement(Finding.NOT_A_NUMBER, 'reading ignored, the value is not a number')
    if value_c > threshold_c:
        return Judgement(Finding.TOO_HOT, _too_hot(value_c, threshold_c))
    return Judgement(Finding.NORMAL)


def _too_hot(value_c: float, threshold_c: float) -> str:
    shown, limit = f'{value_c:.2f}', f'{threshold_c:.2f}'
    if shown == limit:  # two decimals would hide what makes it too hot
        shown, limit = repr(value_c), repr(threshold_c)
    return f'{shown} degrees Celsius is above the threshold of {limit}'

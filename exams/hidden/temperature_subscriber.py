"""Hidden exam of lesson 07, part 3: all edge cases, a burst, and secret readings."""

from dataclasses import replace
import math
import random

from autograder.exam.inputs import generator
from exams.readings import Reading, THRESHOLD_C, UNITS
from exams.visible.temperature_subscriber import build

UNKNOWN, UNIT = 'a reading in an unknown unit', 'Fahrenheit'


def edges(draw: random.Random) -> list[Reading]:
    """
    Return readings in Celsius at, near and far below the threshold, in a secret order.

    One is below absolute zero: the node must not judge whether a reading is plausible.
    """
    readings = [
        Reading(THRESHOLD_C, f'a reading of exactly {THRESHOLD_C} °C'),
        Reading(THRESHOLD_C + 0.01, f'a reading just above {THRESHOLD_C:g} °C'),
        Reading(THRESHOLD_C + 0.004, f'a reading of {THRESHOLD_C + 0.004:.3f} °C'),
        Reading(THRESHOLD_C - 0.01, f'a reading just below {THRESHOLD_C:g} °C'),
        Reading(0.0, 'a reading of 0 °C'),
        Reading(round(draw.uniform(-400.0, -300.0), 2), 'a reading far below zero'),
    ]
    draw.shuffle(readings)
    return readings


def fahrenheit(draw: random.Random) -> list[Reading]:
    """Return alternating warm and cool readings in Fahrenheit, some close to the threshold."""
    limit = THRESHOLD_C * 1.8 + 32.0
    warm = [
        Reading(round(draw.uniform(limit + 0.1, limit + 0.4), 2), 'a warm reading in °F', UNIT),
        Reading(limit + 0.002, 'a reading in °F just above the threshold', UNIT),
    ]
    cold = [
        Reading(round(draw.uniform(limit - 0.5, limit - 0.1), 2), 'a cool reading in °F', UNIT),
        Reading(limit - 0.002, 'a reading in °F just below the threshold', UNIT),
    ]
    draw.shuffle(warm)
    draw.shuffle(cold)
    # Alternate: a node that warns only about changes would miss the second of two warm readings.
    return [one for pair in zip(warm, cold) for one in pair]


def odd(draw: random.Random) -> list[Reading]:
    """
    Return readings with unknown units and NaN, which may crash a node.

    They belong near the end, so that a crash affects only the few readings after them.
    """
    rest = ''.join(draw.choices('bdghjlqrtvwxz', k=5))
    units = [
        *[(f'C{rest}', UNKNOWN)] * 2,
        (f'F{rest[::-1]}', UNKNOWN),
        ('celsius', 'a reading in celsius, spelled in lower case'),
        ('', 'a reading without a unit'),
    ]
    draw.shuffle(units)
    readings = [Reading(round(draw.uniform(200.0, 400.0), 2), kind, unit) for unit, kind in units]
    return [*readings, Reading(math.nan, 'a reading that is not a number')]


def hot(draw: random.Random) -> Reading:
    """Return a reading in Celsius above the threshold."""
    return Reading(
        round(draw.uniform(THRESHOLD_C + 1.0, 80.0), 2), f'a reading above {THRESHOLD_C:g} °C'
    )


def cool(draw: random.Random) -> Reading:
    """Return a reading in Celsius below the threshold."""
    return Reading(
        round(draw.uniform(1.0, THRESHOLD_C - 1.0), 2), f'a reading below {THRESHOLD_C:g} °C'
    )


_draw = generator('temperature_subscriber', 'readings')
_again = hot(_draw)
_burst = [*(hot(_draw) for _ in range(5)), *(cool(_draw) for _ in range(4))]
_draw.shuffle(_burst)
*_units, _nan = odd(_draw)
exam = build(
    [
        cool(_draw),
        # A repeated reading and a different one: each needs its own warning.
        *(_again, _again, hot(_draw)),
        # A log line with only three significant digits does not show this reading.
        Reading(int(_draw.uniform(200.0, 900.0)) + 0.4, f'a reading far above {THRESHOLD_C:g} °C'),
        *(cool(_draw), cool(_draw)),
        *edges(_draw),
        # Send a cool reading first: otherwise a node that warns only about changes could also miss
        # the warm reading in Fahrenheit.
        cool(_draw),
        *fahrenheit(_draw),
        # A node whose conversion lacks brackets warns only about the first of these, and one that
        # converts nothing about both.
        *(Reading(one, 'a cold reading in °F', UNIT) for one in (60.5, 40.25)),
        # A node that does not return after an unknown unit judges this reading again.  Its stamp
        # is older than the others: the specification has no rule about stamps.
        replace(hot(_draw), behind_s=20),
        *_units,
        *(Reading(round(_draw.uniform(200.0, 400.0), 2), UNKNOWN, one[1:]) for one in UNITS),
        # A node that takes unknown units for Celsius warns about one of these; one that takes them
        # for Fahrenheit warns about none.
        *(replace(one(_draw), kind=UNKNOWN, unit='Kelvin') for one in (hot, cool)),
        _nan,
        Reading(math.inf, 'a reading of infinity'),
        hot(_draw),
        *(cool(_draw), hot(_draw), *_burst),
    ],
    burst=1 + len(_burst),
)

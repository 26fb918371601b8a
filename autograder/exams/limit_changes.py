"""
Define changes of a limit, and the temperatures that the exam sends between them.

This module holds data and rules; the exam ``limit_keeper`` lists the slips.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
import math
from typing import NamedTuple

from autograder.exam.ranges import Accepts
from autograder.exam.specification import each, Rule, Specification

LIMIT, PLACE = 'limit_c', 'place'
LOWEST_C, HIGHEST_C = -40.0, 125.0
BURST = 3
"""Number of temperatures above the limit that are sent at once at the end."""
NO_NUMBERS = (float('nan'), float('inf'), float('-inf'))
JUST_OUTSIDE = (LOWEST_C * (1 + 1e-9), HIGHEST_C * (1 + 1e-9))
ACCEPTED = 'results.0.successful'
"""Field of the ``set_parameters`` response that contains whether a change was accepted."""
Change = tuple[str, float | int | str]
"""The name of a parameter and its requested value."""


class Reading(NamedTuple):
    """
    A temperature that the probe sends.

    :param limit: the limit in force [degC]
    :param start: the limit at the start [degC]
    :param tried: the last requested limit, accepted or not [degC]
    :param changes: number of changes requested before this temperature
    """

    value: float
    kind: str
    limit: float
    start: float
    tried: float
    changes: int = 0


def sensible(value: float) -> bool:
    """Return whether a limit is in the valid range."""
    return LOWEST_C <= value <= HIGHEST_C


def kind_of(value: float | str) -> str:
    """Return a description of a limit that makes no sense, which feedback may show."""
    if not isinstance(value, float):
        return 'a value of a different type'
    if not math.isfinite(value):
        return 'NaN' if math.isnan(value) else 'infinity'
    return 'a value that is too low' if value < LOWEST_C else 'a value that is too high'


def deciding(
    accepts: Accepts = sensible,
    other: Callable[[object], bool] = lambda text: True,
    kinds: Sequence[type] = (float,),
) -> Rule:
    """
    Return the rule of a program that accepts or refuses changes; by default, the correct one.

    :param other: returns whether the program accepts a value of another parameter
    :param kinds: types of limits that it accepts
    """

    def decide(change: Change) -> bool:
        name, value = change
        if name != LIMIT:
            return other(value)
        return type(value) in kinds and accepts(float(value))

    return each(lambda change: {ACCEPTED: decide(change)})


def warning(above: Callable[[Reading], bool] = lambda one: one.value > one.limit) -> Rule:
    """
    Return the rule of a program that judges each temperature independently.

    :param above: returns whether the program warns; by default, the correct comparison
    """
    return each(lambda one: int(above(one)))


def readings(start: float, changes: Sequence[Change]) -> Iterator[Reading]:
    """
    Yield temperatures: some before the first change, two near the limit after each, a burst.

    :param start: limit at the start, with one decimal; its fraction is below 0.5 [degC]
    """
    first = (start - 1.5, start + 1.25, start + 2.5, start + 2.5, start, start + 0.004)
    for value in (*first, -90.0, math.nan, 300.0):
        yield Reading(value, 'a temperature', start, start, start)
    limit = tried = start
    for number, (name, wanted) in enumerate(changes, 1):
        if name == LIMIT and isinstance(wanted, float):
            tried = wanted
            limit = wanted if sensible(wanted) else limit
        for near in (limit - 1.0, limit + 1.0):
            yield Reading(near, 'a temperature near the limit', limit, start, tried, number)
    for more in range(BURST):
        high = limit + 1.5 + more
        yield Reading(high, 'a temperature in a burst', limit, start, tried, len(changes))


def in_force(
    asked: Specification, changes: Sequence[Change], accepted: Sequence[bool | None]
) -> Specification:
    """
    Return the specification of the warnings for the limits that a node has actually accepted.

    :param asked: the specification for the limits that a correct node accepts
    :param accepted: the node's answers to the changes, in order; None without an answer
    """
    limits = [asked.inputs[0].start]
    for (name, value), taken in zip(changes, accepted):
        limits.append(float(value) if name == LIMIT and taken else limits[-1])
    inputs = [
        one._replace(limit=limits[min(one.changes, len(limits) - 1)]) for one in asked.inputs
    ]
    return replace(asked, inputs=inputs)

"""
Changes of a limit that an exam asks for, and the temperatures that it sends between them.

Data and rules only; which mistakes there are is in the exam ``limit_keeper``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from autograder.exam.ranges import Accepts
from autograder.exam.specification import each, Rule, Specification

LIMIT, PLACE = 'limit_c', 'place'
LOWEST_C, HIGHEST_C = -40.0, 125.0
NO_NUMBERS = (float('nan'), float('inf'), float('-inf'))
ACCEPTED = 'results.0.successful'
"""Where the answer of ``set_parameters`` says whether a change was accepted."""
Change = tuple[str, float | int | str]
"""A parameter, and the value that it is to be set to."""


class Reading(NamedTuple):
    """
    A temperature that is sent.

    :param limit: the limit that is in force [degC]
    :param start: the limit at the start [degC]
    :param tried: the last limit that was asked for, accepted or not [degC]
    :param changes: how many changes have been asked for before
    """

    value: float
    kind: str
    limit: float
    start: float
    tried: float
    changes: int = 0


def sensible(value: float) -> bool:
    """Return whether a limit makes sense."""
    return LOWEST_C <= value <= HIGHEST_C


def deciding(
    accepts: Accepts = sensible, other: bool = True, kinds: Sequence[type] = (float,)
) -> Rule:
    """
    Return the rule of a program that decides about changes; by default the right one.

    :param other: whether it accepts a change of another parameter
    :param kinds: types of limits that it looks at
    """

    def decide(change: Change) -> bool:
        name, value = change
        if name != LIMIT:
            return other
        return type(value) in kinds and accepts(float(value))

    return each(lambda change: {ACCEPTED: decide(change)})


def warning(above: Callable[[Reading], bool] = lambda one: one.value > one.limit) -> Rule:
    """Return the rule of a program that warns of each temperature by itself; by default right."""
    return each(lambda one: int(above(one)))


def readings(start: float, changes: Sequence[Change]) -> Iterator[Reading]:
    """
    Yield the temperatures to send: some before the first change, two near the limit after each.

    :param start: limit at the start, with one decimal, which is less than 0.5 [degC]
    """
    for value in (start - 1.5, start + 1.25, start + 2.5, start, start + 0.004, -90.0, 300.0):
        yield Reading(value, 'a temperature', start, start, start)
    limit = tried = start
    for number, (name, wanted) in enumerate(changes, 1):
        if name == LIMIT and isinstance(wanted, float):
            tried = wanted
            limit = wanted if sensible(wanted) else limit
        for near in (limit - 1.0, limit + 1.0):
            yield Reading(near, 'a temperature near the limit', limit, start, tried, number)


def in_force(
    asked: Specification, changes: Sequence[Change], accepted: Sequence[bool | None]
) -> Specification:
    """
    Return what is due after each temperature, with the limits that a node has accepted.

    :param asked: the same with the limits that a right node accepts
    :param accepted: the node's answers to the changes, in order
    """
    limits = [asked.inputs[0].start]
    for (name, value), taken in zip(changes, accepted):
        limits.append(float(value) if name == LIMIT and taken else limits[-1])
    inputs = [
        one._replace(limit=limits[min(one.changes, len(limits) - 1)]) for one in asked.inputs
    ]
    return replace(asked, inputs=inputs)

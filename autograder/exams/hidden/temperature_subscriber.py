"""Lesson 07, part 3, as it is graded: every edge, a burst, and readings nobody can know."""

from __future__ import annotations

import math
import random

from autograder.exam.inputs import generator
from autograder.exams.readings import Reading
from autograder.exams.visible.temperature_subscriber import build


def edges(draw: random.Random) -> list[Reading]:
    """
    Return the readings at and beside the threshold, in an order nobody can know.

    What a program may die of comes last, so that what it loses by that is no matter of luck.
    """
    unknown = ''.join(draw.choices('BDGHJLQRTVWXZ', k=6))
    readings = [
        Reading(30.0, 'a reading of exactly 30.0 °C'),
        Reading(30.01, 'a reading just above 30 °C'),
        Reading(29.99, 'a reading just below 30 °C'),
        Reading(round(draw.uniform(-60.0, -31.0), 2), 'a reading far below zero'),
        Reading(round(draw.uniform(86.1, 86.4), 2), 'a warm reading in °F', 'Fahrenheit'),
        Reading(round(draw.uniform(85.5, 85.9), 2), 'a cool reading in °F', 'Fahrenheit'),
    ]
    draw.shuffle(readings)
    odd = round(draw.uniform(200.0, 400.0), 2)
    return [
        *readings,
        Reading(odd, 'a reading in an unknown unit', unknown),
        Reading(math.nan, 'a reading that is not a number'),
    ]


def usual(draw: random.Random, count: int) -> list[Reading]:
    """Return random readings in Celsius, half of them above the threshold."""
    found = []
    for number in range(count):
        hot = number % 2 == 0
        value = round(draw.uniform(31.0, 80.0) if hot else draw.uniform(-20.0, 29.0), 2)
        found.append(Reading(value, 'a reading above 30 °C' if hot else 'a reading below 30 °C'))
    draw.shuffle(found)
    return found


_draw = generator('temperature_subscriber', 'readings')
exam = build(
    [
        Reading(18.25, 'a reading below 30 °C'),
        *usual(_draw, 4),
        *edges(_draw),
        Reading(21.5, 'a reading below 30 °C'),
    ],
    burst=[Reading(45.0, 'a reading above 30 °C'), *usual(_draw, 4)],
)

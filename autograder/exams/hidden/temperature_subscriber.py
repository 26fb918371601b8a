"""Lesson 07, part 3, as it is graded: every edge, a burst, and readings nobody can know."""

from __future__ import annotations

import math
import random

from autograder.exams.visible.temperature_subscriber import build, Reading
from autograder.inputs import generator


def edges(draw: random.Random) -> list[Reading]:
    """Return the readings at and beside the threshold, in an order nobody can know."""
    unknown = ''.join(draw.choices('BDGHJLQRTVWXZ', k=6))
    readings = [
        Reading(30.0, 'a reading of exactly 30.0 °C'),
        Reading(30.01, 'a reading just above 30 °C'),
        Reading(29.99, 'a reading just below 30 °C'),
        Reading(round(draw.uniform(-60.0, -31.0), 2), 'a reading far below zero'),
        Reading(round(draw.uniform(86.5, 100.0), 2), 'a warm reading in °F', 'Fahrenheit'),
        Reading(round(draw.uniform(40.0, 85.5), 2), 'a cool reading in °F', 'Fahrenheit'),
        Reading(round(draw.uniform(200.0, 400.0), 2), 'a reading in an unknown unit', unknown),
        Reading(math.nan, 'a reading that is not a number'),
    ]
    draw.shuffle(readings)
    return readings


def usual(draw: random.Random, count: int) -> list[Reading]:
    """Return random readings on both sides of the threshold, in Celsius."""
    found = []
    for _ in range(count):
        hot = draw.random() < 0.5
        value = round(draw.uniform(31.0, 80.0) if hot else draw.uniform(-20.0, 29.0), 2)
        found.append(Reading(value, 'a reading above 30 °C' if hot else 'a reading below 30 °C'))
    return found


_draw = generator('temperature_subscriber', 'readings')
exam = build(
    [
        Reading(18.25, 'a reading of 18.25 °C'),
        *usual(_draw, 4),
        *edges(_draw),
        Reading(21.5, 'a reading of 21.5 °C'),
    ],
    burst=[Reading(45.0, 'a reading above 30 °C'), *usual(_draw, 4)],
    secret=True,
)

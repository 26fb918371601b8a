"""Hidden exam of lesson 07, part 1: secret readings."""

from autograder.exam.inputs import generator
from exams.visible.temperature_message import build, random_reading

_draw = generator('temperature_message', 'readings')
exam = build([random_reading(_draw) for _ in range(3)])

"""Hidden exam of lesson 01, first exercise: a longer run."""

from autograder.exam.inputs import WATCH_S
from exams.visible.harbour import build

exam = build(seconds=WATCH_S)

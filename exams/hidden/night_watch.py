"""Hidden exam of lesson 01, second exercise: a longer run in a secret namespace."""

from autograder.exam.inputs import generator, WATCH_S
from exams.visible.night_watch import build

_draw = generator('night_watch', 'time and place')
exam = build(seconds=WATCH_S, namespace='/' + ''.join(_draw.choices('bcdfghklmnprst', k=6)))

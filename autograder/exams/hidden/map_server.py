"""Lesson 05, part 4, as it is graded: with surveys nobody can know."""

from __future__ import annotations

from autograder.exams.visible.map_server import build
from autograder.runs.inputs import generator

_draw = generator('map_server', 'rooms')
_ROOMS = ('hall', 'cellar', 'attic', 'yard', 'workshop', 'stairs', 'lab', 'office')
exam = build(
    [f'{room} {_draw.randrange(100, 1000)}' for room in _draw.sample(_ROOMS, k=5)],
)

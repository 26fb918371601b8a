"""Hidden exam of lesson 04, part 1: a type has no inputs, so it is the same exam."""

from __future__ import annotations

from autograder.exams.visible.station_message import build

exam = build()

"""Lesson 04, part 1, as it is graded: a type has no inputs, so it is the same exam."""

from __future__ import annotations

from autograder.exams.visible.station_message import build

exam = build()

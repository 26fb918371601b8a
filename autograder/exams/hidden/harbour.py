"""Lesson 01, first exercise, as it is graded: longer."""

from __future__ import annotations

from autograder.exams.visible.harbour import build

exam = build(seconds=20)

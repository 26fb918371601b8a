"""Measurements of the grader, each runnable by name; see README.md."""

"""Learners' Python, read as a syntax tree and never run."""

"""Fixtures that several files use: a course, and a function that collects files for it."""

from collect_sources import gather, here, layout  # noqa: F401

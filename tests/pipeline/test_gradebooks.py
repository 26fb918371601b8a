"""Test one gradebook with one writer: reruns, manual grades, lateness."""

from __future__ import annotations

import gradebooks
import pytest


@pytest.mark.nbgrader
@pytest.mark.parametrize('scene', gradebooks.ALL, ids=lambda scene: scene.__name__)
def test_sqlite(scene, course):
    """SQLite is the default database of a course."""
    scene(course)

"""Run the test cases for the gradebook on SQLite: reruns, manual grades, lateness."""

import gradebooks
import pytest


@pytest.mark.nbgrader
@pytest.mark.parametrize('scene', gradebooks.ALL, ids=lambda scene: scene.__name__)
def test_sqlite(scene, course):
    scene(course)

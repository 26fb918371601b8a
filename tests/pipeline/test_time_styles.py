"""
An exam gives points for a right rhythm, however a program keeps it, but not for a wrong one.

See :mod:`tests.clock.style_pairs` for the programs and exams.
"""

from contextlib import nullcontext

import pytest

from autograder.grading.examine import Engine
from autograder.results import Verdict
from autograder.sandboxes.choose import strongest
from tests.attacks.corpus import early_limits
from tests.clock.style_pairs import judged, NAMES
from tests.clock.time_styles import ENDS

pytestmark = [pytest.mark.ros, pytest.mark.pipeline, pytest.mark.slow]
RHYTHM = ('speaks_twice_a_second', 'keeps_its_rhythm', 'one_for_one')
"""The check that judges the time, by exam."""


def lost(style: str, right: bool) -> list[str]:
    """Return the checks that a program fails."""
    exam, files = judged(style, right)
    with early_limits() if ENDS.get(style) == 'cpu_limit' else nullcontext():
        result = Engine(strongest()).run(exam, files)
    return [one.check for one in result.checks if one.verdict is not Verdict.PASSED]


@pytest.mark.parametrize('style', NAMES)
def test_right_program_keeps_its_points(style):
    """Programs keep time with timers, sleeps, threads, signals, processes and polls."""
    assert lost(style, right=True) == []


@pytest.mark.parametrize('style', NAMES)
def test_wrong_program_loses_them(style):
    """Only the check of the rhythm fails."""
    (check,) = lost(style, right=False)

    assert check in RHYTHM

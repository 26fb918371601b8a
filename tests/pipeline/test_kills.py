"""A grading that was killed continues without a trace of the interruption."""

import pytest

from benchmarks.kills import soak

# Separate from the other tests, because it takes several minutes, depending on the machine.
pytestmark = [pytest.mark.benchmark, pytest.mark.pipeline, pytest.mark.ros, pytest.mark.nbgrader]


@pytest.mark.timeout(1800)
def test_five_kills_lose_nothing_double_nothing_and_leave_nothing(tmp_path):
    """Each kill happens at a random moment; ``python -m benchmarks.kills`` kills fifty times."""
    names = ('pass__reference', 'fail__two_hertz', 'error__exception_in_callback')

    account = soak(tmp_path, names, kills=5, seed=5, seconds=5)

    assert account.wrong == []
    assert sum(account.kills.values()) >= 5

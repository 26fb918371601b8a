"""Steps of the probe, taken alone."""

from __future__ import annotations

import subprocess
import sys

import pytest

from autograder.observe import HERE

pytestmark = [pytest.mark.ros]

# The probe hears its own tick, so that waiting for news returns at once; here it always does.
PROGRAM = f"""
import sys
sys.path[:0] = [{str(HERE)!r}, {str(HERE / 'inside')!r}]
from probe_steps import advance

class Probe:
    clock_ns, deaf, student_exited, ticks = None, set(), False, 0
    def emit(self, *_, **__): pass
    def spin(self, seconds): pass
    def tick(self, nanoseconds): self.ticks += 1

probe = Probe()
advance(probe, {{'watch_s': 0.5}}, False)
print(probe.ticks)
"""


def test_a_program_that_keeps_its_own_time_hears_a_hundred_ticks_a_second_at_most():
    """Thousands would cost more of the processor than what is watched."""
    ran = subprocess.run(
        [sys.executable, '-c', PROGRAM], capture_output=True, text=True, check=True, timeout=60
    )

    assert 1 <= int(ran.stdout) <= 50

"""The probe understands its first order however slowly it starts."""

from __future__ import annotations

import json
import os
from pathlib import Path
import subprocess
import sys

import pytest

from autograder import exams
from autograder.runs.observe import HERE, TICK

pytestmark = [pytest.mark.ros]


@pytest.mark.parametrize('said_meanwhile', [b'', TICK * 3])
def test_words_that_follow_the_order_at_once_do_not_hide_it(said_meanwhile: bytes):
    """A busy grader may have ticked before a slow probe reads its order."""
    order = {**exams.load('talker').scenario.to_json(), 'name': 'n1'}
    with subprocess.Popen(
        [sys.executable, str(Path(HERE, 'probe', 'probe.py'))],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, 'PYTHONPATH': f'{HERE}/inside:{os.environ.get("PYTHONPATH", "")}'},
    ) as probe:
        probe.stdin.write(json.dumps(order).encode() + b'\n' + said_meanwhile)
        probe.stdin.flush()
        try:
            assert json.loads(probe.stdout.readline()) == {'event': 'ready'}
        finally:
            probe.kill()

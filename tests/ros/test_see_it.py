"""``see_it.py``: the single command for a first look."""

from contextlib import ExitStack
import os
from pathlib import Path
import re
import subprocess
import sys

from tests.own_domain import own_domain

ROOT = Path(__file__).parents[2]


def test_the_listener_hears_every_message() -> None:
    """The program ends by itself after three messages, each published and received."""
    with ExitStack() as until:
        env = {**os.environ, 'ROS_DOMAIN_ID': str(own_domain(until))}
        command = [sys.executable, 'see_it.py']
        done = subprocess.run(
            command, cwd=ROOT, env=env, capture_output=True, text=True, timeout=60
        )
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert 'Traceback' not in said
    for number in (1, 2, 3):
        assert f'[talker]: publishing: hello {number}' in said
        assert f'[listener]: heard: hello {number}' in said


def test_its_versions_are_those_of_the_course() -> None:
    header = re.search(r'^# dependencies = \[(.+)\]$', (ROOT / 'see_it.py').read_text(), re.M)
    assert header is not None
    wanted = re.findall(r'"([^"]+)"', header[1])
    pinned = (ROOT / 'environment' / 'requirements.in').read_text().splitlines()
    assert wanted
    assert set(wanted) <= set(pinned)

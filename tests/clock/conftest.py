"""Run programs on a virtual clock, without a sandbox."""

import json
import os
from pathlib import Path
import subprocess
import sys

import pytest

from autograder.clock.virtual_clock import virtual_clock

LIMIT_S = 120.0  # of real time; a program takes a fraction of a second


class OnClock:
    """Runs Python programs, each in a place of one virtual clock."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.elapsed_ns = 0

    def __call__(self, *texts: str, python: str = sys.executable) -> list[list]:
        """Return the lines of JSON that each program printed."""
        with virtual_clock(len(texts)) as clock:
            programs = []
            for place, text in enumerate(texts):
                file = self.folder / f'program_{place}.py'
                file.write_text(text, encoding='utf-8')
                programs.append(
                    subprocess.Popen(
                        [python, '-I', str(file)],
                        env={**os.environ, **clock.variables(place)},
                        pass_fds=[clock.places[place].fileno()],
                        stdout=subprocess.PIPE,
                        text=True,
                    )
                )
            clock.begin()
            try:
                said = [program.communicate(timeout=LIMIT_S)[0] for program in programs]
            finally:
                for program in programs:
                    program.kill()
            assert [program.returncode for program in programs] == [0] * len(programs)
            self.elapsed_ns = clock.elapsed_ns
        return [[json.loads(line) for line in text.splitlines()] for text in said]


@pytest.fixture
def on_clock(tmp_path: Path) -> OnClock:
    """Return a function that runs programs on a separate clock."""
    return OnClock(tmp_path)

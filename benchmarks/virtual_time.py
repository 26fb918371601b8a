"""
Measure tests that use ``virtual_time``: how long they take, and whether they ever fail.

The node publishes once per second, and in one version also logs a warning for each reading.
``first`` is the first run of a program, which also finds its topics; ``next`` are further runs of
the same length; ``hour`` is one run of 3600 s.  Then a test that expects a reading and a log line
at each of 60 seconds runs many times, half of them with four busy processes per core.
"""

import argparse
from pathlib import Path
import sys
import tempfile
import time
from typing import Any

from autograder.simulation.virtual_time import run_program
from benchmarks import report

FULL_REPEATS = 300
MINUTES = 15
BUSY_PER_CORE = 4
NODE = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Sensor(Node):
    def __init__(self):
        super().__init__('sensor')
        self.publisher = self.create_publisher(Float64, 'reading', 10)
        self.create_timer(1.0, self.read)

    def read(self):
        self.publisher.publish(Float64(data=31.0))
        {then}


rclpy.init()
rclpy.spin(Sensor())
"""
LOGS = "self.get_logger().warning('Too warm')"


def main() -> int:
    """
    Measure, then print and save the figures.

    :returns: exit code, 1 if a run of the repeated test differed from what it expects
    """
    parser = argparse.ArgumentParser(description=(__doc__ or '').strip().splitlines()[0])
    parser.add_argument('--repeats', type=int, default=FULL_REPEATS, help='runs (default: 300)')
    repeats = parser.parse_args().repeats
    facts = report.machine()
    with tempfile.TemporaryDirectory() as folder:
        quiet, logging = Path(folder, 'quiet.py'), Path(folder, 'logging.py')
        quiet.write_text(NODE.format(then=''), encoding='utf-8')
        logging.write_text(NODE.format(then=LOGS), encoding='utf-8')
        figures: dict[str, Any] = {
            'first_minute_s': report.spread([seconds_of(quiet, 60)]),
            'next_minutes_s': report.spread([seconds_of(quiet, 60) for _ in range(MINUTES)]),
            'hour_s': report.spread([seconds_of(quiet, 3600)]),
            **repeated(logging, repeats),
        }
    report.save('virtual_time', facts, figures, full=repeats >= FULL_REPEATS)
    return int(figures['failed'] > 0)


def seconds_of(program: Path, seconds: int) -> float:
    """
    Return how long a run takes [s].

    :raises AssertionError: if the program did not publish once per second
    """
    began = time.monotonic()
    run = run_program(program, seconds)
    took = time.monotonic() - began
    assert run.times('reading') == list(range(1, seconds + 1)), run
    return took


def repeated(program: Path, repeats: int) -> dict[str, Any]:
    """Run a test of 60 s with and without load; return its durations and failures."""
    half = repeats // 2
    calm = [passes(program) for _ in range(half)]
    with report.busy(BUSY_PER_CORE * report.machine()['cores']):
        loaded = [passes(program) for _ in range(repeats - half)]
        load = report.load()
    return {
        'runs': repeats,
        'failed': sum(not passed for passed, _ in calm + loaded),
        'calm_s': report.spread([took for _, took in calm]),
        'loaded_s': report.spread([took for _, took in loaded]),
        'load': load,
    }


def passes(program: Path) -> tuple[bool, float]:
    """Return whether a reading and a log line arrived in every second, and the duration [s]."""
    began = time.monotonic()
    run = run_program(program, 60)
    took = time.monotonic() - began
    expected = list(range(1, 61))
    came = [run.times('reading'), [line.time_s for line in run.logged('WARN')]]
    return run.reason == 'complete' and came == [expected, expected], took


if __name__ == '__main__':
    sys.exit(main())

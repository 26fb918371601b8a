"""
Drive a student's program from inside the network of its sandbox, and write down what it does.

The probe knows the *scenario* (which topics to watch, what to send, and when) but no expected
value.  It reads one JSON line from standard input, runs the scenario, and writes one JSON event
per line to standard output; :mod:`autograder.recording` documents the events.  It runs as a
separate process, confined and disposable, because it parses whatever the student's code sends.

This file and the other ``probe_*.py`` import nothing from this project except each other: only
their text enters the probe's sandbox.
"""

from __future__ import annotations

import gc
import json
import os
import sys

sys.path.append(os.path.join(os.path.dirname(sys.path[0]), 'inside'))
gc.disable()  # all that is loaded stays
# ruff: noqa: E402

from lean_start import lean  # type: ignore[import-not-found]  # of the programs in the sandbox

lean()  # before anything of ROS

import probe_loopback  # type: ignore[import-not-found]  # beside this file
from probe_run import Probe  # type: ignore[import-not-found]


def main() -> None:
    """Read the scenario, say that we are ready, wait for the start, run, and leave at once."""
    gc.freeze()
    gc.enable()
    probe_loopback.wait()
    scenario = b''
    while not scenario.endswith(b'\n'):
        said = os.read(0, 1 << 16)
        if not said:
            return  # the grader is gone, and nobody wants to know
        scenario += said
    probe = Probe(json.loads(scenario))
    probe.write({'event': 'ready'})
    # Not a wait on the virtual clock: time stands still until the student's program is let go.
    if os.readv(0, [bytearray(1)]) == 1:
        probe.run()
    probe.output.flush()
    os._exit(0)


if __name__ == '__main__':
    main()

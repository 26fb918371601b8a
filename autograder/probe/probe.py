"""
Run scenarios inside the networks of students' sandboxes, and record what the programs do.

This program loads rclpy once, and then forks a probe for each run, with
:mod:`autograder.inside.forks`.  A probe receives the *scenario* (which topics to watch, what to
send, and when) but no expected values.  It reads one JSON line from standard input, runs the
scenario, and writes one JSON event per line to standard output; ``docs/recording.schema.json``
documents the events.  It is a separate, confined process, because it parses messages that
untrusted code sends.

The files of the probe import nothing from this project except each other and ``inside/``, because
the probe's sandbox contains no other file of the grader.
"""

import gc
import json
import os
import sys

sys.path.append(os.path.join(os.path.dirname(sys.path[0]), 'inside'))
gc.disable()  # imported modules are never garbage
# ruff: noqa: E402

from rclpy_patches import use_lazy_imports  # type: ignore[import-not-found]  # in inside/

use_lazy_imports()  # before the first import of a ROS package

import forks  # type: ignore[import-not-found]  # in inside/
from probe_run import Probe  # type: ignore[import-not-found]  # next to this file
from probe_wire import load_type  # type: ignore[import-not-found]

EVERY_RUN = ('rcl_interfaces/msg/Log', 'rcl_interfaces/srv/GetParameters', 'std_msgs/msg/String')
"""Message types that every probe needs."""


def main() -> None:
    """Load what every probe needs, fork on request, and run a scenario in each fork."""
    for name in EVERY_RUN:
        load_type(name).__class__.__import_type_support__()
    gc.freeze()  # a garbage collection in a fork would copy the memory pages that it visits
    forks.serve()
    code = 1
    try:
        gc.enable()
        run_scenario()
        code = 0
    except BaseException as error:  # noqa: BLE001 - skip Python's slow shutdown
        os.write(2, f'{type(error).__name__}: {error}\n'.encode(errors='replace'))
    finally:
        os._exit(code)


def run_scenario() -> None:
    """Read the scenario, write ``ready``, wait for the start, and run."""
    scenario = b''
    while not scenario.endswith(b'\n'):
        said = os.read(0, 1 << 16)
        if not said:
            return  # the grader has closed its end of the socket
        scenario += said
    probe = Probe(json.loads(scenario))
    probe.write({'event': 'ready'})
    # These reads bypass the virtual clock.  It stands still until the program is released, and
    # again from the end of the scenario until the grader has recorded what still runs.
    if os.readv(0, [bytearray(1)]) == 1:
        probe.run()
        os.readv(0, [bytearray(1)])


if __name__ == '__main__':
    main()

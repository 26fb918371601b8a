"""
Run a scenario inside the network of a student's sandbox, and record what the program does.

The probe receives the *scenario* (which topics to watch, what to send, and when) but no expected
values.  It reads one JSON line from standard input, runs the scenario, and writes one JSON event
per line to standard output; :mod:`autograder.recording` documents the events.  It is a separate,
confined process, because it parses messages that untrusted code sends.

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

from lazy_imports import use_lazy_imports  # type: ignore[import-not-found]  # in inside/

use_lazy_imports()  # before the first import of a ROS package

from probe_run import Probe  # type: ignore[import-not-found]  # next to this file


def main() -> None:
    """Read the scenario, write ``ready``, wait for the start, run, and exit without clean-up."""
    gc.freeze()
    gc.enable()
    scenario = b''
    while not scenario.endswith(b'\n'):
        said = os.read(0, 1 << 16)
        if not said:
            return  # the grader has closed its end of the pipe
        scenario += said
    probe = Probe(json.loads(scenario))
    probe.write({'event': 'ready'})
    # These reads bypass the virtual clock.  It stands still until the program is released, and
    # again from the end of the scenario until the grader has recorded what still runs.
    if os.readv(0, [bytearray(1)]) == 1:
        probe.run()
        os.readv(0, [bytearray(1)])
    os._exit(0)


if __name__ == '__main__':
    main()

"""Run the ``ros2`` command, as ``python -m roslab.ros2`` or by running this file."""

import signal

if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    # Ctrl-C during the imports ends the command without a traceback; cli.main() undoes this.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])  # blocked by bin/ros2

import os
from pathlib import Path
import sys
from types import ModuleType

if not __package__:
    # bin/ros2 runs this file directly, to skip the package's __init__: the notebook part of roslab
    # takes as long to import as everything else here.
    _FOLDER = Path(__file__).resolve().parent.parent
    sys.path[0] = str(_FOLDER.parent)
    _parent = ModuleType('roslab')
    _parent.__path__ = [str(_FOLDER)]
    sys.modules['roslab'] = _parent

from roslab.ros2.cli import run_command

if __name__ == '__main__':
    try:
        run_command(sys.argv[1:])
    except SystemExit as end:
        # Exit at once: everything is closed, and the threads of Fast DDS would delay the exit by
        # 0.1 s.
        sys.stderr.flush()
        os._exit(end.code if isinstance(end.code, int) else 0)

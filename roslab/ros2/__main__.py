"""Start the ``ros2`` command: ``python -m roslab.ros2``, or this file itself."""

from __future__ import annotations

import os
from pathlib import Path
import sys
from types import ModuleType

if not __package__:
    # Run as a file, as bin/ros2 does: the notebook half of roslab would take as long to import
    # as everything else here, so the package is entered without its __init__.
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
        # The threads of Fast DDS hold up an ordinary end by 0.1 s, and all is closed by now.
        sys.stderr.flush()
        os._exit(end.code if isinstance(end.code, int) else 0)

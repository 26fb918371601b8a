"""
Ask a student's check about recorded runs, which come on ``/runs``; answer on ``/answers``.

Usage: run_node.py ask_check.py WIRE SIMULATED CHECK.  WIRE and SIMULATED are the grader's
``probe_wire.py`` and ``simulated.py``, which make the objects that the check gets, CHECK is the
student's file.  The messages do not say which runs are right: the grader compares the answers
outside.
"""

from __future__ import annotations

from collections.abc import Callable
import importlib
import importlib.util
import json
from pathlib import Path
import sys
import traceback
from types import ModuleType

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


def load(name: str, path: Path) -> ModuleType:
    """Return a module from its file; Landlock opens the file, and no folder above it."""
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def answer_of(answer: object) -> str:
    """Return an answer as text: ``'True'``, ``'False'``, or the type of anything else."""
    return str(answer) if isinstance(answer, bool) else type(answer).__name__


def ask(accepts: Callable[[object], object], run: object) -> str:
    """Return the answer for a run as text; for an exception, ``'exception'`` and its traceback."""
    try:
        return answer_of(accepts(run))
    except Exception:  # whatever a student's check raises; the next run may have an answer
        traceback.print_exc()
        return 'exception'


def main() -> None:
    """Answer until the sandbox ends."""
    wire, simulated, check = map(Path, sys.argv[1:4])
    load('autograder.probe.probe_wire', wire)
    simulation = load('autograder.simulated', simulated).Simulation
    sys.path.insert(0, str(check.parent))
    accepts = importlib.import_module(check.stem).accepts
    rclpy.init(args=[])
    node = Node('check')
    publisher = node.create_publisher(String, '/answers', 10)

    def take(message: String) -> None:
        run = simulation.from_json(json.loads(message.data))
        publisher.publish(String(data=ask(accepts, run)))

    node.create_subscription(String, '/runs', take, 10)
    rclpy.spin(node)


if __name__ == '__main__':
    main()

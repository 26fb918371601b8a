"""
Call a student's check with generated runs from ``/runs``, and publish its answers on ``/answers``.

Usage: run_node.py ask_check.py WIRE SIMULATED CHECK.  WIRE and SIMULATED are the grader's
``probe_wire.py`` and ``simulated.py``, which create the objects that the check receives.  CHECK is
the student's file.  The messages do not contain the correct answers; the grader compares the
answers outside the sandbox.
"""

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
    """Load a module directly from its file, because Landlock hides the folder around it."""
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def answer_of(answer: object) -> str:
    """Return a check's answer as a string: ``'True'``, ``'False'``, or the name of its type."""
    return str(answer) if isinstance(answer, bool) else type(answer).__name__


def ask(accepts: Callable[[object], object], run: object) -> str:
    """Return a check's answer for a run as a string; print the traceback of an exception."""
    try:
        return answer_of(accepts(run))
    except Exception:  # a check may raise anything, and may still answer for the next run
        traceback.print_exc()
        return 'exception'


def main() -> None:
    """Answer messages until the sandbox is stopped."""
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

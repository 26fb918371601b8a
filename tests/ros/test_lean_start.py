"""A lean start postpones the import of numpy until a program uses it."""

from __future__ import annotations

from pathlib import Path
import subprocess
import sys

import pytest

from autograder.runs.observe import HERE

pytestmark = [pytest.mark.ros]

LEAN = f'import sys\nsys.path.insert(0, {str(Path(HERE, "inside"))!r})\n'
LEAN += 'from lean_start import lean\nlean()\n'


def said(program: str) -> str:
    """Return the output of a program with a lean start."""
    command = [sys.executable, '-c', LEAN + program]
    ran = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    return ran.stdout.strip()


def test_a_node_needs_neither_numpy_nor_the_parser_of_the_generator():
    """Importing them takes two thirds of the start of rclpy."""
    program = """
import rclpy
rclpy.init()
node = rclpy.create_node('lean')
print([name for name in ('numpy._core', 'lark', 'rosidl_parser.parser') if name in sys.modules])
node.destroy_node()
rclpy.shutdown()
"""
    assert said(program) == '[]'


@pytest.mark.parametrize(
    'use',
    [
        'import numpy\nprint(numpy.zeros(3).sum())',
        'import numpy as np\nprint(np.zeros(3).sum())',
        'from numpy import zeros\nprint(zeros(3).sum())',
        'import numpy.linalg\nprint(numpy.linalg.norm(numpy.zeros(3)))',
    ],
)
def test_numpy_is_there_for_whoever_uses_it(use: str):
    """Every form of import works."""
    assert said(use) == '0.0'


def test_it_is_the_real_one_from_then_on():
    """Names bound before and after the real import refer to the same numpy."""
    program = """
import numpy as early
early.pi
import numpy as late
print(early.ndarray is late.ndarray, isinstance(late.zeros(1), early.ndarray))
"""
    assert said(program) == 'True True'


def test_threads_that_come_together_see_all_of_it():
    """Callbacks in several threads may use numpy first at the same time."""
    program = """
import threading
import numpy
gate, found = threading.Barrier(8), []
def use():
    gate.wait()
    found.append(numpy.linalg.norm(numpy.ones(4)))
threads = [threading.Thread(target=use) for _ in range(8)]
[one.start() for one in threads]
[one.join() for one in threads]
print(len(found), set(map(float, found)))
"""
    assert said(program) == '8 {2.0}'


def test_messages_with_arrays_work():
    """Message classes store numbers in numpy arrays."""
    program = """
from service_msgs.msg import ServiceEventInfo
from std_msgs.msg import Float64MultiArray
event = ServiceEventInfo()
event.client_gid = [1] * 16
print(type(event.client_gid).__name__, event.client_gid.sum())
print(Float64MultiArray(data=[1.5]).data[0])
"""
    assert said(program) == 'ndarray 16\n1.5'


def test_a_library_that_looks_for_numpy_finds_it():
    """The search does not load numpy."""
    program = """
import importlib.util
print(importlib.util.find_spec('numpy').name, 'numpy._core' in sys.modules)
"""
    assert said(program) == 'numpy False'


def test_a_program_that_asks_for_something_unknown_hears_so():
    """An unknown attribute raises AttributeError, as with the real numpy."""
    program = """
import numpy
try:
    numpy.nonsense
except AttributeError as error:
    print(error)
"""
    assert 'nonsense' in said(program)

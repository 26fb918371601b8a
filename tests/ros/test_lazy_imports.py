"""A lean start postpones the import of numpy until a program uses it."""

from pathlib import Path
import subprocess
import sys

import pytest

from autograder.sandboxes.sandbox import HERE

pytestmark = [pytest.mark.ros]

PREPARED = f'import sys\nsys.path.insert(0, {str(Path(HERE, "inside"))!r})\n'
PREPARED += 'from rclpy_patches import use_lazy_imports\nuse_lazy_imports()\n'


def said(program: str) -> str:
    command = [sys.executable, '-c', PREPARED + program]
    ran = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    return ran.stdout.strip()


PROGRAMS = {
    # These imports take two thirds of the start-up time of rclpy.
    'a node needs neither numpy nor the parser of the generator': (
        """
import rclpy
rclpy.init()
node = rclpy.create_node('lean')
print([name for name in ('numpy._core', 'lark', 'rosidl_parser.parser') if name in sys.modules])
node.destroy_node()
rclpy.shutdown()
""",
        '[]',
    ),
    'import numpy': ('import numpy\nprint(numpy.zeros(3).sum())', '0.0'),
    'import numpy as np': ('import numpy as np\nprint(np.zeros(3).sum())', '0.0'),
    'from numpy import zeros': ('from numpy import zeros\nprint(zeros(3).sum())', '0.0'),
    'import numpy.linalg': (
        'import numpy.linalg\nprint(numpy.linalg.norm(numpy.zeros(3)))',
        '0.0',
    ),
    'there is one numpy': (
        """
import numpy as early
early.pi
import numpy as late
print(early.ndarray is late.ndarray, isinstance(late.zeros(1), early.ndarray))
""",
        'True True',
    ),
    'several threads are the first to use it': (
        """
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
""",
        '8 {2.0}',
    ),
    'classes of messages hold numbers in arrays of numpy': (
        """
from service_msgs.msg import ServiceEventInfo
from std_msgs.msg import Float64MultiArray
event = ServiceEventInfo()
event.client_gid = [1] * 16
print(type(event.client_gid).__name__, event.client_gid.sum())
print(Float64MultiArray(data=[1.5]).data[0])
""",
        'ndarray 16\n1.5',
    ),
    'a library looks for numpy': (
        """
import importlib.util
print(importlib.util.find_spec('numpy').name, 'numpy._core' in sys.modules)
""",
        'numpy False',
    ),
    'what numpy lacks is an error': (
        """
import numpy
try:
    numpy.nonsense
except AttributeError as error:
    print('nonsense' in str(error))
""",
        'True',
    ),
}


@pytest.mark.parametrize('name', PROGRAMS)
def test_lean_program_prints_what_another_one_would(name: str):
    program, printed = PROGRAMS[name]

    assert said(program) == printed

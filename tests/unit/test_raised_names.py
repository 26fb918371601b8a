"""Names that Python does not find are told with where they come from."""

from __future__ import annotations

import pytest

from autograder.judging import raised_names
from autograder.judging.raised import exception_cause
from autograder.judging.tracebacks import Traceback
import roslab


def at(line, error, above=''):
    """Return how an error is explained that comes from a line below others."""
    source = f'{above}{line}\n'
    return exception_cause(Traceback(error, 'talker.py', source.count('\n'), line, source))


@pytest.mark.parametrize(
    ('line', 'said', 'words'),
    [
        ('class Talker(Node):', "name 'Node' is not defined", 'from rclpy.node import Node'),
        ('math.isnan(x)', "name 'math' is not defined", 'import math'),
        ('np.mean(x)', "name 'np' is not defined", 'import numpy as np'),
        (
            'sys.exit(1)',
            "name 'sys' is not defined. Did you forget to import 'sys'?",
            'import sys',
        ),
        ('sys.exit(1)', "name 'sys' is not defined", 'import sys'),
        (
            'time.time()',
            "name 'time' is not defined. Did you mean: 'Time'? Or did you forget to import "
            "'time'?",
            'import time',
        ),
        ('sleep(1.0)', "name 'sleep' is not defined", 'from time import sleep'),
        ('datetime.now()', "name 'datetime' is not defined", 'from datetime import datetime'),
        ('datetime.datetime.now()', "name 'datetime' is not defined", 'import datetime'),
        ('Time(sec=1)', "name 'Time' is not defined", 'from builtin_interfaces.msg import Time'),
        ('Time(seconds=1)', "name 'Time' is not defined", 'from rclpy.time import Time'),
    ],
)
def test_the_import_that_is_missing_is_written_out(line, said, words):
    """The repair is the line to write, and why the import of another cell does not help."""
    found = at(line, f'NameError: {said}')

    assert found.cause_id == 'missing_import'
    assert found.try_this.endswith(f'Write at the top: {words}')
    assert 'stands alone' in found.try_this


def test_both_times_are_named_where_the_line_does_not_tell():
    """One is a message, one is for calculating."""
    found = at('stamp = Time()', "NameError: name 'Time' is not defined")

    assert 'from builtin_interfaces.msg import Time' in found.try_this
    assert 'from rclpy.time import Time' in found.try_this


MAIN = 'class Talker:\n    def main(self):\n        node = 1\n'


@pytest.mark.parametrize(
    ('line', 'said', 'above', 'words'),
    [
        (
            'Temperatur()',
            "name 'Temperatur' is not defined. Did you mean: 'Temperature'?",
            '',
            'Did you mean Temperature?',
        ),
        (
            'publisher.publish(m)',
            "name 'publisher' is not defined. Did you mean: 'self.publisher'?",
            '',
            'Did you mean self.publisher?',
        ),
        ('main()', "name 'main' is not defined. Did you mean: 'min'?", MAIN, 'indented into the'),
        ('main()', "name 'main' is not defined. Did you mean: 'min'?", '', 'Write def main'),
        ('main()', "name 'main' is not defined", 'def main(args=None):\n', 'the very end'),
        ('x = node.name', "name 'node' is not defined. Did you mean: 'Node'?", MAIN, 'self.node'),
        ("start('talker')", "name 'start' is not defined", '', 'belongs to the notebook'),
        (
            'print(code)',
            "name 'code' is not defined. Did you forget to import 'code'?",
            '',
            'Is it a module?',
        ),
        ('print(limit)', "name 'limit' is not defined", '', 'stands alone'),
        ('self.x = 1', "name 'self' is not defined", '', 'Only a method has it'),
    ],
)
def test_a_name_that_nothing_made_is_told_with_what_it_may_be(line, said, above, words):
    """Python's suggestion is passed on, unless the code tells better."""
    found = at(line, f'NameError: {said}', above)

    assert found.cause_id == 'unknown_name'
    assert words in found.try_this


@pytest.mark.parametrize(
    ('said', 'cause_id', 'words'),
    [
        (
            "cannot import name 'Node' from 'rclpy'. Did you mean: 'node'?",
            'import',
            'Write: from rclpy.node import Node',
        ),
        (
            "cannot import name 'String' from 'std_msgs'",
            'import',
            'Write: from std_msgs.msg import String',
        ),
        (
            "cannot import name 'Pose' from 'geometry_msgs'",
            'import',
            'from geometry_msgs.msg import Pose',
        ),
        (
            "cannot import name 'Temperature' from 'temp_monitor_pkg.msg'",
            'import',
            'build_messages()',
        ),
        (
            "cannot import name 'QosProfile' from 'rclpy.qos'. Did you mean: 'QoSProfile'?",
            'import',
            'Did you mean QoSProfile?',
        ),
        ("cannot import name 'QosProfile' from 'rclpy.qos'", 'import', 'help(rclpy.qos)'),
        ("No module named 'rospy'", 'ros_1', 'here it is rclpy'),
        ("No module named 'rclpy.nodes'", 'import', 'Did you mean rclpy.node?'),
        ("No module named 'std_msg'", 'import', 'Did you mean std_msgs?'),
        (
            "No module named 'temp_monitor_pkg.msgs'",
            'import',
            'Did you mean temp_monitor_pkg.msg?',
        ),
        ("No module named 'pandas'", 'import', 'not installed'),
        ("No module named 'temp_monitor_pkg'", 'message_not_built', 'build_messages()'),
    ],
)
def test_an_import_is_told_with_the_one_to_write(said, cause_id, words):
    """A name that is spelled right needs no look at its spelling."""
    kind = 'ModuleNotFoundError' if said.startswith('No') else 'ImportError'

    found = at('import x', f'{kind}: {said}')

    assert found.cause_id == cause_id
    assert words in found.try_this
    assert 'line 2 of the cell' in found.text


def test_a_name_behind_the_wrong_module_is_told_with_its_own():
    """Rclpy has nodes, but not under that name."""
    found = at('rclpy.Node', "AttributeError: module 'rclpy' has no attribute 'Node'")

    assert found.cause_id == 'import'
    assert 'from rclpy.node import Node' in found.try_this


def test_tools_of_the_notebook_are_those_of_roslab():
    """A tool of another name would be taken for a slip."""
    assert set(raised_names.NOTEBOOK.split()) <= set(roslab.__all__)

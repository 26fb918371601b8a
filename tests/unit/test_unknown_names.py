"""Feedback on an undefined name says where the name may come from."""

import pytest

from autograder.judging.causes import unknown_names as raised_names
from autograder.judging.causes.exceptions import exception_cause
from autograder.judging.causes.tracebacks import Traceback
import roslab


def at(line, error, above=''):
    """Return the explanation of an error in a line that follows other lines."""
    source = f'{above}{line}\n'
    return exception_cause(Traceback(error, source.count('\n'), line, source))


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
    ],
)
def test_the_import_that_is_missing_is_written_out(line, said, words):
    found = at(line, f'NameError: {said}')

    assert found.cause_id == 'missing_import'
    assert found.try_this.endswith(f'Write at the top: {words}')
    assert 'separate file' in found.try_this


@pytest.mark.parametrize(
    ('name', 'lines'),
    [
        ('Time', ['from builtin_interfaces.msg import Time', 'from rclpy.time import Time']),
        ('datetime', ['import datetime, for datetime.datetime', 'from datetime import datetime']),
    ],
)
def test_name_with_two_origins_is_reported_with_both(name, lines):
    found = at(f'stamp = {name}()', f"NameError: name '{name}' is not defined")

    assert all(line in found.try_this for line in lines)


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
        ('main()', "name 'main' is not defined. Did you mean: 'min'?", MAIN, 'at the left margin'),
        ('main()', "name 'main' is not defined. Did you mean: 'min'?", '', 'Write def main'),
        (
            'main()',
            "name 'main' is not defined",
            'def main(args=None):\n',
            'above the lines that call',
        ),
        ('x = node.name', "name 'node' is not defined. Did you mean: 'Node'?", MAIN, 'self.node'),
        ("start('talker')", "name 'start' is not defined", '', 'works only in the notebook'),
        (
            'print(code)',
            "name 'code' is not defined. Did you forget to import 'code'?",
            '',
            'spelled as in its definition',
        ),
        ('print(limit)', "name 'limit' is not defined", '', 'separate file'),
        ('self.x = 1', "name 'self' is not defined", '', 'Only methods have self'),
    ],
)
def test_a_name_that_nothing_made_is_reported_with_what_it_may_be(line, said, above, words):
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
        ("No module named 'rospy'", 'ros_1', 'In ROS 2, write import rclpy'),
        ("No module named 'station_interfaces'", 'message_not_built', 'build_messages()'),
        ("No module named 'rclpy.nodes'", 'import', 'Did you mean rclpy.node?'),
        ("No module named 'std_msg'", 'import', 'Did you mean std_msgs?'),
        (
            "No module named 'temp_monitor_pkg.msgs'",
            'import',
            'Did you mean temp_monitor_pkg.msg?',
        ),
        ("No module named 'pandas'", 'import', 'Is the module installed?'),
        ("No module named 'tmie'", 'import', 'Did you mean time?'),
        ("No module named 'nunpy'", 'import', 'Did you mean numpy?'),
        ("No module named 'temp_monitor_pkg.tresholds'", 'import', 'Check the spelling'),
        ("No module named 'weather_msgs.msg'", 'message_not_built', 'build_messages()'),
        ("No module named 'geometry_msg'", 'import', 'Did you mean geometry_msgs?'),
        ("No module named 'geometry_msgs'", 'message_not_built', 'environment/messages.txt'),
        ("No module named 'toy_srvs'", 'message_not_built', 'environment/messages.txt'),
        ("No module named 'temp_monitor_pkg'", 'message_not_built', 'build_messages()'),
    ],
)
def test_an_import_is_reported_with_the_one_to_write(said, cause_id, words):
    kind = 'ModuleNotFoundError' if said.startswith('No') else 'ImportError'

    found = at('import x', f'{kind}: {said}')

    assert found.cause_id == cause_id
    assert words in found.try_this
    assert found.line == 1


def test_a_name_behind_the_wrong_module_is_reported_with_its_own():
    found = at('rclpy.Node', "AttributeError: module 'rclpy' has no attribute 'Node'")

    assert found.cause_id == 'import'
    assert 'from rclpy.node import Node' in found.try_this


def test_tools_of_the_notebook_are_those_of_roslab():
    """A renamed tool of roslab would be reported as a typo."""
    assert set(raised_names.NOTEBOOK.split()) <= set(roslab.__all__)


NO_NAME = "TypeError: Node.__init__() missing 1 required positional argument: 'node_name'"


@pytest.mark.parametrize(
    ('above', 'error', 'cause_id'),
    [
        ('class T(Node):\n    def _init_(self):\n        pass\n', NO_NAME, 'init_name'),
        ('class T(Node):\n    def __int__(self):\n        pass\n', NO_NAME, 'init_name'),
        ('class T(Node):\n    def __init__(self):\n        pass\n', NO_NAME, 'no_super_init'),
        ('class T(Node):\n    def speak(self):\n        pass\n', NO_NAME, 'no_super_init'),
        (
            'class T:\n    def _init_(self, a):\n        pass\n',
            'T() takes no arguments',
            'init_name',
        ),
        ('class T(Node):\n    pass\n', "'super' object has no attribute '_init_'", 'init_name'),
    ],
)
def test_other_underscores_than_those_of_init_are_named(above, error, cause_id):
    kind = '' if error == NO_NAME else 'TypeError: ' if 'takes' in error else 'AttributeError: '
    found = at('T(1)', kind + error, above)

    assert found.cause_id == cause_id


@pytest.mark.parametrize(
    ('line', 'cause_id'),
    [
        ('!pip install numpy', 'notebook_line'),
        ('%matplotlib inline', 'notebook_line'),
        ('%%time', 'notebook_line'),
        ('% number', 'syntax'),
        ('%self.count', 'syntax'),
        ('%time)', 'syntax'),
    ],
)
def test_lines_of_notebooks_are_distinguished_from_slips(line, cause_id):
    """A line may begin with a percent sign because the bracket above it is missing."""
    assert at(line, 'SyntaxError: invalid syntax').cause_id == cause_id


def test_module_of_the_notebook_is_not_said_to_be_misspelled():
    found = at('from roslab import start', "ModuleNotFoundError: No module named 'roslab'")

    assert 'works only in the notebook' in found.text
    assert 'spelling' not in found.try_this


@pytest.mark.parametrize(('owner', 'cause_id'), [('Talker', 'spins_no_node'), ('NoneType', 'no_')])
def test_node_that_is_to_spin_itself_is_told_the_function(owner, cause_id):
    found = at('node.spin()', f"AttributeError: '{owner}' object has no attribute 'spin'")

    assert found.cause_id.startswith(cause_id)

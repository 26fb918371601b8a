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


def undefined(name, hint=''):
    """Return Python's message about a name, with what it adds if it has a suggestion."""
    return f"name '{name}' is not defined{hint and f'. {hint}'}"


@pytest.mark.parametrize(
    ('line', 'name', 'hint', 'words'),
    [
        ('class Talker(Node):', 'Node', '', 'from rclpy.node import Node'),
        ('math.isnan(x)', 'math', '', 'import math'),
        ('np.mean(x)', 'np', '', 'import numpy as np'),
        ('sys.exit(1)', 'sys', "Did you forget to import 'sys'?", 'import sys'),
        ('sys.exit(1)', 'sys', '', 'import sys'),
        (
            *('time.time()', 'time'),
            "Did you mean: 'Time'? Or did you forget to import 'time'?",
            'import time',
        ),
        ('sleep(1.0)', 'sleep', '', 'from time import sleep'),
    ],
)
def test_the_import_that_is_missing_is_written_out(line, name, hint, words):
    found = at(line, f'NameError: {undefined(name, hint)}')

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
    found = at(f'stamp = {name}()', f'NameError: {undefined(name)}')

    assert all(line in found.try_this for line in lines)


FORGOT = "Did you forget to import 'code'?"
MAIN = 'class Talker:\n    def main(self):\n        node = 1\n'


@pytest.mark.parametrize(
    ('line', 'name', 'hint', 'above', 'words'),
    [
        ('Temperatur()', 'Temperatur', 'Temperature', '', 'Did you mean Temperature?'),
        ('publisher.go()', 'publisher', 'self.publisher', '', 'Did you mean self.publisher?'),
        ('main()', 'main', 'min', MAIN, 'at the left margin'),
        ('main()', 'main', 'min', '', 'Write def main'),
        ('main()', 'main', '', 'def main(args=None):\n', 'above the lines that call'),
        ('x = node.name', 'node', 'Node', MAIN, 'self.node'),
        ("start('talker')", 'start', '', '', 'works only in the notebook'),
        ('print(code)', 'code', FORGOT, '', 'spelled as in its definition'),
        ('print(limit)', 'limit', '', '', 'separate file'),
        ('self.x = 1', 'self', '', '', 'Only methods have self'),
    ],
)
def test_a_name_that_nothing_made_is_reported_with_what_it_may_be(line, name, hint, above, words):
    hint = hint if hint in ('', FORGOT) else f"Did you mean: '{hint}'?"

    found = at(line, f'NameError: {undefined(name, hint)}', above)

    assert found.cause_id == 'unknown_name'
    assert words in found.try_this


@pytest.mark.parametrize(
    ('said', 'words'),
    [
        ("'Node' from 'rclpy'. Did you mean: 'node'?", 'Write: from rclpy.node import Node'),
        ("'String' from 'std_msgs'", 'Write: from std_msgs.msg import String'),
        ("'Pose' from 'geometry_msgs'", 'from geometry_msgs.msg import Pose'),
        ("'Temperature' from 'temp_monitor_pkg.msg'", 'build_messages()'),
        ("'QosProfile' from 'rclpy.qos'. Did you mean: 'QoSProfile'?", 'Did you mean QoSProfile?'),
        ("'QosProfile' from 'rclpy.qos'", 'help(rclpy.qos)'),
    ],
)
def test_a_name_that_a_module_lacks_is_reported_with_the_import_to_write(said, words):
    found = at('import x', f'ImportError: cannot import name {said}')

    assert (found.cause_id, found.line) == ('import', 1)
    assert words in found.try_this


@pytest.mark.parametrize(
    ('name', 'cause_id', 'words'),
    [
        ('rospy', 'ros_1', 'In ROS 2, write import rclpy'),
        ('station_interfaces', 'message_not_built', 'build_messages()'),
        ('rclpy.nodes', 'import', 'Did you mean rclpy.node?'),
        ('std_msg', 'import', 'Did you mean std_msgs?'),
        ('temp_monitor_pkg.msgs', 'import', 'Did you mean temp_monitor_pkg.msg?'),
        ('pandas', 'import', 'Is the module installed?'),
        ('tmie', 'import', 'Did you mean time?'),
        ('nunpy', 'import', 'Did you mean numpy?'),
        ('temp_monitor_pkg.tresholds', 'import', 'Check the spelling'),
        ('weather_msgs.msg', 'message_not_built', 'build_messages()'),
        ('geometry_msg', 'import', 'Did you mean geometry_msgs?'),
        ('geometry_msgs', 'message_not_built', 'environment/messages.txt'),
        ('toy_srvs', 'message_not_built', 'environment/messages.txt'),
        ('temp_monitor_pkg', 'message_not_built', 'build_messages()'),
    ],
)
def test_a_missing_module_is_reported_with_the_import_to_write(name, cause_id, words):
    found = at('import x', f"ModuleNotFoundError: No module named '{name}'")

    assert (found.cause_id, found.line) == (cause_id, 1)
    assert words in found.try_this


def test_a_name_behind_the_wrong_module_is_reported_with_its_own():
    found = at('rclpy.Node', "AttributeError: module 'rclpy' has no attribute 'Node'")

    assert found.cause_id == 'import'
    assert 'from rclpy.node import Node' in found.try_this


def test_tools_of_the_notebook_are_those_of_roslab():
    """A renamed tool of roslab would be reported as a typo."""
    assert set(raised_names.NOTEBOOK.split()) <= set(roslab.__all__)


NO_NAME = "TypeError: Node.__init__() missing 1 required positional argument: 'node_name'"
NO_INIT = "AttributeError: 'super' object has no attribute '_init_'"


@pytest.mark.parametrize(
    ('name', 'method', 'error', 'cause_id'),
    [
        ('T(Node)', '_init_(self)', NO_NAME, 'init_name'),
        ('T(Node)', '__int__(self)', NO_NAME, 'init_name'),
        ('T(Node)', '__init__(self)', NO_NAME, 'no_super_init'),
        ('T(Node)', 'speak(self)', NO_NAME, 'no_super_init'),
        ('T', '_init_(self, a)', 'TypeError: T() takes no arguments', 'init_name'),
        ('T(Node)', 'speak(self)', NO_INIT, 'init_name'),
    ],
)
def test_other_underscores_than_those_of_init_are_named(name, method, error, cause_id):
    above = f'class {name}:\n    def {method}:\n        pass\n'

    assert at('T(1)', error, above).cause_id == cause_id


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

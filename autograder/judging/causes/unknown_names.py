"""
Explain names that Python does not find: where they come from, and what to write.

Python's suggestions are used too.  Python 3.10 and 3.11 make fewer of them, so the tables come
first.
"""

from collections.abc import Mapping
import difflib
import re
import sys

from autograder.exam.exam import Cause
from autograder.exam.scenario import Names
from autograder.judging.causes.text_table import cause_of
from autograder.judging.causes.tracebacks import Traceback
from autograder.layout import Layout

_NAME = re.compile(r"name '(\w{1,60})' is not defined")
_MEANT = re.compile(r"Did you mean: '([\w.]{1,60})'")
_FROM = re.compile(r"cannot import name '(?P<name>\w{1,60})' from .*?'(?P<module>[\w.]{1,80})'")
_BEHIND = re.compile(r"module '(?P<module>[\w.]{1,80})' has no attribute '(?P<name>\w{1,60})'")
_MODULE = re.compile(r"No module named '([\w.]{1,80})'")
_INIT = re.compile(r'\bdef (_{0,3}[Ii]ni?t_{0,3})\(')
_NO_INIT = re.compile(r"Node\.__init__\(\) missing .*'node_name'|\b\w+\(\) takes no arguments")
_PARENTS = re.compile(r"'super' object has no attribute '(_{0,3}[Ii]ni?t_{0,3})'")
_PACKAGE = re.compile(r'\w+(?:_interfaces|_msgs|_srvs|_pkg)')
_MESSAGES = re.compile(rf'{_PACKAGE.pattern}(?:\.(?:msg|srv|action))?|\w+\.(?:msg|srv|action)')

HOMES = {
    'rclpy.node': 'Node',
    'rclpy.lifecycle': 'LifecycleNode TransitionCallbackReturn',
    'rclpy.executors': 'SingleThreadedExecutor MultiThreadedExecutor ExternalShutdownException',
    'rclpy.qos': 'QoSProfile ReliabilityPolicy DurabilityPolicy HistoryPolicy LivelinessPolicy',
    'rclpy.duration': 'Duration',
    'rclpy.event_handler': 'SubscriptionEventCallbacks PublisherEventCallbacks',
    'std_msgs.msg': 'String Float64 Float32 Int32 Bool',
    'geometry_msgs.msg': 'Twist TwistStamped Point Pose PoseStamped Quaternion Vector3',
    'sensor_msgs.msg': 'LaserScan Imu Image BatteryState Range JointState',
    'nav_msgs.msg': 'Odometry OccupancyGrid',
    'std_srvs.srv': 'SetBool Trigger',
    'time': 'sleep',
    'math': 'isnan sqrt sin cos pi',
    'random': 'randint uniform',
    'collections': 'deque',
    'threading': 'Thread',
    'functools': 'partial',
    'dataclasses': 'dataclass',
    'pathlib': 'Path',
}
"""Names from the lessons, common messages and everyday Python, by module."""


def homes(names: Names) -> Mapping[str, str]:
    """Return the module of each name in the exam, the lessons or the course's messages."""
    found: dict[str, str] = {}
    for module, known in (*names.homes.items(), *HOMES.items()):
        for name in known.split():
            found.setdefault(name, module)
    for one in Layout.here().facts.messages:
        package, kind, name = one.split('/')
        found.setdefault(name, f'{package}.{kind}')
    return found


IMPORTS = {
    'np': 'import numpy as np',
    'rclpy': 'import rclpy',
    'datetime': 'import datetime, for datetime.datetime.now(); or from datetime import datetime, '
    'for datetime.now()',
    'Time': 'from builtin_interfaces.msg import Time, for the stamp of a message; or from '
    'rclpy.time import Time, to calculate with times',
}
"""Import lines of names that are in a different module, or in more than one."""

INSTALLED = (*(one for one in sorted(sys.stdlib_module_names) if one[0] != '_'), 'numpy')
"""Modules that are always installed together with rclpy."""

NOTEBOOK = (
    'build_messages echo explain graph hz info listen logs nodes plot qos_table quiz start stop '
    'stop_all timeline topics wait_until'
)
"""Functions that roslab adds to a notebook."""

ALONE = 'Each %%node cell is a separate file, without the imports and names of other cells.'


def import_cause(trace: Traceback) -> Cause | None:
    """Explain a module that is not found, or a name that is imported from the wrong module."""
    if missing := _MODULE.search(trace.error):
        return _module_cause(trace, missing[1])
    found = _FROM.search(trace.error) or _BEHIND.search(trace.error)
    name, module = found.group('name', 'module') if found else ('', '')
    home = homes(trace.names).get(name)
    if not home and trace.kind != 'ImportError':
        return None
    if not found:
        return cause_of('import_fails', error=trace.error)
    if home == module:
        advice = 'Build your own message first: build_messages().'
    elif home:
        advice = f'Write: from {home} import {name}, and use {name} without a prefix.'
    elif _PACKAGE.fullmatch(module):
        advice = f'Message classes are in the submodule msg: from {module}.msg import {name}'
    elif meant := _MEANT.search(trace.error):
        advice = f'Did you mean {meant[1]}? Upper and lower case matter.'
    else:
        advice = f'Check the spelling of the name; help({module}) lists its names.'
    return cause_of('not_in_module', module=module, missing=name, advice=advice)


def _module_cause(trace: Traceback, module: str) -> Cause:
    """Explain a module or package that does not exist."""
    known = set(homes(trace.names).values())
    packages = (*known, *(home.partition('.')[0] for home in known), 'builtin_interfaces.msg')
    near = difflib.get_close_matches(module, packages, 1, 0.8)
    messages = _MESSAGES.fullmatch(module)
    if not near and not messages:
        alike = [one for one in INSTALLED if one[0] == module[0]]
        near = difflib.get_close_matches(module, alike, 1, 0.75)
    if messages and near in ([], [module]):
        return cause_of('message_not_built', error=trace.error)
    advice = 'Check the spelling. Is the module installed? The lessons need only Python and ROS 2.'
    if near and near[0] != module:
        advice = f'Did you mean {near[0]}? Check the spelling.'
    return cause_of('no_module', module=module, advice=advice)


def name_cause(trace: Traceback) -> Cause | None:
    """Explain a name that the code does not define."""
    found = _NAME.search(trace.error)
    if trace.kind != 'NameError' or found is None:
        return None
    name = found[1]
    if line := _import_line(name, trace):
        return cause_of('never_imported', unknown=name, alone=ALONE, import_line=line)
    return cause_of('unknown_name', unknown=name, advice=_how_to_define(name, trace))


def _import_line(name: str, trace: Traceback) -> str:
    """Return the import line for a name, empty if no module is known for it."""
    if name in IMPORTS:
        return IMPORTS[name]
    if home := homes(trace.names).get(name):
        return f'from {home} import {name}'
    # Many modules have names that variables have too, such as code or string, so require a use as
    # a module.
    used = name in sys.stdlib_module_names and re.search(rf'\b{name}\.\w', trace.bare_code)
    return f'import {name}' if used else ''


def _how_to_define(name: str, trace: Traceback) -> str:
    """Return advice for a name that is in no known module."""
    if name == 'self':
        return 'Only methods have self, as their first argument: indent the line below its def.'
    if name == 'main':
        return 'Write def main(args=None): at the left margin, above the lines that call it.'
    if name in NOTEBOOK.split() and f'{name}(' in trace.bare_code:
        return f'{name}() works only in the notebook, not in a node: leave it out here.'
    if re.search(rf'^[ \t]+{name}\s*=(?!=)', trace.bare, re.MULTILINE):
        return (
            f'{name} is defined inside a def and exists only there: pass it as an argument, or '
            f'use self.{name} in both places.'
        )
    if meant := _MEANT.search(trace.error):
        return f'Did you mean {meant[1]}? Otherwise define {name} first, with the same spelling.'
    return f'Is {name} spelled as in its definition? For an attribute, write self.{name}. {ALONE}'


def init_cause(trace: Traceback) -> Cause | None:
    """Explain an __init__() method whose name is misspelt."""
    found = _PARENTS.search(trace.error)
    if _NO_INIT.search(trace.error) and 'def __init__(' not in trace.bare:
        found = _INIT.search(trace.bare)
    return cause_of('init_name', method=found[1]) if found else None

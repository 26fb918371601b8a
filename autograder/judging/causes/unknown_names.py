"""
Names that Python does not find, at an import or in a line: where they come from, what to write.

Python's own suggestions are passed on; 3.10 and 3.11 make fewer of them, so the tables go first.
"""

from __future__ import annotations

from collections.abc import Mapping
import difflib
import re
import sys

from autograder.exam.exam import Cause
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
_LOCAL = re.compile(r"^UnboundLocalError: .*local variable '(\w{1,60})'")
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
}
"""Where the names of the lessons, and of the most used messages, come from."""


def homes() -> Mapping[str, str]:
    """Return where names come from, those of the course's own messages too: module -> names."""
    own: dict[str, str] = {}
    for one in Layout.here().facts.messages:
        package, kind, name = one.split('/')
        own[f'{package}.{kind}'] = f'{own.get(f"{package}.{kind}", "")} {name}'.strip()
    return {**HOMES, **own}


OTHER_HOMES = {
    'time': 'sleep',
    'math': 'isnan sqrt sin cos pi',
    'random': 'randint uniform',
    'collections': 'deque',
    'threading': 'Thread',
    'functools': 'partial',
    'dataclasses': 'dataclass',
    'pathlib': 'Path',
}
"""Where names come from that the lessons do not need and learners know."""

ALIASES = {'np': 'import numpy as np'}
MODULES = ('rclpy', 'math', 'random', 'time')
INSTALLED = (*(one for one in sorted(sys.stdlib_module_names) if one[0] != '_'), 'numpy')
"""Modules that are there wherever rclpy is."""

USES = (
    ('datetime', r'\bdatetime\.datetime\b', 'import datetime'),
    ('datetime', r'\bdatetime\.\w', 'from datetime import datetime'),
    ('Time', r'\bTime\((?:seconds|nanoseconds)=|\bTime\.from_msg', 'from rclpy.time import Time'),
    ('Time', r'\bTime\((?:sec|nanosec)=', 'from builtin_interfaces.msg import Time'),
    (
        'Time',
        '',
        'from builtin_interfaces.msg import Time, for the stamp of a message; or from rclpy.time '
        'import Time, to calculate with times',
    ),
)
"""Names of more than one origin: the name, how the line uses it, and what to write."""

NOTEBOOK = (
    'build_messages echo explain graph hz info listen logs nodes plot qos_table quiz start stop '
    'stop_all timeline topics wait_until'
)
"""What roslab brings into a notebook."""

ALONE = 'Each %%node cell or file stands alone: what others import or define is not in it.'


def import_cause(trace: Traceback) -> Cause | None:
    """Explain a module that is not found, or a name that is looked for in another than its own."""
    if missing := _MODULE.search(trace.error):
        return _module_cause(trace, missing[1])
    found = _FROM.search(trace.error) or _BEHIND.search(trace.error)
    name, module = found.group('name', 'module') if found else ('', '')
    home = _home(name, trace.names.homes, homes())
    text = f'{name} is not in {module}, where it is looked for{trace.where}.'
    if home == module != '':
        return Cause(
            'import', text, 'A message of your own has to be built first: build_messages().'
        )
    if home:
        return Cause('import', text, f'Write: from {home} import {name}, and below {name} alone.')
    if trace.kind != 'ImportError':
        return None
    text = f'An import fails{trace.where}: {trace.error.partition(". Did you mean")[0]}'
    if _PACKAGE.fullmatch(module):
        advice = f'Messages are one level below: from {module}.msg import {name}'
    elif meant := _MEANT.search(trace.error):
        advice = f'Did you mean {meant[1]}? Large and small letters count.'
    elif found:
        advice = f'Check the spelling of the name; help({module}) lists what it has.'
    else:
        advice = 'Check the spelling of the package and of the name.'
    return Cause('import', text, advice)


def _module_cause(trace: Traceback, module: str) -> Cause:
    """Explain a module or package that is not there."""
    known = homes()
    packages = (*trace.names.homes, *known, *(home.partition('.')[0] for home in known))
    near = difflib.get_close_matches(module, (*packages, 'builtin_interfaces.msg'), 1, 0.8)
    messages = _MESSAGES.fullmatch(module)
    if not near and not messages:
        alike = [one for one in INSTALLED if one[0] == module[0]]
        near = difflib.get_close_matches(module, alike, 1, 0.75)
    if messages and near in ([], [module]):
        return Cause(
            'message_not_built',
            f'There is no message package of that name{trace.where}: {trace.error}',
            'Is it the package of the table, spelled as there? Build your own package first with '
            'build_messages(). Packages of others are installed if environment/messages.txt '
            'names them.',
        )
    return Cause(
        'import',
        f'There is no module {module}, which is imported{trace.where}.',
        f'Did you mean {near[0]}? Check the spelling.'
        if near and near[0] != module
        else 'Check the spelling. Or is it not installed? The lessons need only Python and ROS 2.',
    )


def name_cause(trace: Traceback) -> Cause | None:
    """Explain a name that nobody has defined."""
    found = _NAME.search(trace.error)
    if trace.kind != 'NameError' or found is None:
        return None
    name = found[1]
    line = _import_line(name, trace)
    if line:
        return Cause(
            'missing_import',
            f'The name {name} is used{trace.where} and never imported.',
            f'{ALONE} Write at the top: {line}',
        )
    return Cause(
        'unknown_name',
        f'The name {name} is used{trace.where} and is not known there.',
        _main_advice(trace.bare) if name == 'main' else _how_to_make(name, trace),
    )


def _import_line(name: str, trace: Traceback) -> str:
    """Return the import that brings a name, as far as its use in a line tells; or nothing."""
    for one, use, line in USES:
        if one == name and re.search(use, trace.bare_code):
            return line
    if home := _home(name, trace.names.homes, homes(), OTHER_HOMES):
        return f'from {home} import {name}'
    # Half the modules of Python have names that variables have too, such as code or string.
    as_module = name in sys.stdlib_module_names and re.search(rf'\b{name}\.\w', trace.bare_code)
    if name in MODULES or as_module:
        return f'import {name}'
    return ALIASES.get(name, '')


def _home(name: str, *tables: Mapping[str, str]) -> str:
    """Return the module that a name comes from, or nothing."""
    pairs = (pair for homes in tables for pair in homes.items())
    return next((home for home, names in pairs if name in names.split()), '')


def _main_advice(source: str) -> str:
    """Tell why the last lines of a program do not find main()."""
    if re.search(r'^(?:async )?def main\b', source, re.MULTILINE):
        return 'It is called above its def line: the call belongs at the very end.'
    if re.search(r'^[ \t]+(?:async )?def main\b', source, re.MULTILINE):
        return 'Is def main indented into the class? It has to begin at the left margin.'
    return 'Write def main(args=None): at the left margin, above the lines that call it.'


def _how_to_make(name: str, trace: Traceback) -> str:
    """Tell what a name that nothing has made is likely to be."""
    meant = _MEANT.search(trace.error)
    if name == 'self':
        return 'Only a method has it, as its first argument, and further right than its def.'
    if name in NOTEBOOK.split() and f'{name}(' in trace.bare_code:
        return f'{name}() belongs to the notebook, and is not there for a node: leave it out here.'
    if meant and meant[1].startswith('self.'):
        return f'Did you mean {meant[1]}? What belongs to the node has self. in front.'
    if re.search(rf'^[ \t]+{name}\s*=(?!=)', trace.bare, re.MULTILINE):
        return (
            f'It is made inside a def and known only there: hand it on as an argument, or keep it '
            f'as self.{name} in both places.'
        )
    if meant:
        return f'Did you mean {meant[1]}? Otherwise make it first, with the same spelling.'
    if name in sys.stdlib_module_names:
        return f'Is it a module? Then write at the top: import {name}. Else make it first.'
    return f'Is it spelled as where it is made? What belongs to the node is self.{name}. {ALONE}'


def init_cause(trace: Traceback) -> Cause | None:
    """Explain a class whose __init__() is written with other underscores or letters."""
    found = _PARENTS.search(trace.error)
    if _NO_INIT.search(trace.error) and 'def __init__(' not in trace.bare:
        found = _INIT.search(trace.bare)
    if found is None:
        return None
    return Cause(
        'init_name',
        f'Your code has {found[1]}(), and Python calls __init__() only, so it is not what it is '
        'meant to be.',
        'Write __init__, small letters between two underscores on each side, wherever it stands.',
    )


def local_cause(trace: Traceback) -> Cause | None:
    """Explain a name that a def assigns to, and that it uses before."""
    found = _LOCAL.search(trace.error)
    if found is None:
        return None
    name = found[1]
    kept = 'A name that a def assigns to is its own: '
    again = rf'\b{name}\s*(?:[-+*/%|&]|//|\*\*)=|\b{name}\s*=[^=\n][^\n]*\b{name}\b'
    if not re.search(again, trace.bare):
        advice = (
            f'Give {name} a value on every way to that line: above the if, or below an else too.'
        )
    elif re.search(r'\bself\b', trace.bare):
        advice = f'{kept}keep it as self.{name}, with self. everywhere.'
    else:
        advice = (
            f'{kept}make it above the def, and write as its first line global {name}, or, inside '
            f'another def, nonlocal {name}.'
        )
    return Cause(
        'local_name', f'{name} is used before this def has given it a value{trace.where}.', advice
    )

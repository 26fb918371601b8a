"""
Find mistakes in the code of a student: log calls that skip lines, other loggers, pauses.

As in :mod:`.source_code`, the results affect only messages.
"""

import ast
from collections.abc import Collection, Mapping
from itertools import takewhile

from autograder.submission.code.program import last_name
from autograder.submission.code.source_code import Code

SHORT_S = 0.1
"""Calls to ``sleep`` for less than this time [s] are ignored."""
_OTHERS = (ast.While, ast.Await)
_OF_PYTHON = ('logging', 'getLogger')
_LEAVE_OUT = ('throttle_duration_sec', 'once', 'skip_first')


def leaves_out(files: Mapping[str, str], level: str, lines: Collection[int] = ()) -> str:
    """
    Return the argument that makes log calls in callbacks skip lines; empty if one logs every line.

    :param level: the log calls, such as ``warning``
    :param lines: consider only calls in these lines; empty for all calls
    """
    code = Code(files)
    made = [one for one in code.calls_to(level) if code.is_working(one)]
    found = [_leaves_out(call) for call in made if not lines or call.lineno in lines]
    return found[0] if found and all(found) else ''


def _leaves_out(call: ast.Call) -> str:
    """Return the argument that makes a log call skip lines; False, 0 and None have no effect."""
    given = (one for one in call.keywords if one.arg in _LEAVE_OUT)
    return next((one.arg or '' for one in given if getattr(one.value, 'value', True)), '')


def logs_with_python(files: Mapping[str, str], level: str) -> bool:
    """Return whether all log calls such as ``warning`` use Python's module ``logging``."""
    code = Code(files)
    given = [one.func.value for one in code.calls_to(level) if isinstance(one.func, ast.Attribute)]
    loggers = [getattr(one, 'func', one) for one in map(code.origin, given)]
    imported = (one for node in code.nodes if isinstance(node, ast.Import) for one in node.names)
    names = {*_OF_PYTHON, *(one.asname for one in imported if one.name == 'logging')}
    return bool(loggers) and all(last_name(one) in names for one in loggers)


def pause_in_callback(files: Mapping[str, str]) -> tuple[str, int] | None:
    """
    Return the first pause in a callback or in a function that it calls; None if there is none.

    ``await asyncio.sleep()`` does not count, because it does not block.  A pause in a ``while``
    loop does not count either, because the loop itself is the cause.

    :returns: name of the callback, empty for a lambda; and line of the pause, from 1
    """
    code = Code(files)
    for name, body in code.callbacks():
        if found := _pauses(code, body):
            return name, min(found)
    return None


def _pauses(code: Code, body: ast.AST) -> list[int]:
    """Return the lines of the pauses in a function."""
    found = []
    for call in ast.walk(body):
        if isinstance(call, ast.Call) and last_name(call.func) == 'sleep':
            seconds = code.number(call.args[0]) if call.args else None
            waits = seconds is None or seconds >= SHORT_S
            inside = takewhile(lambda one: one is not body, code.around(call))
            if waits and not any(isinstance(one, _OTHERS) for one in inside):
                found.append(call.lineno)
    return found

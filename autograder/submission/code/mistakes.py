"""
Find mistakes in the code of a student: log calls that skip lines, pauses, unset fields.

As in :mod:`.source_code`, the results affect only messages.
"""

import ast
from collections.abc import Collection, Iterator, Mapping
from itertools import takewhile

from autograder.submission.code.program import all_arguments, is_stored, last_name
from autograder.submission.code.source_code import Code

SHORT_S = 0.1
"""Calls to ``sleep`` for less than this time [s] are ignored."""
_OTHERS = (ast.While, ast.Await)
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
    """
    Return whether all log calls of a level use Python's module ``logging``.

    :param level: the log calls, such as ``warning``
    """
    each = (Code({name: text}) for name, text in files.items())
    found = [one for code in each for one in _are_of_python(code, level)]
    return bool(found) and all(found)


def _are_of_python(code: Code, level: str) -> Iterator[bool]:
    """Yield, for each log call of one file, whether it uses the module ``logging``."""
    theirs = set(_logging_names(code)) - {''}  # '' is for targets without a name: items[0]
    for call in code.calls_to(level):
        if isinstance(call.func, ast.Attribute):
            by = call.func.value
            yield _is_get_logger(by) or last_name(by) in theirs


def _logging_names(code: Code) -> Iterator[str]:
    """Yield the names of the module ``logging`` and of its loggers."""
    for node in code.nodes:
        if isinstance(node, ast.Import):
            yield from (one.asname or one.name for one in node.names if one.name == 'logging')
        if isinstance(node, ast.Assign) and _is_get_logger(node.value):
            yield from map(last_name, node.targets)


def _is_get_logger(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and last_name(node.func) == 'getLogger'


def use_of_field(files: Mapping[str, str], field: str) -> str:
    """
    Return how code uses a field of a message, whose value may be missing.

    :param field: name of the field, such as ``timestamp``
    :returns: ``'given'`` if the code has an attribute, keyword argument or string with its name;
        ``'empty'`` if one of its values is a call to ``Time`` without arguments; ``'local'`` if
        only a variable has its name; ``'unused'`` otherwise
    """
    code = Code(files)
    values = list(code.given(field))
    named = [one for one in code.nodes if last_name(one) == field]
    if any(map(_is_empty_time, values)):
        return 'empty'
    # A name in quotes may be an argument of setattr(), or a key in a dictionary of fields.
    if values or field in code.texts or any(isinstance(one, ast.Attribute) for one in named):
        return 'given'
    return 'local' if any(map(is_stored, named)) else 'unused'


def _is_empty_time(value: ast.AST) -> bool:
    """Return whether a value contains ``Time()``, as in ``Time().to_msg()``."""
    calls = (one for one in ast.walk(value) if isinstance(one, ast.Call))
    return any(last_name(one.func) == 'Time' and not all_arguments(one) for one in calls)


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

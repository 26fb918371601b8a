"""
Find mistakes in student code: log calls that skip lines, pauses, unset fields.

As in :mod:`.learners_code`, the code is never run, and the results affect only messages.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from autograder.submission.code.learners_code import Code
from autograder.submission.code.program import last_name, Program

SHORT_S = 0.1
"""Calls of ``sleep`` for less than this time [s] are ignored."""
_LEAVE_OUT = ('throttle_duration_sec', 'once', 'skip_first')


def leaves_out(files: Mapping[str, str], level: str, lines: Collection[int] = ()) -> str:
    """
    Return the argument with which all log calls in callbacks skip lines; empty if one does not.

    :param level: the log calls, such as ``warning``
    :param lines: consider only calls in these lines; empty for all calls
    """
    programs = Code(files).programs
    made = (one for code in programs for one in code.calls(level) if code.is_working(one))
    found = [_leaves_out(call) for call in made if not lines or call.lineno in lines]
    return found[0] if found and all(found) else ''


def _leaves_out(call: ast.Call) -> str:
    """Return the argument with which a log call skips lines; False, 0 and None skip none."""
    for one in call.keywords:
        off = isinstance(one.value, ast.Constant) and not one.value.value
        if one.arg in _LEAVE_OUT and not off:
            return one.arg
    return ''


def logs_with_python(files: Mapping[str, str], level: str) -> bool:
    """
    Return whether all log calls of a level use Python's module ``logging``.

    :param level: the log calls, such as ``warning``
    """
    found: list[bool] = []
    for program in Code(files).programs:
        theirs = set(_logging_names(program)) - {''}  # '' is for targets without a name: items[0]
        for call in program.calls(level):
            if isinstance(call.func, ast.Attribute):
                by = call.func.value
                made = isinstance(by, ast.Call) and last_name(by.func) == 'getLogger'
                found.append(made or last_name(by) in theirs)
    return bool(found) and all(found)


def _logging_names(program: Program) -> Iterator[str]:
    """Yield the names in a file for the module ``logging`` and for its loggers."""
    for node in program.nodes:
        if isinstance(node, ast.Import):
            yield from (one.asname or one.name for one in node.names if one.name == 'logging')
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
            made = last_name(node.value.func) == 'getLogger'
            yield from map(last_name, node.targets if made else ())


@dataclass(frozen=True)
class FieldUse:
    """
    How code uses a field of a message.

    :param given: whether the field may get a value: the code has an attribute, keyword argument
        or string with its name
    :param empty: whether one of the assigned values is a call of ``Time`` without arguments
    :param local: whether a variable with the field's name is assigned
    """

    given: bool
    empty: bool
    local: bool


def use_of_field(files: Mapping[str, str], field: str) -> FieldUse:
    """
    Return how code uses a field of a message.

    :param field: name of the field, such as ``timestamp``
    """
    nodes = Code(files).nodes
    values = [one.value for one in nodes if isinstance(one, ast.keyword) and one.arg == field]
    for node in nodes:
        if isinstance(node, ast.Assign):
            values += [node.value for target in node.targets if _reaches(target, field)]
    # A name in quotes may be an argument of setattr(), or a key in a dictionary of fields.
    named = any(isinstance(node, ast.Constant) and node.value == field for node in nodes)
    read = any(isinstance(node, ast.Attribute) and node.attr == field for node in nodes)
    stored = (node for node in nodes if isinstance(node, ast.Name) and node.id == field)
    return FieldUse(
        bool(values) or named or read,
        any(map(_is_empty_time, values)),
        any(isinstance(node.ctx, ast.Store) for node in stored),
    )


def _reaches(target: ast.AST, field: str) -> bool:
    """Return whether an assignment's target is a field or a part of the field."""
    return any(isinstance(one, ast.Attribute) and one.attr == field for one in ast.walk(target))


def _is_empty_time(value: ast.AST) -> bool:
    """Return whether a value contains ``Time()``, as in ``Time().to_msg()``."""
    made = [one for one in ast.walk(value) if last_name(one) == 'Time']
    return bool(made) and any(
        isinstance(one, ast.Call) and one.func in made and not one.args and not one.keywords
        for one in ast.walk(value)
    )


@dataclass(frozen=True)
class Pause:
    """
    A call of ``sleep`` that a callback reaches.

    :param callback: name of the callback, empty for a lambda
    :param line: line of the call in the file, from 1
    """

    callback: str
    line: int


def pause_in_callback(files: Mapping[str, str]) -> Pause | None:
    """
    Return the first pause in a callback or in a function that it calls; None if there is none.

    ``await asyncio.sleep()`` does not count, because it does not block.  A pause in a ``while``
    loop does not count either, because the loop itself is the cause.
    """
    for program in Code(files).programs:
        for name, body in program.callbacks():
            if line := _pause(body):
                return Pause(name, line)
    return None


def _pause(body: ast.AST) -> int | None:
    """Return the line of the first pause in a function, None if there is none."""
    others = {
        id(inner)
        for node in ast.walk(body)
        if isinstance(node, (ast.Await, ast.While))
        for inner in ([node.value] if isinstance(node, ast.Await) else ast.walk(node))
    }
    found = [
        node.lineno
        for node in ast.walk(body)
        if isinstance(node, ast.Call)
        and last_name(node.func) == 'sleep'
        and id(node) not in others
        and not _is_short(node)
    ]
    return min(found, default=None)


def _is_short(call: ast.Call) -> bool:
    """Return whether a pause is certainly too short to matter."""
    value = call.args[0].value if call.args and isinstance(call.args[0], ast.Constant) else None
    return isinstance(value, (int, float)) and value < SHORT_S

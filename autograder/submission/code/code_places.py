"""
Find calls inside the callbacks of student code: log calls that skip lines, and fixed seeds.

As in :mod:`.learners_code`, the code is never run, and the results affect only messages.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterator, Mapping

from autograder.submission.code.learners_code import (
    bodies_of_callbacks,
    followed,
    last_name,
    trees,
    values_by_name,
)

_LEAVE_OUT = ('throttle_duration_sec', 'once', 'skip_first')
_SEEDS = ('seed', 'Random', 'RandomState', 'default_rng')


def leaves_out(
    files: Mapping[str, str], names: Collection[str], lines: Collection[int] = ()
) -> str:
    """
    Return the argument with which all log calls in callbacks skip lines; empty if one does not.

    :param names: names of the log calls, such as ``warn`` and ``warning``
    :param lines: consider only calls in these lines; empty for all calls
    """
    made = (call for tree in trees(files) for call in _calls_in_callbacks(tree, names))
    found = [_leaves_out(call) for call in made if not lines or call.lineno in lines]
    return found[0] if found and all(found) else ''


def _leaves_out(call: ast.Call) -> str:
    """Return the argument with which a log call skips lines; False, 0 and None skip none."""
    for one in call.keywords:
        off = isinstance(one.value, ast.Constant) and not one.value.value
        if one.arg in _LEAVE_OUT and not off:
            return one.arg
    return ''


def logs_with_python(files: Mapping[str, str], names: Collection[str]) -> bool:
    """
    Return whether all log calls of a level use Python's module ``logging``.

    :param names: names of the log calls, such as ``warn`` and ``warning``
    """
    found: list[bool] = []
    for tree in trees(files):
        theirs = set(_logging_names(tree)) - {''}  # '' is for targets without a name: items[0]
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                by = node.func.value
                made = isinstance(by, ast.Call) and last_name(by.func) == 'getLogger'
                if node.func.attr in names:
                    found.append(made or last_name(by) in theirs)
    return bool(found) and all(found)


def _logging_names(tree: ast.Module) -> Iterator[str]:
    """Yield the names in a file for the module ``logging`` and for its loggers."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (one.asname or one.name for one in node.names if one.name == 'logging')
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
            made = last_name(node.value.func) == 'getLogger'
            yield from map(last_name, node.targets if made else ())


def seed_in_callback(files: Mapping[str, str]) -> str:
    """Return the function that seeds random numbers with a constant in a callback, or ''."""
    for tree in trees(files):
        known = values_by_name(tree)
        for call in _calls_in_callbacks(tree, _SEEDS):
            if call.args and isinstance(followed(call.args[0], known), ast.Constant):
                return last_name(call.func)
    return ''


def _calls_in_callbacks(tree: ast.Module, names: Collection[str]) -> Iterator[ast.Call]:
    for _, body in bodies_of_callbacks(tree):
        for one in ast.walk(body):
            if isinstance(one, ast.Call) and last_name(one.func) in names:
                yield one

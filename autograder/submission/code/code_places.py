"""
Where in a learner's code something stands: in what is called again, or in a function around it.

Read as Python and never run, as in :mod:`.learners_code`: it decides words, not verdicts.
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
    Return the argument with which every log call of a level leaves lines out, or nothing.

    :param names: of the calls, such as ``warn`` and ``warning``; those of callbacks count
    :param lines: only calls in these lines, if there are any
    """
    made = (call for tree in trees(files) for call in _calls_in_callbacks(tree, names))
    found = [_leaves_out(call) for call in made if not lines or call.lineno in lines]
    return found[0] if found and all(found) else ''


def _leaves_out(call: ast.Call) -> str:
    """Return the argument with which a log call leaves lines out; False, 0 and None do not."""
    for one in call.keywords:
        off = isinstance(one.value, ast.Constant) and not one.value.value
        if one.arg in _LEAVE_OUT and not off:
            return one.arg
    return ''


def logs_with_python(files: Mapping[str, str], names: Collection[str]) -> bool:
    """
    Return whether all log calls of a level go to Python's own module ``logging``.

    :param names: of the calls, such as ``warn`` and ``warning``
    """
    found: list[bool] = []
    for tree in trees(files):
        theirs = set(_logging_names(tree)) - {''}  # of what is no name, as an item of a list
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                by = node.func.value
                made = isinstance(by, ast.Call) and last_name(by.func) == 'getLogger'
                if node.func.attr in names:
                    found.append(made or last_name(by) in theirs)
    return bool(found) and all(found)


def _logging_names(tree: ast.Module) -> Iterator[str]:
    """Yield what a file calls the module ``logging`` and the loggers that it has from it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (one.asname or one.name for one in node.names if one.name == 'logging')
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
            made = last_name(node.value.func) == 'getLogger'
            yield from map(last_name, node.targets if made else ())


def seed_in_callback(files: Mapping[str, str]) -> str:
    """Return what seeds random numbers with a constant in a function that is called again."""
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

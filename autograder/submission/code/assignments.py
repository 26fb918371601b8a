"""Find the statements that set names and attributes: counts, resets, longer pauses."""

import ast
from collections.abc import Iterator

from autograder.submission.code.program import all_arguments, assigned, last_name, names_in
from autograder.submission.code.source_code import Code

_CONDITIONS = (ast.Compare, ast.BoolOp, ast.UnaryOp, ast.If, ast.IfExp, ast.While)
_WAITS = ('create_timer', 'Timer', 'sleep')


def _changes(code: Code) -> Iterator[tuple[ast.AST, str, ast.AST]]:
    """Yield the statements that compute a new value from the old one: its name, and the change."""
    for node in code.nodes:
        if isinstance(node, ast.AugAssign):
            yield node, last_name(node.target), node.value
        if isinstance(node, ast.Assign):
            name = last_name(node.targets[0])
            sums = (one for one in ast.walk(node.value) if isinstance(one, ast.BinOp))
            yield from ((node, name, one.right) for one in sums if name in names_in(one))


def counts(code: Code) -> Iterator[ast.AST]:
    """Yield the statements that add 1 to a name or an attribute."""
    return (node for node, _, change in _changes(code) if _is_one(change))


def _is_one(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and node.value == 1


def _counted(code: Code) -> set[str]:
    """Return the names that count something."""
    return {name for _, name, change in _changes(code) if name and _is_one(change)}


def recounts(code: Code) -> Iterator[ast.AST]:
    """Yield the statements outside ``__init__`` that reset a count."""
    counted = _counted(code)
    return (node for node, target, _ in _fixed(code) if last_name(target) in counted)


def compared_counts(code: Code) -> Iterator[ast.AST]:
    """Yield the comparisons of a count."""
    counted = _counted(code)
    compared = (one for one in code.nodes if isinstance(one, ast.Compare))
    return (one for one in compared if counted & names_in(one))


def wrapped_counts(code: Code) -> Iterator[ast.AST]:
    """Yield the modulo operations on a count, except those in conditions."""
    counted = _counted(code)
    for node in code.operations(ast.Mod):
        left = getattr(node, 'left', None) or getattr(node, 'target', None)
        if left and counted & names_in(left) and not isinstance(code.parents[node], _CONDITIONS):
            yield node


def longer_pauses(code: Code) -> Iterator[ast.AST]:
    """Yield the statements that change the period of a timer or a pause, as ``+=`` does."""
    given = {last_name(one) for name in _WAITS for one in code.arguments(name, 0)} - {''}
    return (node for node, name, _ in _changes(code) if name in given)


def resets(code: Code) -> Iterator[ast.AST]:
    """Yield the statements outside ``__init__`` that set an attribute to a fixed value."""
    return (node for node, _, _ in _fixed(code))


def set_back(code: Code) -> Iterator[ast.AST]:
    """Yield the statements that give an attribute its first value again."""
    for node, target, value in _fixed(code):
        given = (one for one in code.values_of(target) if one and not _is_later(code, one))
        if any(_is_fixed(one) and ast.dump(one) == ast.dump(value) for one in given):
            yield node


def _fixed(code: Code) -> Iterator[tuple[ast.AST, ast.AST, ast.AST]]:
    """Yield each statement of :func:`resets` with its attribute and value."""
    for node in code.nodes:
        for target, value in assigned(node):
            kept = isinstance(target, ast.Attribute) and value and _is_fixed(value)
            if kept and value and _is_later(code, node):
                yield node, target, value


def _is_fixed(value: ast.AST) -> bool:
    """Return whether a value is fixed: it does not depend on other values."""
    if isinstance(value, ast.Call):
        return not all_arguments(value) and isinstance(value.func, ast.Name)
    if isinstance(value, (ast.List, ast.Tuple, ast.Set)):
        return not value.elts
    return isinstance(value, ast.Constant) or (isinstance(value, ast.Dict) and not value.keys)


def _is_later(code: Code, node: ast.AST) -> bool:
    """Return whether a statement is in a function other than ``__init__``."""
    inner = code.function_around(node)
    return inner is not None and inner.name != '__init__'

"""Find the statements that set names and attributes: counts, flags, values kept or lost."""

import ast
from collections import Counter
from collections.abc import Iterator

from autograder.submission.code.program import (
    all_arguments,
    assigned,
    last_name,
    names_in,
    Program,
)

_WAITS = ('create_timer', 'Timer', 'sleep')


def counts(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that add 1 to a name or an attribute."""
    for node in program.nodes:
        if isinstance(node, ast.AugAssign) and _is_one(node.value):
            yield node
        if isinstance(node, ast.Assign) and last_name(node.targets[0]) in names_in(node.value):
            sums = (one for one in ast.walk(node.value) if isinstance(one, ast.BinOp))
            if any(_is_one(one.right) for one in sums):
                yield node


def _is_one(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and node.value == 1


def _counted(program: Program) -> set[str]:
    """Return the names that count something."""
    return {last_name(target) for one in counts(program) for target, _ in assigned(one)} - {''}


def recounts(program: Program) -> Iterator[ast.AST]:
    """Yield the statements outside ``__init__`` that reset a count."""
    counted = _counted(program)
    return (node for node, target, _ in _fixed(program) if last_name(target) in counted)


def compared_counts(program: Program) -> Iterator[ast.AST]:
    """Yield the comparisons of a count."""
    counted = _counted(program)
    compared = (one for one in program.nodes if isinstance(one, ast.Compare))
    return (one for one in compared if counted & names_in(one))


def wrapped_counts(program: Program) -> Iterator[ast.AST]:
    """Yield the modulo operations on a count, except those in conditions."""
    counted = _counted(program)
    tests = {getattr(one, 'test', None) for one in program.nodes}
    for node in program.operations(ast.Mod):
        whole = (node, *program.around(node))
        asked = any(isinstance(one, ast.Compare) or one in tests for one in whole)
        left = getattr(node, 'left', None) or getattr(node, 'target', None)
        if left and not asked and counted & names_in(left):
            yield node


def stored(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that set an attribute of the object itself."""
    for node in program.nodes:
        if any(ast.unparse(target).startswith('self.') for target, _ in assigned(node)):
            yield node


def kept_first(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that set an attribute only if it has no value yet, with ``or``."""
    for node in stored(program):
        for target, value in assigned(node):
            if isinstance(value, ast.BoolOp) and last_name(target) in names_in(value):
                yield node


def kept_messages(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that store a message for later and replace the previous one."""
    for body in program.reached(program.passed('create_subscription')):
        given = {one.arg for one in ast.walk(body) if isinstance(one, ast.arg)} - {'self'}
        for node in ast.walk(body):
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Attribute):
                uses = [bool(given & names_in(one, ast.Name)) for one in (node.targets[0], node)]
                if uses == [False, True]:
                    yield node


def forgotten(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that set an attribute to None although nothing destroys its object."""
    destroyed = {
        name
        for one in program.nodes
        if isinstance(one, ast.Call) and last_name(one.func).startswith('destroy')
        for given in (one.func, *one.args)
        for name in names_in(given)
    }
    for node, target, value in _fixed(program):
        if getattr(value, 'value', 0) is None and last_name(target) not in destroyed:
            yield node


def stuck(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that set a flag which nothing outside ``__init__`` resets."""
    later = (one for one in stored(program) if _is_later(program, one))
    often = Counter(last_name(target) for one in later for target, _ in assigned(one))
    for node, target, value in _fixed(program):
        if isinstance(getattr(value, 'value', 0), bool) and often[last_name(target)] == 1:
            yield node


def resets(program: Program) -> Iterator[ast.AST]:
    """Yield the statements outside ``__init__`` that set an attribute to a fixed value."""
    return (node for node, _, _ in _fixed(program))


def set_back(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that give an attribute its first value again."""
    for node, target, value in _fixed(program):
        given = program.values.get((None, ast.unparse(target)), ())
        first = (one for one in given if one and not _is_later(program, one))
        if any(ast.dump(one) == ast.dump(value) for one in first):
            yield node


def _fixed(program: Program) -> Iterator[tuple[ast.AST, ast.AST, ast.AST]]:
    """Yield each statement of :func:`resets` with its attribute and value."""
    for node in program.nodes:
        for target, value in assigned(node):
            kept = isinstance(target, ast.Attribute) and value and _is_fixed(value)
            if kept and value and _is_later(program, node):
                yield node, target, value


def _is_fixed(value: ast.AST) -> bool:
    """Return whether a value is fixed: it does not depend on other values."""
    if isinstance(value, ast.Call):
        return not all_arguments(value) and isinstance(value.func, ast.Name)
    if isinstance(value, (ast.List, ast.Tuple, ast.Set)):
        return not value.elts
    return isinstance(value, ast.Constant) or (isinstance(value, ast.Dict) and not value.keys)


def _is_later(program: Program, node: ast.AST) -> bool:
    """Return whether a statement is in a function other than ``__init__``."""
    inner = program.function_around(node)
    return inner is not None and inner.name != '__init__'


def longer_pauses(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that change the period of a timer or a pause, as ``+=`` does."""
    given = {last_name(one) for name in _WAITS for one in program.arguments(name, 0)} - {''}
    for node in program.nodes:
        if isinstance(node, ast.AugAssign) and last_name(node.target) in given:
            yield node
        if isinstance(node, ast.Assign) and last_name(node.targets[0]) in given:
            target = ast.unparse(node.targets[0])
            sums = (one for one in ast.walk(node.value) if isinstance(one, ast.BinOp))
            if any(target in map(ast.unparse, (one.left, one.right)) for one in sums):
                yield node


def stored_times(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that store the current time."""
    times = set(program.calls('now'))
    for node in program.nodes:
        kept = isinstance(node, ast.Assign) and not isinstance(node.targets[0], ast.Name)
        if kept and not times.isdisjoint(ast.walk(node)):
            yield node

"""
Find the statements that set names and attributes: counts, flags, values that are kept or lost.

They belong to :data:`.known_acts.ACTS`.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator

from autograder.submission.code.program import assigned, last_name, names_in, Program

_WAITS = ('create_timer', 'Timer', 'sleep')


def counts(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that add 1 to a name or an attribute."""
    for node in program.nodes:
        if isinstance(node, ast.AugAssign) and _is_one(node.value):
            yield node
        if isinstance(node, ast.Assign):
            name = last_name(node.targets[0])
            adds = (one for one in ast.walk(node.value) if isinstance(one, ast.BinOp))
            if name in names_in(node.value) and any(_is_one(one.right) for one in adds):
                yield node


def recounts(program: Program) -> Iterator[ast.AST]:
    """Yield the statements outside ``__init__`` that set a count again."""
    counted = _counted(program)
    yield from (one for one in resets(program) if not counted.isdisjoint(_set_by(one)))


def compared_counts(program: Program) -> Iterator[ast.AST]:
    """Yield the comparisons of a count."""
    counted = _counted(program)
    for node in program.nodes:
        if isinstance(node, ast.Compare) and not counted.isdisjoint(names_in(node)):
            yield node


def wrapped_counts(program: Program) -> Iterator[ast.AST]:
    """Yield the remainders of a count, but not those in conditions."""
    counted = _counted(program)
    conditions = (
        one if isinstance(one, ast.Compare) else getattr(one, 'test', None)
        for one in program.nodes
    )
    asked = {part for one in conditions if one for part in ast.walk(one)}
    for node in program.operations(ast.Mod):
        left = getattr(node, 'left', None) or getattr(node, 'target', None)
        if left and node not in asked and not counted.isdisjoint(names_in(left)):
            yield node


def _counted(program: Program) -> set[str]:
    """Return the names that count something."""
    return {name for one in counts(program) for name in _set_by(one) if name}


def stored(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that set an attribute of the object itself."""
    for node in program.nodes:
        if any(ast.unparse(target).startswith('self.') for target, _ in assigned(node)):
            yield node


def kept_first(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that set an attribute only if it has no value yet, with ``or``."""
    for node in stored(program):
        value = getattr(node, 'value', None)
        if isinstance(value, ast.BoolOp) and not _set_by(node).isdisjoint(names_in(value)):
            yield node


def kept_messages(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that store a message for later, in place of the one before."""
    for body in program.reached(program.passed('create_subscription')):
        given = {one.arg for one in ast.walk(body) if isinstance(one, ast.arg)} - {'self'}
        for node in (one for one in ast.walk(body) if isinstance(one, ast.Assign)):
            target = node.targets[0]
            kept = isinstance(target, ast.Attribute) and not _uses(target, given)
            if kept and _uses(node.value, given):
                yield node


def _uses(node: ast.AST, names: set[str]) -> bool:
    return any(isinstance(one, ast.Name) and one.id in names for one in ast.walk(node))


def forgotten(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that replace an attribute by None and destroy nothing."""
    calls = [one for one in program.nodes if isinstance(one, ast.Call)]
    destroyed = {
        name
        for one in calls
        if last_name(one.func).startswith('destroy')
        for given in (one.func, *one.args)
        for name in names_in(given)
    }
    for node in resets(program):
        nothing = getattr(getattr(node, 'value', None), 'value', 0) is None
        if nothing and _set_by(node).isdisjoint(destroyed):
            yield node


def stuck(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that set a flag which nothing outside ``__init__`` sets back."""
    later = (one for one in stored(program) if _is_later(program, one))
    often = Counter(name for one in later for name in _set_by(one))
    for node in resets(program):
        flag = any(isinstance(getattr(value, 'value', 0), bool) for _, value in assigned(node))
        if flag and any(often[name] == 1 for name in _set_by(node)):
            yield node


def _is_later(program: Program, node: ast.AST) -> bool:
    """Return whether a statement is in a function other than ``__init__``."""
    inner = program.function_around(node)
    return inner is not None and inner.name != '__init__'


def _set_by(node: ast.AST) -> set[str]:
    """Return the names and attributes that a statement assigns."""
    return {last_name(target) for target, _ in assigned(node)}


def _is_one(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and node.value in (1, -1)


def resets(program: Program) -> Iterator[ast.AST]:
    """Yield the statements outside ``__init__`` that give an attribute a value of its own."""
    for node in program.nodes:
        kept = (value for target, value in assigned(node) if isinstance(target, ast.Attribute))
        if any(map(_is_fixed, kept)) and _is_later(program, node):
            yield node


def set_back(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that give an attribute its first value again."""
    for node in resets(program):
        for target, value in assigned(node):
            given = program.values.get((None, ast.unparse(target)), ())
            first = (one for one in given if one and not _is_later(program, one))
            if value and any(ast.dump(one) == ast.dump(value) for one in first):
                yield node


def longer_pauses(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that change the period of a timer or of a pause."""
    given = {last_name(one) for name in _WAITS for one in program.arguments(name, 0)} - {''}
    for node in program.nodes:
        if isinstance(node, ast.AugAssign) and last_name(node.target) in given:
            yield node


def _is_fixed(value: ast.AST | None) -> bool:
    """Return whether a value does not depend on other values."""
    if isinstance(value, ast.Call):
        return not value.args and not value.keywords and isinstance(value.func, ast.Name)
    if isinstance(value, (ast.List, ast.Tuple, ast.Set)):
        return not value.elts
    return isinstance(value, ast.Constant) or (isinstance(value, ast.Dict) and not value.keys)


def times(program: Program) -> Iterator[ast.AST]:
    """Yield the statements that store the current time."""
    for node in program.nodes:
        if isinstance(node, ast.Assign) and not isinstance(node.targets[0], ast.Name):
            made = (one for one in ast.walk(node.value) if isinstance(one, ast.Call))
            if any(last_name(one.func) == 'now' for one in made):
                yield node

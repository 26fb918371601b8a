"""
The periods that a learner's code gives its timers, read as Python and never run.

What a name stands for is what the code ever gives it, anywhere; a name that may get more than can
be read has None among its numbers.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
import math
import operator

from autograder.judging.learners_code import last_name, trees

RATES = ('create_rate', 'Rate')
"""What gets a frequency."""
PACES = ('create_timer', *RATES, 'sleep_for', 'sleep_until')
"""What gives a rhythm by the clock of a node."""
FOR_EVER_S = 1e9
"""Longer than any period [s], and nanoseconds of a second."""
Numbers = frozenset[float | None]
UNKNOWN: Numbers = frozenset({None})
MOST_NUMBERS = 16
"""Of one expression; one that may be more is unknown."""
DEEPEST = 20
PASSES = 3
"""How many names may lie between a number and its use, and one more."""
_PERIOD_WORDS = ('timer_period_sec', 'frequency', 'rel_time')
_UNITS = {'seconds': 1.0, 'nanoseconds': 1e-9}
"""Of a duration."""
_OPERATORS: Mapping[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: math.pow,
}


def timer_periods(files: Mapping[str, str]) -> set[float]:
    """Return the periods [s] that timers get, as far as they can be read."""
    found = written_periods(files, ('create_timer',))
    return {period for period in found if period is not None}


def written_periods(
    files: Mapping[str, str], paces: Collection[str] = PACES
) -> list[float | None]:
    """
    Return the periods [s] that timers, rates and sleeps of a node's clock may have in code.

    None is among them where one may be another than can be read, or where the function is named
    and not called.

    :param paces: names of the functions that give a rhythm
    """
    nodes = [node for tree in trees(files) for node in ast.walk(tree)]
    calls = [node for node in nodes if isinstance(node, ast.Call)]
    called = {id(call.func) for call in calls}
    paced = [call for call in calls if last_name(call.func) in paces]
    found: list[float | None] = []
    given = _numbers_by_name(nodes) if paced else {}
    for call in paced:
        found += [one if one and one > 0 else None for one in _periods_of(call, given)]
    found += [None for node in nodes if _names(node) in paces and id(node) not in called]
    return found


def _names(node: ast.AST) -> str:
    """Return what a name or, for getattr(), a text names."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    return last_name(node)


def _numbers_by_name(nodes: Sequence[ast.AST]) -> dict[str, Numbers]:
    """Return which numbers each name gets."""
    uses = [use for node in nodes for use in _given_in(node)]
    read = {id(target) for node in nodes for target in _targets_read(node)}
    stored = [
        last_name(node)
        for node in nodes
        if isinstance(getattr(node, 'ctx', None), ast.Store) and id(node) not in read
    ]
    given: dict[str, Numbers] = {}
    for _ in range(PASSES):
        found: dict[str, set[float | None]] = {name: {None} for name in stored}
        for name, value in uses:
            numbers = UNKNOWN if value is None else _numbers(value, given)
            found.setdefault(name, set()).update(numbers)
        given = {
            name: frozenset(numbers) if len(numbers) <= MOST_NUMBERS else UNKNOWN
            for name, numbers in found.items()
        }
    return given


def _given_in(node: ast.AST) -> Iterator[tuple[str, ast.AST | None]]:
    """Yield the names that a node gives something, each with what it gives if that is known."""
    if isinstance(node, ast.Assign):
        for target in node.targets:
            yield from _paired(target, node.value)
    elif isinstance(node, ast.AnnAssign) and node.value is not None:
        yield last_name(node.target), node.value
    elif isinstance(node, ast.AugAssign):
        yield last_name(node.target), None
    elif isinstance(node, ast.keyword) and node.arg:
        yield node.arg, node.value
    elif isinstance(node, ast.alias) and node.asname:
        yield node.asname, ast.Name(node.name)
    elif isinstance(node, ast.arguments):
        # Whatever a default is, a caller may give another.
        plain = [*node.posonlyargs, *node.args]
        yield from ((one.arg, None) for one in (*plain, *node.kwonlyargs))
        yield from ((one.arg, value) for one, value in zip(plain[::-1], node.defaults[::-1]))
        yield from ((one.arg, value) for one, value in zip(node.kwonlyargs, node.kw_defaults))
    elif isinstance(node, ast.Call) and last_name(node.func) == 'setattr':
        yield from ((_names(argument), None) for argument in node.args[1:2])


def _paired(target: ast.AST, value: ast.AST) -> Iterator[tuple[str, ast.AST | None]]:
    """Yield what each name of an assignment gets: ``a, b = 0.1, 10`` is two."""
    if not isinstance(target, (ast.Tuple, ast.List)):
        yield last_name(target), value
    elif isinstance(value, (ast.Tuple, ast.List)) and len(value.elts) == len(target.elts):
        yield from ((last_name(one), of) for one, of in zip(target.elts, value.elts))
    else:
        yield from ((last_name(one), None) for one in target.elts)


def _targets_read(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the targets of which :func:`_given_in` tells."""
    if isinstance(node, (ast.AnnAssign, ast.AugAssign)):
        yield node.target
    for target in node.targets if isinstance(node, ast.Assign) else ():
        yield target
        if isinstance(target, (ast.Tuple, ast.List)):
            yield from target.elts


def _periods_of(call: ast.Call, given: Mapping[str, Numbers]) -> Numbers:
    named = [one.value for one in call.keywords if one.arg in _PERIOD_WORDS]
    written = next(iter([*named, *call.args[:1]]), None)
    numbers = UNKNOWN if written is None else _numbers(written, given)
    if last_name(call.func) in RATES:
        return _bounded([1 / one if one else None for one in numbers])
    return numbers


def _numbers(node: ast.AST, given: Mapping[str, Numbers], depth: int = 0) -> Numbers:
    """Return the numbers that an expression may be: 0.5, PERIOD_S, 1.0 / self.rate, 100 * 1e-3."""
    if depth > DEEPEST:
        return UNKNOWN
    if isinstance(node, ast.Constant):
        value = node.value
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            return UNKNOWN
        return frozenset({float(value)}) if _is_small(value) else UNKNOWN
    if isinstance(node, ast.Name) or (
        # Of deeper names, such as Period.FAST.value, the last part tells nothing.
        isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
    ):
        return given.get(last_name(node), UNKNOWN)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        inner = _numbers(node.operand, given, depth + 1)
        sign = -1 if isinstance(node.op, ast.USub) else 1
        return _bounded([None if one is None else sign * one for one in inner])
    if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
        left, right = (_numbers(part, given, depth + 1) for part in (node.left, node.right))
        combine = _OPERATORS[type(node.op)]
        return _bounded([_combined(combine, one, other) for one in left for other in right])
    if isinstance(node, ast.Call):
        return _called(node, given, depth)
    return UNKNOWN


def _called(call: ast.Call, given: Mapping[str, Numbers], depth: int) -> Numbers:
    name = last_name(call.func)
    if name in ('float', 'int') and len(call.args) == 1 and not call.keywords:
        inner = _numbers(call.args[0], given, depth + 1)
        return inner if name == 'float' else _bounded([one and float(int(one)) for one in inner])
    words = {one.arg: one.value for one in call.keywords}
    if name != 'Duration' or call.args or not set(words) <= set(_UNITS):
        return UNKNOWN
    sums: list[float | None] = [0.0]
    for word, value in words.items():
        parts = _numbers(value, given, depth + 1)
        unit = _UNITS[str(word)]
        sums = [
            None if one is None or part is None else one + unit * part
            for one in sums
            for part in parts
        ]
    return _bounded(sums)


def _is_small(number: float) -> bool:
    # A whole number may be too large for a float.
    return -FOR_EVER_S <= number <= FOR_EVER_S


def _combined(
    combine: Callable[[float, float], float], left: float | None, right: float | None
) -> float | None:
    if left is None or right is None:
        return None
    try:
        return combine(left, right)
    except (ArithmeticError, ValueError):
        return None


def _bounded(numbers: Sequence[float | None]) -> Numbers:
    """Return numbers without those that no period is, and without too many."""
    if len(numbers) > MOST_NUMBERS:
        return UNKNOWN
    return frozenset(
        one if one is not None and math.isfinite(one) and _is_small(one) else None
        for one in numbers
    )

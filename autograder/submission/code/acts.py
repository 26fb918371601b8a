"""
Find the place where a program does an act, such as creating its timer, without running it.

An act is written in a few words, which :func:`place_of` looks for in this order::

    round() | field         a call of round(), or else what is assigned to the field in question

Words without a bar between them are alternatives:

=============  ====================================================================
``name()``     a call of a function or method
``name(0)``    the first argument of a call
``name=``      the value of a keyword argument or of an attribute
``>=``         an operator, see :data:`OPERATORS`
``if:name()``  the innermost ``if`` around a call; the other :data:`STATEMENTS` too
``period``     and the other keys of :data:`ACTS`
``NAME``       any other word: a use of this name
=============  ====================================================================

As in :mod:`.learners_code`, the results affect only messages.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cached_property
import operator
from typing import NamedTuple

from autograder.submission.code.learners_code import (
    bodies_of_callbacks,
    Code,
    in_cell,
    last_name,
)

OPERATORS: Mapping[str, type[ast.AST]] = {
    '%': ast.Mod,
    '//': ast.FloorDiv,
    '==': ast.Eq,
    '!=': ast.NotEq,
    '>': ast.Gt,
    '<': ast.Lt,
    '>=': ast.GtE,
    '<=': ast.LtE,
    'or': ast.Or,
    'not': ast.Not,
    'is': ast.Is,
}
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
STATEMENTS: Mapping[str, tuple[type[ast.AST], ...]] = {
    'if': (ast.If, ast.IfExp),
    'while': (ast.While,),
    'for': (ast.For, ast.AsyncFor),
    'with': (ast.With, ast.AsyncWith),
    'in': _FUNCTIONS,
}
_ARITHMETIC: Mapping[type[ast.AST], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
_TIMERS = ('create_timer', 'create_rate', 'Timer', 'sleep')
_WALL = ('time', 'time_ns', 'monotonic', 'today', 'utcnow', 'Clock')
USUAL_DEPTH = 10
_SHORT_PROFILES = ('qos_profile_sensor_data',)
"""Profiles of rclpy whose depth is below the usual one."""


class Place(NamedTuple):
    """
    The place of an act.

    :param line: in the file, from 1
    :param function: name of the function that begins in this line, if the act has several places
        in it; empty if the line itself does the act
    """

    line: int
    function: str = ''

    @property
    def words(self) -> str:
        """Return the place as the beginning of a message."""
        where = in_cell(self.line)
        return f'{where[:-2]}, in {self.function[:40]}(): ' if self.function else where


def place_of(
    code: Code, acts: str, about: Sequence[str] = (), lines: Collection[int] = ()
) -> Place | None:
    """
    Return the place of the first act that has exactly one, None if none has.

    :param code: of one file; the lines of several files would be ambiguous
    :param acts: see above
    :param about: names, texts and numbers in question, such as the field of a message
    :param lines: of the log calls in question; they choose between several places
    """
    if len(code.trees) != 1:
        return None
    program = _Program(code.trees[0], about, lines)
    return next(filter(None, map(program.place, acts.split(' | '))), None)


class _Program:
    """The syntax tree of one file with what is needed to find acts in it."""

    def __init__(self, tree: ast.Module, about: Sequence[str], lines: Collection[int]) -> None:
        self.tree, self.about, self.lines = tree, about, lines
        self.nodes = tuple(ast.walk(tree))

    @cached_property
    def values(self) -> Mapping[tuple[ast.AST | None, str], Sequence[ast.AST | None]]:
        """Return what each name gets, by the function or class of the name; None if unknown."""
        found: dict[tuple[ast.AST | None, str], list[ast.AST | None]] = {}
        for node in self.nodes:
            for target, value in _assigned(node):
                found.setdefault(self._key(target, node), []).append(value)
        return found

    def _key(self, target: ast.AST, node: ast.AST) -> tuple[ast.AST | None, str]:
        if isinstance(target, ast.Attribute):
            return None, ast.unparse(target)
        scopes = (*_FUNCTIONS, ast.ClassDef)
        inner = next((one for one in self.around(node) if isinstance(one, scopes)), None)
        return inner, target.arg if isinstance(target, ast.arg) else last_name(target)

    @cached_property
    def parents(self) -> Mapping[ast.AST, ast.AST]:
        """Return the parent of each node."""
        return {child: node for node in self.nodes for child in ast.iter_child_nodes(node)}

    @cached_property
    def working(self) -> frozenset[ast.AST]:
        """Return the functions and lambdas that callbacks reach."""
        return frozenset(body for _, body in bodies_of_callbacks(self.tree))

    @cached_property
    def strings(self) -> Sequence[ast.AST]:
        """Return the strings and f-strings, without docstrings."""
        return [
            node
            for node in self.nodes
            if (isinstance(node, ast.JoinedStr) or isinstance(getattr(node, 'value', None), str))
            and not isinstance(self.parents.get(node), (ast.JoinedStr, ast.Expr))
        ]

    def around(self, node: ast.AST) -> Iterator[ast.AST]:
        """Yield the nodes around a node, from the inside."""
        while found := self.parents.get(node):
            yield found
            node = found

    def place(self, act: str) -> Place | None:
        """Return the place of an act, given as alternative words."""
        found = [node for word in act.split() for node in self.find(word)]
        seen = [node for node in found if self._is_seen(node)]
        in_callbacks = [
            node for node in found if not self.working.isdisjoint(self.around(node))
        ]
        for some in (found, seen, in_callbacks):
            if len({_line(one) for one in some}) == 1:
                return self._at(some[0])
        return self._function(seen or in_callbacks or found)

    def _is_seen(self, node: ast.AST) -> bool:
        """Return whether a node is in a function with one of the log calls in question."""
        inner = next((one for one in self.around(node) if isinstance(one, _FUNCTIONS)), None)
        return inner is not None and any(inner.lineno <= one <= _end(inner) for one in self.lines)

    def _at(self, node: ast.AST) -> Place:
        return Place(_line(node), node.name if isinstance(node, _FUNCTIONS) else '')

    def _function(self, nodes: Sequence[ast.AST]) -> Place | None:
        """Return the innermost function around all nodes."""
        if not nodes:
            return None
        each = [set(self.around(node)) for node in nodes]
        for one in self.around(nodes[0]):
            if isinstance(one, _FUNCTIONS) and all(one in others for others in each):
                return Place(one.lineno, one.name)
        return None

    def find(self, word: str) -> Iterable[ast.AST]:
        """Return the nodes that a word means."""
        if find := ACTS.get(word):
            return find(self)
        if word in OPERATORS:
            return self._operations(OPERATORS[word])
        if word in STATEMENTS:
            return (node for node in self.nodes if isinstance(node, STATEMENTS[word]))
        kind, _, name = word.rpartition(':')
        if kind:
            return self._around_calls(name, STATEMENTS[kind])
        if word.endswith('()'):
            return self.calls(word[:-2])
        if word.endswith('(0)'):
            return (self.origin(one.args[0]) for one in self.calls(word[:-3]) if one.args)
        if word.endswith('='):
            return map(self.origin, self.given(word[:-1]))
        return (
            node for node in self.nodes if last_name(node) == word and not _is_stored(node)
        )

    def calls(self, *names: str) -> list[ast.Call]:
        """Return the calls of functions."""
        calls = (node for node in self.nodes if isinstance(node, ast.Call))
        return [node for node in calls if last_name(node.func) in names]

    def _around_calls(self, name: str, kinds: tuple[type[ast.AST], ...]) -> Iterator[ast.AST]:
        for call in self.calls(name.removesuffix('()')):
            around = (one for one in self.around(call) if isinstance(one, (*kinds, *_FUNCTIONS)))
            if isinstance(found := next(around, None), kinds) and not _asks_ok(found):
                yield found

    def _operations(self, kind: type[ast.AST]) -> Iterator[ast.AST]:
        for node in self.nodes:
            ops = node.ops if isinstance(node, ast.Compare) else [getattr(node, 'op', None)]
            if any(isinstance(one, kind) for one in ops):
                yield node

    def given(self, name: str) -> Iterator[ast.AST]:
        """Yield the values of a keyword argument or of an attribute."""
        for node in self.nodes:
            if isinstance(node, ast.keyword) and node.arg == name:
                yield node.value
            if isinstance(node, ast.Assign):
                for target in node.targets:
                    if isinstance(target, ast.Attribute) and name in _dotted(target):
                        yield node.value

    def origin(self, node: ast.AST) -> ast.AST:
        """Return the value of a name that has only one, or the node itself."""
        for _ in range(3):  # a name of a name of a name
            found = next(filter(None, map(self.values.get, self._keys(node))), [None])
            if len(found) != 1 or found[0] is None:
                break
            node = found[0]
        return node

    def _keys(self, node: ast.AST) -> Iterator[tuple[ast.AST | None, str]]:
        """Yield where the value of a name may come from, the innermost place first."""
        if isinstance(node, ast.Attribute):
            yield None, ast.unparse(node)
            yield from ((one, node.attr) for one in self.nodes if isinstance(one, ast.ClassDef))
        if isinstance(node, ast.Name):
            yield from ((one, node.id) for one in self.around(node) if isinstance(one, _FUNCTIONS))
            yield None, node.id

    def is_near(self, node: ast.AST, due: float) -> bool:
        """Return whether an expression is a number near another one."""
        value = None if isinstance(node, (ast.Name, ast.Attribute)) else self.number(node)
        return value is not None and not isinstance(value, bool) and abs(value - due) <= due / 50

    def number(self, node: ast.AST) -> float | None:
        """Return the value of a number or of simple arithmetic, None for anything else."""
        node = self.origin(node)
        if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
            return float(node.value)
        if isinstance(node, ast.BinOp) and (apply := _ARITHMETIC.get(type(node.op))):
            left, right = self.number(node.left), self.number(node.right)
            with suppress(ArithmeticError):
                return None if left is None or right is None else apply(left, right)
        return None


def _assigned(node: ast.AST) -> Iterator[tuple[ast.AST, ast.AST | None]]:
    """Yield the names that a statement assigns, each with its value, None if it is unknown."""
    if isinstance(node, ast.Assign):
        for target in node.targets:
            parts = isinstance(target, ast.Tuple)
            both = parts and isinstance(node.value, ast.Tuple)
            if both and len(target.elts) == len(node.value.elts):
                yield from zip(target.elts, node.value.elts)
            else:
                yield from ((one, None) for one in target.elts) if parts else [(target, node.value)]
    elif isinstance(node, ast.AnnAssign) and node.value:
        yield node.target, node.value
    elif isinstance(node, (ast.AugAssign, ast.For)):
        yield node.target, None
    elif isinstance(node, ast.arg):
        yield node, None


def _asks_ok(node: ast.AST) -> bool:
    """Return whether a condition asks whether ROS still runs."""
    test = getattr(node, 'test', None)
    return isinstance(test, ast.Call) and last_name(test.func) == 'ok'


def _line(node: ast.AST) -> int:
    return int(getattr(node, 'lineno', 0))


def _end(node: ast.AST) -> int:
    return int(getattr(node, 'end_lineno', 0))


def _is_stored(node: ast.AST) -> bool:
    return isinstance(getattr(node, 'ctx', None), ast.Store)


def _dotted(target: ast.AST) -> set[str]:
    """Return all names of a dotted name."""
    return {last_name(one) for one in ast.walk(target)}


def _argument(call: ast.Call, place: int, *names: str) -> ast.AST | None:
    """Return an argument by its index or its name."""
    named = {one.arg: one.value for one in call.keywords}
    given = next((named[name] for name in names if name in named), None)
    return given or (call.args[place] if len(call.args) > place else None)


# -- acts with a name -----------------------------------------------------------------------


def _periods(program: _Program) -> list[ast.AST]:
    """Return the periods of timers that are the duration in question, or that cannot be read."""
    given = [_argument(one, 0, 'timer_period_sec') for one in program.calls(*_TIMERS)]
    found = [program.origin(one) for one in given if one is not None]
    due = next(iter(_numbers(program)), None)
    if due is None:
        return found
    if near := [one for one in found if program.is_near(one, due)]:
        return near
    unread = [one for one in found if program.number(one) is None]
    whole = (one for one in program.nodes if not isinstance(program.parents.get(one), ast.BinOp))
    return unread and ([one for one in whole if program.is_near(one, due)] or unread)


def _slow_periods(program: _Program) -> list[ast.AST]:
    """Return the periods of timers and pauses that last at least as long as asked."""
    given = [one.args[0] for one in program.calls(*_TIMERS) if one.args]
    found = [program.origin(one) for one in given]
    due = next(iter(_numbers(program)), 0.0)
    return [one for one in found if (program.number(one) or 0.0) >= 0.95 * due]


def _numbers(program: _Program) -> Iterator[float]:
    for text in program.about:
        with suppress(ValueError):
            yield float(text)


def _few_threads(program: _Program) -> Iterator[ast.AST]:
    """Yield the numbers of threads of executors that have only one."""
    for call in program.calls('MultiThreadedExecutor'):
        given = _argument(call, 0, 'num_threads')
        if given is not None and program.number(given) == 1:
            yield program.origin(given)


def _depths(program: _Program) -> Iterator[ast.AST]:
    """Yield the depths of subscriptions that are below the usual one."""
    for call in program.calls('create_subscription'):
        given = _argument(call, 3, 'qos_profile')
        value = program.origin(given) if given else None
        if isinstance(value, ast.Call):
            given = _argument(value, 0, 'depth')
            value = program.origin(given) if given else None
        if value is not None:
            depth = program.number(value)
            short = last_name(value) in _SHORT_PROFILES
            if short or (depth is not None and depth < USUAL_DEPTH):
                yield value


def _fields(program: _Program) -> Iterator[ast.AST]:
    """Yield what the field in question gets."""
    for name in program.about:
        yield from map(program.origin, program.given(name.rpartition('.')[2] or 'data'))


def _texts(program: _Program) -> Sequence[ast.AST]:
    """Return the strings that give the first of the names in question that the code has."""
    for name in program.about:
        found = [node for node in program.strings if _names(_text(node), name)]
        if name.strip('/') and found:
            return found
    return ()


def _names(text: str, name: str) -> bool:
    """Return whether a string gives a name, with or without its namespace."""
    text = text.strip('~/')
    return bool(text) and f'/{name.strip("/")}'.endswith(f'/{text}')


def _sayings(program: _Program) -> Iterator[ast.AST]:
    """Yield the strings and f-strings whose words are in a text that the program gave."""
    for node in program.strings:
        words = _text(node).strip()
        if len(words) > 1 and any(words in text for text in program.about):
            yield node


def _text(node: ast.AST) -> str:
    """Return the text of a string, or the longest fixed part of an f-string."""
    parts = (one for one in ast.walk(node) if isinstance(one, ast.Constant))
    return max((one.value for one in parts if isinstance(one.value, str)), key=len, default='')


def _counts(program: _Program) -> Iterator[ast.AST]:
    """Yield the statements that add 1 to a name or an attribute."""
    for node in program.nodes:
        if isinstance(node, ast.AugAssign) and _is_one(node.value):
            yield node
        if isinstance(node, ast.Assign):
            name = last_name(node.targets[0])
            adds = (one for one in ast.walk(node.value) if isinstance(one, ast.BinOp))
            if any(_is_one(one.right) and name in _dotted(one.left) for one in adds):
                yield node


def _is_one(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and node.value in (1, -1)


def _resets(program: _Program) -> Iterator[ast.AST]:
    """Yield the statements outside ``__init__`` that give an attribute a value of its own."""
    for node in program.nodes:
        if not isinstance(node, ast.Assign) or not _is_fixed(node.value):
            continue
        inner = next((one for one in program.around(node) if isinstance(one, _FUNCTIONS)), None)
        kept = any(isinstance(target, ast.Attribute) for target in node.targets)
        if kept and inner is not None and inner.name != '__init__':
            yield node


def _is_fixed(value: ast.AST) -> bool:
    """Return whether a value does not depend on other values."""
    if isinstance(value, ast.Call):
        return not value.args and not value.keywords and isinstance(value.func, ast.Name)
    if isinstance(value, (ast.List, ast.Dict, ast.Set)):
        return not any(ast.iter_child_nodes(value)) or len(ast.dump(value)) < 40
    return isinstance(value, ast.Constant)


def _times(program: _Program) -> Iterator[ast.AST]:
    """Yield the statements that store the current time."""
    for node in program.nodes:
        if isinstance(node, ast.Assign) and not isinstance(node.targets[0], ast.Name):
            made = (one for one in ast.walk(node.value) if isinstance(one, ast.Call))
            if any(last_name(one.func) == 'now' for one in made):
                yield node


def _wall_clocks(program: _Program) -> Iterator[ast.AST]:
    """Yield the calls that ask the system for the time."""
    yield from program.calls(*_WALL)
    for call in program.calls('now'):
        if isinstance(call.func, ast.Attribute) and 'datetime' in _dotted(call.func.value):
            yield call


def _lists(program: _Program) -> Iterator[ast.AST]:
    """Yield the collections of numbers."""
    for node in program.nodes:
        if isinstance(node, (ast.List, ast.Tuple, ast.Set)) and len(node.elts) > 1:
            values = (getattr(one, 'value', None) for one in node.elts)
            if all(isinstance(one, (int, float)) for one in values):
                yield node


def _joined(program: _Program) -> Iterator[ast.AST]:
    """Yield the numbers that are assembled as text."""
    for call in program.calls('float', 'int'):
        if any(isinstance(one, ast.JoinedStr) for one in ast.walk(call)):
            yield call


def _truths(program: _Program) -> Iterator[ast.AST]:
    """Yield the conditions that ask whether a value is empty or zero."""
    for node in program.nodes:
        for test in _parts(node.test) if isinstance(node, (ast.If, ast.IfExp)) else ():
            bare = isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not)
            asked = test.operand if bare else test  # type: ignore[attr-defined]
            if isinstance(asked, (ast.Name, ast.Attribute)):
                yield test


def _parts(test: ast.AST) -> Sequence[ast.AST]:
    return test.values if isinstance(test, ast.BoolOp) else [test]


def _early_returns(program: _Program) -> Iterator[ast.AST]:
    """Yield the statements that leave a function without a value."""
    for node in program.nodes:
        if isinstance(node, ast.Return) and node.value is None:
            yield node


def _own_arguments(program: _Program) -> Iterator[ast.AST]:
    """Yield the calls that make a node ignore its command line."""
    for node in program.nodes:
        named = isinstance(node, ast.keyword)
        if named and node.arg in ('use_global_arguments', 'cli_args'):
            yield node.value
    for call in program.calls('init'):
        given = _argument(call, 0, 'args')
        if isinstance(given, (ast.List, ast.Tuple, ast.Call, ast.BoolOp)):
            yield call


def _limits(program: _Program) -> Iterator[ast.AST]:
    """Yield the comparisons of size."""
    for sign in ('<', '>', '<=', '>='):
        yield from program.find(sign)


def _log_calls(program: _Program) -> Iterator[ast.AST]:
    """Yield the log calls in question."""
    levels = ('debug', 'info', 'warn', 'warning', 'error', 'fatal')
    return (one for one in program.calls(*levels) if _covers(one, program.lines))


def _covers(node: ast.AST, lines: Collection[int]) -> bool:
    return any(_line(node) <= one <= _end(node) for one in lines)


ACTS: Mapping[str, Callable[[_Program], Iterable[ast.AST]]] = {
    'count': _counts,
    'depth': _depths,
    'early_return': _early_returns,
    'few_threads': _few_threads,
    'field': _fields,
    'joined': _joined,
    'limit': _limits,
    'list': _lists,
    'log': _log_calls,
    'own_arguments': _own_arguments,
    'period': _periods,
    'reset': _resets,
    'says': _sayings,
    'slow_period': _slow_periods,
    'stores_time': _times,
    'text': _texts,
    'truth': _truths,
    'wall_clock': _wall_clocks,
}
"""Acts that a single word of code does not show."""

"""
Parse a program and search its syntax tree: calls, arguments, values of names, functions.

The code is never run, and the results affect only messages.
"""

import ast
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cached_property
import operator
import threading
import warnings

FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_ARITHMETIC: Mapping[type[ast.AST], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
_ONE_AT_A_TIME = threading.Lock()
"""Serialises calls to the parser: Python before 3.11.5 shares the recursion depth between threads,
and warnings are switched off for all threads."""
_MOST = 3  # maximum nesting of names and operations: hostile code may have thousands
Scope = tuple[ast.AST | None, str]
"""A function (None: the whole file) and a name in it; a dot precedes names in a class."""


class NotPythonError(ValueError):
    """Report that Python cannot parse a string as code."""


def parsed(text: str, mode: str = 'exec') -> ast.AST:
    """
    Return the syntax tree of a file.

    :param mode: ``'eval'`` for one expression
    :raises NotPythonError: if Python cannot parse it
    """
    try:
        with _ONE_AT_A_TIME, warnings.catch_warnings():
            warnings.simplefilter('ignore')  # such as invalid escape sequences in student code
            return ast.parse(text, mode=mode)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise NotPythonError(str(error)) from None


class Program:
    """
    The syntax tree of one file.

    :param about: names, strings and numbers in question, such as the field of a message
    :param lines: lines of the log calls in question
    """

    def __init__(
        self, tree: ast.AST, about: Sequence[str] = (), lines: Collection[int] = ()
    ) -> None:
        self.tree, self.about, self.lines = tree, about, lines
        self.nodes = tuple(ast.walk(tree))

    @cached_property
    def values(self) -> Mapping[Scope, Sequence[ast.AST | None]]:
        """Return the values assigned to each name in its scope; None for an unknown value."""
        found: dict[Scope, list[ast.AST | None]] = {}
        for node in self.nodes:
            for target, value in assigned(node):
                found.setdefault(self._key(target, node), []).append(value)
        return found

    def _key(self, target: ast.AST, node: ast.AST) -> Scope:
        if isinstance(target, ast.Attribute):
            return None, ast.unparse(target)
        scopes = (*FUNCTIONS, ast.ClassDef)
        inner = next((one for one in self.around(node) if isinstance(one, scopes)), None)
        name = target.arg if isinstance(target, ast.arg) else last_name(target)
        return (None, f'.{name}') if isinstance(inner, ast.ClassDef) else (inner, name)

    @cached_property
    def parents(self) -> Mapping[ast.AST, ast.AST]:
        """Return the parent of each node."""
        return {child: node for node in self.nodes for child in ast.iter_child_nodes(node)}

    @cached_property
    def working(self) -> frozenset[ast.AST]:
        """Return the functions and lambdas that callbacks reach."""
        return frozenset(body for _, body in self.callbacks())

    def is_working(self, node: ast.AST) -> bool:
        """Return whether a node is in a function or lambda that callbacks reach."""
        return not self.working.isdisjoint(self.around(node))

    def callbacks(self) -> Iterator[tuple[str, ast.AST]]:
        """
        Yield each function that a callback reaches, once, with the name of that callback.

        A callback is a lambda or a function of the file that is passed to any call but ``Thread``.
        """
        seen: set[ast.AST] = set()  # a file may have thousands of callbacks
        for call in self.nodes:
            if isinstance(call, ast.Call) and last_name(call.func) != 'Thread':
                for given in all_arguments(call):
                    for body in self.reached(self.bodies(given), seen):
                        yield last_name(given), body

    def bodies(self, *given: ast.AST) -> Iterator[ast.AST]:
        """Yield the lambdas and functions among the given arguments."""
        for one in given:
            yield from [one] if isinstance(one, ast.Lambda) else self.functions(last_name(one))

    def passed(self, name: str) -> Iterator[ast.AST]:
        """Yield the functions and lambdas that are passed to a call."""
        for call in self.calls(name):
            yield from self.bodies(*all_arguments(call))

    def reached(
        self, bodies: Iterable[ast.AST], seen: set[ast.AST] | None = None
    ) -> Iterator[ast.AST]:
        """
        Yield functions and all functions that they call, directly or not.

        :param seen: functions to skip; yielded functions are added
        """
        seen, left = set() if seen is None else seen, list(bodies)
        for body in left:
            if body not in seen:
                seen.add(body)
                yield body
                calls = (one for one in ast.walk(body) if isinstance(one, ast.Call))
                left += self.functions(*dict.fromkeys(last_name(one.func) for one in calls))

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

    def function_around(self, *nodes: ast.AST) -> ast.FunctionDef | ast.AsyncFunctionDef | None:
        """Return the innermost function around all nodes, None if there is none."""
        each = [[one for one in self.around(node) if isinstance(one, FUNCTIONS)] for node in nodes]
        common = (one for one in each[0] if all(one in others for others in each)) if each else ()
        return next(iter(common), None)

    def calls(self, *names: str) -> list[ast.Call]:
        """Return the calls to functions; ``warn`` is another name for ``warning`` of loggers."""
        names = (*names, 'warn') if 'warning' in names else names
        calls = (node for node in self.nodes if isinstance(node, ast.Call))
        return [node for node in calls if last_name(node.func) in names]

    @cached_property
    def _functions(self) -> Mapping[str, Sequence[ast.AST]]:
        found: dict[str, list[ast.AST]] = {}  # classes may share method names
        for node in self.nodes:
            if isinstance(node, FUNCTIONS):
                found.setdefault(node.name, []).append(node)
        return found

    def functions(self, *names: str) -> list[ast.AST]:
        """Return the functions and methods with the given names."""
        return [one for name in names for one in self._functions.get(name, ())]

    def arguments(self, name: str, place: int) -> Iterator[ast.AST]:
        """Yield the argument at a given index from each call to a function."""
        for call in self.calls(name):
            if len(call.args) > place:
                yield call.args[place]

    def operations(self, *kinds: type[ast.AST]) -> Iterator[ast.AST]:
        """Yield the operations and comparisons of the given kinds."""
        for node in self.nodes:
            ops = node.ops if isinstance(node, ast.Compare) else [getattr(node, 'op', None)]
            if any(isinstance(one, kinds) for one in ops) and '__name__' not in names_in(node):
                yield node

    def given(self, name: str) -> Iterator[ast.AST]:
        """Yield the values of a keyword argument or of an attribute."""
        for node in self.nodes:
            if isinstance(node, ast.keyword) and node.arg == name:
                yield node.value
            if isinstance(node, (ast.Assign, ast.AugAssign)):
                for target, value in assigned(node):
                    if isinstance(target, ast.Attribute) and name in names_in(target):
                        yield value or node.value

    def origin(self, node: ast.AST) -> ast.AST:
        """Return the only value of a name; for any other node, the node itself."""
        for _ in range(_MOST):
            found = next(filter(None, map(self.values.get, self._keys(node))), [None])
            if len(found) != 1 or found[0] is None:
                break
            node = found[0]
        return node

    def _keys(self, node: ast.AST) -> Iterator[Scope]:
        """Yield the scopes in which a name may get its value, the innermost first."""
        if isinstance(node, ast.Attribute):
            yield None, ast.unparse(node)
            yield None, f'.{node.attr}'  # of a class
        if isinstance(node, ast.Name):
            yield from ((one, node.id) for one in self.around(node) if isinstance(one, FUNCTIONS))
            yield None, node.id
            yield None, f'.{node.id}'  # in the body of a class

    def is_default(self, name: str) -> bool:
        """Return whether an argument of a function has a name as its default value."""
        functions = (node.args for node in self.nodes if isinstance(node, FUNCTIONS))
        defaults = (
            one for args in functions for one in (*args.defaults, *args.kw_defaults) if one
        )
        return bool(name) and name in map(last_name, defaults)

    def is_near(self, node: ast.AST, due: float) -> bool:
        """Return whether an expression is a number within 2 % of the given one."""
        value = None if isinstance(node, (ast.Name, ast.Attribute)) else self.number(node)
        return value is not None and abs(value - due) <= due / 50

    def numbers(self, name: str) -> Sequence[float]:
        """Return the numbers that calls to a function have as their first argument."""
        with suppress(RecursionError):  # hostile code: a name with thousands of dots
            given = (one for call in self.arguments(name, 0) for one in self.sources(call))
            found = map(self.number, given)
            return [one for one in found if one is not None]
        return ()

    def sources(self, node: ast.AST) -> Sequence[ast.AST]:
        """Return the value of a name; for a parameter, the argument of each call."""
        node = self.origin(node)
        function = self.function_around(node)
        names = [one.arg for one in function.args.args] if function else []
        if function is None or not isinstance(node, ast.Name) or node.id not in names:
            return [node]
        owner, method = self.parents[function], names[0] == 'self'
        called = function.name
        if isinstance(owner, ast.ClassDef) and called == '__init__':
            called = owner.name
        place = names.index(node.id) - method
        given = (argument(call, place, node.id) for call in self.calls(called))
        return [one for one in given if one is not None]

    def number(self, node: ast.AST, most: int = _MOST) -> float | None:
        """
        Return the value of a number or of simple arithmetic, None for anything else.

        :param most: maximum number of nested operations to follow
        """
        node = self.origin(node)
        with suppress(ArithmeticError):
            if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
                return float(node.value)
            if isinstance(node, ast.BinOp) and most and (apply := _ARITHMETIC.get(type(node.op))):
                left, right = (self.number(one, most - 1) for one in (node.left, node.right))
                return None if left is None or right is None else apply(left, right)
        return None


def assigned(node: ast.AST) -> Iterator[tuple[ast.AST, ast.AST | None]]:
    """Yield the names that a node assigns, each with its value, None if it is unknown."""
    if isinstance(node, ast.Assign):
        for target in node.targets:
            names, value = getattr(target, 'elts', [target]), node.value
            values = getattr(value, 'elts', []) if isinstance(target, ast.Tuple) else [value]
            known = len(names) == len(values)
            yield from zip(names, values if known else [None] * len(names))
    elif isinstance(node, ast.AnnAssign) and node.value:
        yield node.target, node.value
    elif isinstance(node, (ast.AugAssign, ast.For)):
        yield node.target, None
    elif isinstance(node, ast.arg):
        yield node, None


def last_name(node: ast.AST) -> str:
    """Return the last part of a name, with or without dots; empty for any other node."""
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ''


def is_stored(node: ast.AST) -> bool:
    """Return whether a node assigns a name instead of reading it."""
    return isinstance(getattr(node, 'ctx', None), ast.Store)


def names_in(node: ast.AST, kind: type[ast.AST] = ast.AST) -> set[str]:
    """Return all names and attributes in an expression, or only those of one kind."""
    return {last_name(one) for one in ast.walk(node) if isinstance(one, kind)}


def all_arguments(call: ast.Call) -> tuple[ast.AST, ...]:
    """Return the positional and keyword arguments of a call."""
    return (*call.args, *(one.value for one in call.keywords))


def argument(call: ast.Call, place: int, *names: str) -> ast.AST | None:
    """Return an argument by its index or its name."""
    named = {one.arg: one.value for one in call.keywords}
    given = next((named[name] for name in names if name in named), None)
    return given or (call.args[place] if len(call.args) > place else None)

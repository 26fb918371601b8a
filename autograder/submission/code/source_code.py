"""
Search the syntax trees of student code: calls, arguments, values of names, functions.

The code is never run, and the results choose messages but not verdicts.  A syntax tree has no
comments, so a call in a comment is not found.
"""

import ast
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
import copy
from functools import cached_property
import operator

from autograder.submission.code.program import (
    all_arguments,
    argument,
    assigned,
    dotted,
    FUNCTIONS,
    is_stored,
    last_name,
    names_in,
    NotPythonError,
    parsed,
)

_ARITHMETIC: Mapping[type[ast.AST], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
_MOST = 3  # maximum nesting of names and operations: hostile code may have thousands
Scope = tuple[ast.AST, str]
"""A function or a file, and a name in it; a dot precedes the names in its classes."""
Function = ast.FunctionDef | ast.AsyncFunctionDef


class Code:
    """The student's Python files as syntax trees, without files that Python cannot parse."""

    about: Sequence[str] = ()
    lines: Collection[int] = ()

    def __init__(self, files: Mapping[str, str]) -> None:
        self.trees: list[ast.AST] = []
        for name, text in sorted(files.items()):
            if name.endswith('.py'):
                with suppress(NotPythonError):
                    self.trees.append(parsed(text))
        self.nodes = [node for tree in self.trees for node in ast.walk(tree)]

    def asked(self, about: Sequence[str], lines: Collection[int]) -> 'Code':
        """Return this code with a question about it, see :func:`.acts.place_of`."""
        asked = copy.copy(self)
        asked.about, asked.lines = about, lines
        return asked

    # -- what the code contains ------------------------------------------------------------------

    @cached_property
    def calls(self) -> Mapping[str, Sequence[ast.Call]]:
        """Return the calls by the last part of the called name, such as ``isnan``."""
        found: dict[str, list[ast.Call]] = {}
        for node in self.nodes:
            if isinstance(node, ast.Call):
                found.setdefault(last_name(node.func), []).append(node)
        return found

    def calls_to(self, *names: str) -> list[ast.Call]:
        """Return the calls to functions; ``warn`` is another name for ``warning`` of loggers."""
        names = (*names, 'warn') if 'warning' in names else names
        return [call for name in dict.fromkeys(names) for call in self.calls.get(name, ())]

    @cached_property
    def functions(self) -> Mapping[str, Sequence[Function]]:
        """Return the functions and methods by name; classes may share method names."""
        found: dict[str, list[Function]] = {}
        for node in self.nodes:
            if isinstance(node, FUNCTIONS):
                found.setdefault(node.name, []).append(node)
        return found

    def functions_named(self, *names: str) -> list[Function]:
        """Return the functions and methods with the given names."""
        return [one for name in names for one in self.functions.get(name, ())]

    @cached_property
    def names(self) -> frozenset[str]:
        """Return all names and attributes that are used, and all functions that are defined."""
        return (frozenset(map(last_name, self.nodes)) | set(self.functions)) - {''}

    @cached_property
    def texts(self) -> set[str]:
        """Return all string literals, including docstrings."""
        constants = (node.value for node in self.nodes if isinstance(node, ast.Constant))
        return {value for value in constants if isinstance(value, str)}

    @cached_property
    def strings(self) -> Sequence[ast.AST]:
        """Return the strings and f-strings, without docstrings."""
        return [
            node
            for node in self.nodes
            if (isinstance(node, ast.JoinedStr) or isinstance(getattr(node, 'value', None), str))
            and not isinstance(self.parents.get(node), (ast.JoinedStr, ast.Expr))
        ]

    def defines(self, name: str) -> bool:
        """Return whether a name is defined, assigned, or in quotes (as for ``setattr``)."""
        stored = (one for one in self.nodes if is_stored(one))
        return name in self.functions or name in self.texts or name in map(last_name, stored)

    def has_field(self, name: str) -> bool:
        """Return whether an attribute, a keyword argument or a string has a name."""
        attributes = (one for one in self.nodes if isinstance(one, ast.Attribute))
        return name in (*map(last_name, attributes), *self.texts) or any(self.given(name))

    def defines_unused(self, name: str) -> bool:
        """Return whether a function is defined but neither called nor passed as an argument."""
        bare = {node.value for node in self.nodes if isinstance(node, ast.Expr)}
        loads = (one for one in self.nodes if isinstance(getattr(one, 'ctx', None), ast.Load))
        used = any(last_name(one) == name and one not in bare for one in loads)
        return name in self.names and not used

    def parameters(self, name: str) -> Sequence[str] | None:
        """Return a function's positional parameters; None if it is undefined or has ``*args``."""
        *_, function = (None, *self.functions_named(name))
        if function is None or function.args.vararg:
            return None
        return [one.arg for one in (*function.args.posonlyargs, *function.args.args)]

    @property
    def undefined_names(self) -> frozenset[str]:
        """Return the names that are used but neither imported nor defined in the files."""
        kinds = (ast.alias, ast.ClassDef, ast.arg)
        made = {one.id for one in self.nodes if isinstance(one, ast.Name) and is_stored(one)}
        for node in self.nodes:
            if isinstance(node, kinds):
                name = getattr(node, 'asname', '') or getattr(node, 'name', '')
                made.add(name.partition('.')[0] or getattr(node, 'arg', ''))
        used = {one.id for one in self.nodes if isinstance(one, ast.Name)}
        return frozenset() if '*' in made else frozenset(used - made - set(self.functions))

    @property
    def has_loop(self) -> bool:
        """Return whether there is a ``while`` or ``for`` loop; comprehensions do not count."""
        return any(isinstance(node, (ast.While, ast.For, ast.AsyncFor)) for node in self.nodes)

    @property
    def can_exit(self) -> bool:
        """Return whether the code can exit, other than by the usual ``sys.exit(main())``."""
        exits = self.calls_to('exit', '_exit', 'quit')
        given = (call.args[0] if call.args else None for call in exits)
        mains = (isinstance(one, ast.Call) and last_name(one.func) == 'main' for one in given)
        return 'SystemExit' in self.names or not all(mains)

    # -- what surrounds a node, and what callbacks reach -----------------------------------------

    @cached_property
    def parents(self) -> Mapping[ast.AST, ast.AST]:
        """Return the parent of each node."""
        return {child: node for node in self.nodes for child in ast.iter_child_nodes(node)}

    def around(self, node: ast.AST) -> Iterator[ast.AST]:
        """Yield the nodes around a node, from the inside."""
        while found := self.parents.get(node):
            yield found
            node = found

    def function_around(self, *nodes: ast.AST) -> Function | None:
        """Return the innermost function around all nodes, None if there is none."""
        each = [[one for one in self.around(node) if isinstance(one, FUNCTIONS)] for node in nodes]
        common = (one for one in each[0] if all(one in others for others in each)) if each else ()
        return next(iter(common), None)

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
            if isinstance(one, ast.Lambda):
                yield one
            yield from self.functions_named(last_name(one))

    def passed(self, name: str) -> Iterator[ast.AST]:
        """Yield the functions and lambdas that are passed to a call."""
        for call in self.calls_to(name):
            yield from self.bodies(*all_arguments(call))

    def reached(
        self, bodies: Iterable[ast.AST], seen: set[ast.AST] | None = None
    ) -> Iterator[ast.AST]:
        """Yield functions and all that they call, directly or not; skip and extend ``seen``."""
        seen, left = set() if seen is None else seen, list(bodies)
        for body in left:
            if body not in seen:
                seen.add(body)
                yield body
                calls = (one for one in ast.walk(body) if isinstance(one, ast.Call))
                left += self.functions_named(*dict.fromkeys(last_name(one.func) for one in calls))

    # -- arguments, operations and values --------------------------------------------------------

    def arguments(self, name: str, place: int) -> Iterator[ast.AST]:
        """Yield the argument at a given index from each call to a function."""
        for call in self.calls_to(name):
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

    @cached_property
    def values(self) -> Mapping[Scope | None, Sequence[ast.AST | None]]:
        """Return the values assigned to each name in its scope; None for an unknown value."""
        found: dict[Scope | None, list[ast.AST | None]] = {}
        for node in self.nodes:
            for target, value in assigned(node):
                found.setdefault(self._scope(target), []).append(value)
        return found

    def _scope(self, target: ast.AST) -> Scope | None:
        """Return the scope in which a name gets a value, None for a target without a name."""
        kinds = (*FUNCTIONS, ast.ClassDef)
        inner = next((one for one in self.around(target) if isinstance(one, kinds)), None)
        in_class = isinstance(inner, ast.ClassDef) and not isinstance(target, ast.Attribute)
        scopes = tuple(self._scopes(target)) or (None,)
        return scopes[-1 if in_class else 0]

    def _scopes(self, node: ast.AST) -> Iterator[Scope]:
        """Yield the scopes in which a name may have a value, the innermost first."""
        if not isinstance(node, (ast.Attribute, ast.Name, ast.arg)):
            return
        *around, file = (node, *self.around(node))
        name = last_name(node) or getattr(node, 'arg', '')
        if isinstance(node, ast.Attribute):
            yield file, dotted(node)
        else:
            yield from ((one, name) for one in around if isinstance(one, FUNCTIONS))
            yield file, name
        yield file, f'.{name}'  # of a class

    def values_of(self, node: ast.AST) -> Sequence[ast.AST | None]:
        """Return the values assigned to a name; None for an unknown value."""
        return next(filter(None, map(self.values.get, self._scopes(node))), ())

    def origin(self, node: ast.AST) -> ast.AST:
        """Return the only value of a name; for any other node, the node itself."""
        for _ in range(_MOST):
            found = self.values_of(node)
            if len(found) != 1 or found[0] is None:
                break
            node = found[0]
        return node

    def numbers(self, name: str) -> Sequence[float]:
        """Return the numbers that calls to a function have as their first argument."""
        given = (one for call in self.arguments(name, 0) for one in self.sources(call))
        found = map(self.number, given)
        return [one for one in found if one is not None]

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
        given = (argument(call, place, node.id) for call in self.calls_to(called))
        return [one for one in given if one is not None]

    def number(self, node: ast.AST, most: int = _MOST) -> float | None:
        """Return the value of a number or of simple nested arithmetic, None for anything else."""
        node = self.origin(node)
        with suppress(ArithmeticError):
            if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
                return float(node.value)
            if isinstance(node, ast.BinOp) and most and (apply := _ARITHMETIC.get(type(node.op))):
                left, right = (self.number(one, most - 1) for one in (node.left, node.right))
                return None if left is None or right is None else apply(left, right)
        return None

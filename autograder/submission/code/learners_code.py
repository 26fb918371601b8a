"""
Analyse student code as a syntax tree, without running it, to choose messages but not verdicts.

A syntax tree has no comments, so a call in a comment is not found.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache
import io
import tokenize

from autograder.submission.code.python_text import NotPythonError, parsed

_DEFS = (ast.FunctionDef, ast.AsyncFunctionDef)
SHORT_S = 0.1
"""Calls of ``sleep`` for less than this time [s] are ignored."""


@lru_cache(maxsize=64)  # tokenising a line with thousands of f-strings takes a second
def without_texts(code: str) -> str:
    """Return code with its comments and strings (except f-strings) replaced by blanks."""
    lines = [list(line) for line in io.StringIO(code)]
    with suppress(tokenize.TokenError, SyntaxError, ValueError, RecursionError, MemoryError):
        for token in tokenize.generate_tokens(io.StringIO(code).readline):
            text = token.type == tokenize.STRING and token.string[0] not in 'fF'
            if not text and token.type != tokenize.COMMENT:
                continue
            (first, begin), (last, end) = token.start, token.end
            for number in range(first - 1, last):
                left = begin if number == first - 1 else 0
                right = end if number == last - 1 else len(lines[number]) - 1
                lines[number][left:right] = ' ' * (right - left)
    return ''.join(char for line in lines for char in line)


def trees(files: Mapping[str, str]) -> Iterator[ast.Module]:
    """Yield the syntax tree of each Python file, without files that Python cannot parse."""
    for name, text in sorted(files.items()):
        if name.endswith('.py'):
            with suppress(NotPythonError):
                yield parsed(text)


def texts_in(files: Mapping[str, str]) -> set[str]:
    """Return all string literals in the code, including docstrings."""
    return Code(files).texts


class Code:
    """
    The student's Python files as syntax trees, without files that Python cannot parse.

    :param files: the student's files, relative path to text
    """

    def __init__(self, files: Mapping[str, str]) -> None:
        self.trees = tuple(trees(files))
        self.nodes = tuple(node for tree in self.trees for node in ast.walk(tree))

    @cached_property
    def calls(self) -> Mapping[str, Sequence[ast.Call]]:
        """Return the calls by the last part of the called name, such as ``isnan``."""
        found: dict[str, list[ast.Call]] = {}
        for node in self.nodes:
            if isinstance(node, ast.Call):
                found.setdefault(last_name(node.func), []).append(node)
        return found

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
    def functions(self) -> Mapping[str, ast.FunctionDef | ast.AsyncFunctionDef]:
        """Return all defined functions and methods by name."""
        return {node.name: node for node in self.nodes if isinstance(node, _DEFS)}

    def makes(self, name: str) -> bool:
        """Return whether a name is defined, assigned, or in quotes (as for ``setattr``)."""
        return name in self.functions or any(
            (isinstance(one, ast.Constant) and one.value == name)
            or (
                isinstance(one, (ast.Name, ast.Attribute))
                and _is_made(one)
                and last_name(one) == name
            )
            for one in self.nodes
        )

    def parameters(self, name: str) -> Sequence[str] | None:
        """Return a function's positional parameters; None if it is undefined or has ``*args``."""
        function = self.functions.get(name)
        if function is None or function.args.vararg:
            return None
        return [one.arg for one in (*function.args.posonlyargs, *function.args.args)]

    @property
    def unmade(self) -> frozenset[str]:
        """Return the names that are used but neither imported nor defined in the files."""
        used = {one.id for one in self.nodes if isinstance(one, ast.Name)}
        made = {one.id for one in self.nodes if isinstance(one, ast.Name) and _is_made(one)}
        made |= {one.name for one in self.nodes if isinstance(one, ast.ClassDef)}
        made |= {one.arg for one in self.nodes if isinstance(one, ast.arg)}
        for node in self.nodes:
            if isinstance(node, (ast.Import, ast.ImportFrom)):
                made |= {(one.asname or one.name).partition('.')[0] for one in node.names}
        return frozenset() if '*' in made else frozenset(used - made - set(self.functions))

    @property
    def loops(self) -> bool:
        """Return whether there is a ``while`` or ``for`` loop; comprehensions do not count."""
        return any(isinstance(node, (ast.While, ast.For, ast.AsyncFor)) for node in self.nodes)

    @property
    def catches_all(self) -> bool:
        """Return whether an ``except`` catches every exception."""
        caught = (node.type for node in self.nodes if isinstance(node, ast.ExceptHandler))
        kinds = (one.elts if isinstance(one, ast.Tuple) else [one] for one in caught)
        all_kinds = {last_name(one) if one else 'Exception' for some in kinds for one in some}
        return not all_kinds.isdisjoint({'Exception', 'BaseException'})

    @property
    def ends_itself(self) -> bool:
        """Return whether the code can exit, other than by the usual ``sys.exit(main())``."""
        exits = (call for name in ('exit', '_exit', 'quit') for call in self.calls.get(name, ()))
        given = (call.args[0] if call.args else None for call in exits)
        mains = (isinstance(one, ast.Call) and last_name(one.func) == 'main' for one in given)
        return 'SystemExit' in self.names or not all(mains)

    def defines_unused(self, name: str) -> bool:
        """Return whether a function is defined but neither called nor passed as an argument."""
        bare = {node.value for node in self.nodes if isinstance(node, ast.Expr)}
        loads = (one for one in self.nodes if isinstance(getattr(one, 'ctx', None), ast.Load))
        used = any(last_name(one) == name and one not in bare for one in loads)
        return name in self.names and not used

    def first_numbers(self, name: str) -> Iterator[float]:
        """Yield the first argument of each call of a function if it is a number or names one."""
        for tree in self.trees:
            known = values_by_name(tree)
            for node in ast.walk(tree):
                if isinstance(node, ast.Call) and last_name(node.func) == name and node.args:
                    value = followed(node.args[0], known)
                    if isinstance(value, ast.Constant) and isinstance(value.value, (int, float)):
                        yield float(value.value)


def _is_made(name: ast.Name | ast.Attribute) -> bool:
    return isinstance(name.ctx, ast.Store)


def last_name(node: ast.AST) -> str:
    """Return the last part of a name, with or without dots; empty for any other node."""
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ''


# -- fields of messages ---------------------------------------------------------------------


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


# -- values of names -------------------------------------------------------------------------


def values_by_name(tree: ast.Module) -> dict[str, ast.AST | None]:
    """Return the value of each name in a file; None if it has several values or is changed."""
    known: dict[str, ast.AST | None] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.arg):
            known[node.arg] = None  # a parameter, whose value is unknown
        if isinstance(node, (ast.AnnAssign, ast.AugAssign)):
            known[last_name(node.target)] = None
        if isinstance(node, ast.Assign):
            for target in node.targets:
                name = last_name(target)
                known[name] = None if name in known else node.value
                if isinstance(target, ast.Attribute):  # as in qos.depth = 10
                    known[last_name(target.value)] = None
    return known


def followed(node: ast.AST | None, known: Mapping[str, ast.AST | None]) -> ast.AST | None:
    """Return the value of a name (not followed further), or any other expression itself."""
    named = isinstance(node, (ast.Name, ast.Attribute))
    return known.get(last_name(node)) if node is not None and named else node


# -- pauses in callbacks --------------------------------------------------------------------


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
    for tree in trees(files):
        for name, body in bodies_of_callbacks(tree):
            if line := _pause(body):
                return Pause(name, line)
    return None


def bodies_of_callbacks(tree: ast.Module) -> Iterator[tuple[str, ast.AST]]:
    """
    Yield each function that a callback reaches, once, with the name of that callback.

    A callback is a lambda or a function of the file that is passed to any call except ``Thread``.
    """
    functions: dict[str, list[ast.AST]] = {}  # several classes may have a method of the same name
    for node in ast.walk(tree):
        if isinstance(node, _DEFS):
            functions.setdefault(node.name, []).append(node)
    handed = (
        given
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and last_name(node.func) != 'Thread'
        for given in (*node.args, *(one.value for one in node.keywords))
    )
    seen: set[ast.AST] = set()  # a file may have thousands of callbacks
    for callback in handed:
        name = last_name(callback)
        left = [callback] if isinstance(callback, ast.Lambda) else [*functions.get(name, ())]
        for body in left:
            if body in seen:
                continue
            seen.add(body)
            yield name, body
            called = (last_name(one.func) for one in ast.walk(body) if isinstance(one, ast.Call))
            left += [inner for one in called for inner in functions.get(one, ())]


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

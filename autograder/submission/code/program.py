"""
Parse a program, and read single nodes of its syntax tree: names, values, arguments.

The code is never run, and the results affect only messages.
"""

import ast
from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
import io
import threading
import tokenize
import warnings

FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_ONE_AT_A_TIME = threading.Lock()
"""Serialises calls to the parser: Python before 3.11.5 shares the recursion depth between threads,
and warnings are switched off for all threads."""


class NotPythonError(ValueError):
    """Report that Python cannot parse a string as code."""


def parsed(text: str, mode: str = 'exec') -> ast.AST:
    """Return the syntax tree of a file, or of one expression ('eval'); raise a NotPythonError."""
    try:
        with _ONE_AT_A_TIME, warnings.catch_warnings():
            warnings.simplefilter('ignore')  # such as invalid escape sequences in student code
            return ast.parse(text, mode=mode)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise NotPythonError(str(error)) from None


@lru_cache(maxsize=64)  # tokenising a line with thousands of f-strings takes a second
def without_strings(code: str) -> str:
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


def dotted(node: ast.AST) -> str:
    """Return a name with its dots, such as ``self.count``; any other base becomes ``()``."""
    parts = []
    while isinstance(node, ast.Attribute):  # hostile code: a name with thousands of dots
        parts.append(node.attr)
        node = node.value
    return '.'.join((last_name(node) or '()', *reversed(parts)))


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

"""
Analyse student code as a syntax tree, without running it, to choose messages but not verdicts.

A syntax tree has no comments, so a call in a comment is not found.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cached_property, lru_cache
import io
import tokenize

from autograder.submission.code.program import FUNCTIONS, is_stored, last_name, Program
from autograder.submission.code.python_text import NotPythonError, parsed


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


class Code:
    """
    The student's Python files as syntax trees, without files that Python cannot parse.

    :param files: the student's files, relative path to text
    """

    def __init__(self, files: Mapping[str, str]) -> None:
        self.trees = tuple(_trees(files))
        self.nodes = tuple(node for tree in self.trees for node in ast.walk(tree))

    @cached_property
    def programs(self) -> Sequence[Program]:
        """Return each file with what its names mean."""
        return tuple(map(Program, self.trees))

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
        return {node.name: node for node in self.nodes if isinstance(node, FUNCTIONS)}

    def makes(self, name: str) -> bool:
        """Return whether a name is defined, assigned, or in quotes (as for ``setattr``)."""
        return name in self.functions or any(
            (isinstance(one, ast.Constant) and one.value == name)
            or (is_stored(one) and last_name(one) == name)
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
        made = {one.id for one in self.nodes if isinstance(one, ast.Name) and is_stored(one)}
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


def _trees(files: Mapping[str, str]) -> Iterator[ast.Module]:
    for name, text in sorted(files.items()):
        if name.endswith('.py'):
            with suppress(NotPythonError):
                yield parsed(text)

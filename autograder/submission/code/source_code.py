"""
Analyse student code as a syntax tree, without running it, to choose messages but not verdicts.

The functions find mistakes: log calls that skip lines, pauses, unset fields.

A syntax tree has no comments, so a call in a comment is not found.
"""

import ast
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cached_property, lru_cache
import io
import tokenize
from typing import NamedTuple

from autograder.submission.code.program import (
    all_arguments,
    FUNCTIONS,
    is_stored,
    last_name,
    NotPythonError,
    parsed,
    Program,
)

SHORT_S = 0.1
"""Calls to ``sleep`` for less than this time [s] are ignored."""
_LEAVE_OUT = ('throttle_duration_sec', 'once', 'skip_first')


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


class Code:
    """
    The student's Python files as syntax trees, without files that Python cannot parse.

    :param files: the student's files, relative path to text
    """

    def __init__(self, files: Mapping[str, str]) -> None:
        self.programs: list[Program] = []
        for name, text in sorted(files.items()):
            if name.endswith('.py'):
                with suppress(NotPythonError):
                    self.programs.append(Program(parsed(text)))
        self.nodes = [node for one in self.programs for node in one.nodes]

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

    def defines(self, name: str) -> bool:
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
    def undefined_names(self) -> frozenset[str]:
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
    def has_loop(self) -> bool:
        """Return whether there is a ``while`` or ``for`` loop; comprehensions do not count."""
        return any(isinstance(node, (ast.While, ast.For, ast.AsyncFor)) for node in self.nodes)

    @property
    def can_exit(self) -> bool:
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


def leaves_out(files: Mapping[str, str], level: str, lines: Collection[int] = ()) -> str:
    """
    Return the argument that makes log calls in callbacks skip lines; empty if one logs every line.

    :param level: the log calls, such as ``warning``
    :param lines: consider only calls in these lines; empty for all calls
    """
    programs = Code(files).programs
    made = (one for code in programs for one in code.calls(level) if code.is_working(one))
    found = [_leaves_out(call) for call in made if not lines or call.lineno in lines]
    return found[0] if found and all(found) else ''


def _leaves_out(call: ast.Call) -> str:
    """Return the argument that makes a log call skip lines; False, 0 and None have no effect."""
    given = (one for one in call.keywords if one.arg in _LEAVE_OUT)
    return next((one.arg or '' for one in given if getattr(one.value, 'value', True)), '')


def logs_with_python(files: Mapping[str, str], level: str) -> bool:
    """
    Return whether all log calls of a level use Python's module ``logging``.

    :param level: the log calls, such as ``warning``
    """
    found: list[bool] = []
    for program in Code(files).programs:
        theirs = set(_logging_names(program)) - {''}  # '' is for targets without a name: items[0]
        for call in program.calls(level):
            if isinstance(call.func, ast.Attribute):
                by = call.func.value
                made = isinstance(by, ast.Call) and last_name(by.func) == 'getLogger'
                found.append(made or last_name(by) in theirs)
    return bool(found) and all(found)


def _logging_names(program: Program) -> Iterator[str]:
    """Yield the names in a file for the module ``logging`` and for its loggers."""
    for node in program.nodes:
        if isinstance(node, ast.Import):
            yield from (one.asname or one.name for one in node.names if one.name == 'logging')
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Call):
            made = last_name(node.value.func) == 'getLogger'
            yield from map(last_name, node.targets if made else ())


class FieldUse(NamedTuple):
    """
    How code uses a field of a message.

    :param given: whether the field may get a value: the code has an attribute, keyword argument
        or string with its name
    :param empty: whether one of the assigned values is a call to ``Time`` without arguments
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
    code = Code(files)
    values = [value for one in code.programs for value in one.given(field)]
    named = (one for one in code.nodes if last_name(one) == field)
    kinds = {(type(one), is_stored(one)) for one in named}
    # A name in quotes may be an argument of setattr(), or a key in a dictionary of fields.
    given = bool(values) or field in code.texts or any(ast.Attribute in one for one in kinds)
    return FieldUse(given, any(map(_is_empty_time, values)), (ast.Name, True) in kinds)


def _is_empty_time(value: ast.AST) -> bool:
    """Return whether a value contains ``Time()``, as in ``Time().to_msg()``."""
    calls = (one for one in ast.walk(value) if isinstance(one, ast.Call))
    return any(last_name(one.func) == 'Time' and not all_arguments(one) for one in calls)


class Pause(NamedTuple):
    """
    A call to ``sleep`` that a callback reaches.

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
    for program in Code(files).programs:
        for name, body in program.callbacks():
            if line := _pause(body):
                return Pause(name, line)
    return None


def _pause(body: ast.AST) -> int | None:
    """Return the line of the first pause in a function, None if there is none."""
    others: set[ast.AST] = set()
    for node in ast.walk(body):
        if isinstance(node, ast.While):
            others.update(ast.walk(node))
        elif isinstance(node, ast.Await):
            others.add(node.value)
    sleeps = (one for one in ast.walk(body) if isinstance(one, ast.Call) and one not in others)
    return min(
        (one.lineno for one in sleeps if last_name(one.func) == 'sleep' and not _is_short(one)),
        default=None,
    )


def _is_short(call: ast.Call) -> bool:
    """Return whether a pause is certainly too short to matter."""
    value = call.args[0].value if call.args and isinstance(call.args[0], ast.Constant) else None
    return isinstance(value, (int, float)) and value < SHORT_S

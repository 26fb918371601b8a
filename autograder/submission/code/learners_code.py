"""
What a learner's code says, read as Python and never run: it decides words, not verdicts.

Comments and texts are no code: a call that is named in a comment calls nothing.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
import io
import re
import tokenize

from autograder.submission.code.python_text import NotPythonError, parsed

_TEXTS = ('COMMENT', 'STRING', 'FSTRING_MIDDLE')
_FORMATTED = re.compile(r'(?:[fF][rR]?|[rR][fF])(?P<quote>"""|\'\'\'|"|\')')
_CALLBACKS = {'create_timer': 1, 'create_subscription': 2, 'create_service': 2}
"""At which place the functions of rclpy take a callback."""
SHORT_S = 0.1
"""A pause [s] that nobody notices."""


@lru_cache(maxsize=64)  # Python needs a second for a line with thousands of f-strings
def without_texts(code: str) -> str:
    """Return code with blanks for its comments and texts, as far as Python can read it."""
    texts = list(io.StringIO(code))
    # Characters, as a line may have thousands of texts.
    lines = [list(text) for text in texts]
    tokens: list[tokenize.TokenInfo] = []
    with suppress(tokenize.TokenError, SyntaxError, ValueError, RecursionError, MemoryError):
        for token in tokenize.generate_tokens(io.StringIO(code).readline):
            tokens.append(token)
    for token in tokens:
        if tokenize.tok_name[token.type] not in _TEXTS:
            continue
        (first, begin), (last, end) = token.start, token.end
        # Before Python 3.12, an f-string is one token, the code in its braces included.
        parts = iter(_blanked(token.string).splitlines())
        for number in range(first - 1, min(last, len(lines))):
            left = begin if number == first - 1 else 0
            right = end if number == last - 1 else len(texts[number].rstrip('\r\n'))
            lines[number][left:right] = next(parts, '').ljust(right - left)
    return ''.join(char for line in lines for char in line)


def _blanked(text: str) -> str:
    """Return a token with blanks for what is text in it; an f-string keeps quotes and braces."""
    found = _FORMATTED.match(text)
    if found is None:
        return ''.join(char if char in '\r\n' else ' ' for char in text)
    begin, end = found.end(), len(text) - len(found['quote'])
    inside = 0
    kept = [text[:begin]]
    for char in text[begin:end]:
        inside += char == '{'
        kept.append(char if inside > 0 or char in '\r\n' else ' ')
        inside -= char == '}' and inside > 0
    return ''.join([*kept, text[end:]])


def trees(files: Mapping[str, str]) -> Iterator[ast.Module]:
    """Yield the syntax tree of each file that Python can read."""
    for name, text in sorted(files.items()):
        if name.endswith('.py'):
            with suppress(NotPythonError):
                yield parsed(text)


def texts_in(files: Mapping[str, str]) -> set[str]:
    """Return the texts between quotes, documentation among them."""
    return {
        node.value
        for tree in trees(files)
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }


def calls(files: Mapping[str, str], name: str) -> bool:
    """
    Tell whether a function of a name is called, by itself or as a method.

    :param name: its last part, such as ``isnan``
    """
    return any(
        isinstance(node, ast.Call) and last_name(node.func) == name
        for tree in trees(files)
        for node in ast.walk(tree)
    )


def last_name(node: ast.AST) -> str:
    """Return the last part of a name with or without dots, empty for anything else."""
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ''


# -- fields of messages ---------------------------------------------------------------------


@dataclass(frozen=True)
class FieldUse:
    """
    What code does with a field of a message.

    :param given: whether it may get a value: it, a part of it or an argument of its name is there
    :param empty: whether one of those values is a call of ``Time`` without arguments
    :param local: whether a variable of the field's name gets a value
    """

    given: bool
    empty: bool
    local: bool


def use_of_field(files: Mapping[str, str], field: str) -> FieldUse:
    """
    Return what code does with a field.

    :param field: its name, such as ``timestamp``
    """
    values: list[ast.AST | None] = []
    local = False
    for tree in trees(files):
        for node in ast.walk(tree):
            values += _values_given(node, field)
            stored = isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
            local = local or (stored and last_name(node) == field)
    return FieldUse(bool(values), any(map(_is_empty_time, values)), local)


def _values_given(node: ast.AST, field: str) -> list[ast.AST | None]:
    """Return what a field gets in one place of the tree, None for what cannot be told."""
    if isinstance(node, ast.Assign):
        return [node.value for target in node.targets if _reaches(target, field)]
    if isinstance(node, ast.keyword) and node.arg == field:
        return [node.value]
    # A name in quotes is given to setattr(), or is the key of a dictionary of fields.
    named = isinstance(node, ast.Constant) and node.value == field
    # What is written by a way of its own: a loop, with, another name for the same object.
    written = isinstance(node, ast.Attribute) and node.attr == field
    return [None] if named or written else []


def _reaches(target: ast.AST, field: str) -> bool:
    """Tell whether an assignment's target is a field or a part of it."""
    while isinstance(target, ast.Attribute):
        if target.attr == field:
            return True
        target = target.value
    return False


def _is_empty_time(value: ast.AST | None) -> bool:
    """Tell whether a value is ``Time()``, or that turned into a message."""
    if isinstance(value, ast.Call) and last_name(value.func) == 'to_msg':
        value = value.func.value if isinstance(value.func, ast.Attribute) else None
    if not isinstance(value, ast.Call):
        return False
    return last_name(value.func) == 'Time' and not value.args and not value.keywords


# -- queues ---------------------------------------------------------------------------------


def subscription_depths(files: Mapping[str, str]) -> list[int | None]:
    """
    Return the depth of each subscription that is created, None where it cannot be read.

    It is read if it is a number or a ``QoSProfile`` with one, or a name that gets one value only.
    """
    found: list[int | None] = []
    for tree in trees(files):
        known = _values_by_name(tree)
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and last_name(node.func) == 'create_subscription':
                named = [one.value for one in node.keywords if one.arg == 'qos_profile']
                given = [*named, *node.args[3:4]]
                found.append(_depth(given[0], known) if given else None)
    return found


def _values_by_name(tree: ast.Module) -> dict[str, ast.AST | None]:
    """Return what names get in a file, None for what gets several values or is changed."""
    known: dict[str, ast.AST | None] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.arg):
            known[node.arg] = None  # whatever is passed
        if isinstance(node, (ast.AnnAssign, ast.AugAssign)):
            known[last_name(node.target)] = None
        if isinstance(node, ast.Assign):
            for target in node.targets:
                name = last_name(target)
                known[name] = None if name in known else node.value
                if isinstance(target, ast.Attribute):  # as in qos.depth = 10
                    known[last_name(target.value)] = None
    return known


def _depth(node: ast.AST | None, known: Mapping[str, ast.AST | None]) -> int | None:
    """Return the depth that an expression stands for; names in it are followed once."""
    if isinstance(node, (ast.Name, ast.Attribute)):
        return _depth(known.get(last_name(node)), {})
    if isinstance(node, ast.Call) and last_name(node.func) == 'QoSProfile':
        given = {one.arg: one.value for one in node.keywords}
        # A history of its own may be one that keeps all; two stars hide what is given.
        return None if {'history', None} & set(given) else _depth(given.get('depth'), known)
    if isinstance(node, ast.Constant) and type(node.value) is int:
        return node.value
    return None


# -- pauses in callbacks --------------------------------------------------------------------


@dataclass(frozen=True)
class Pause:
    """
    A call of ``sleep`` that a callback comes to.

    :param callback: name of the function that ROS calls, empty for a lambda
    :param line: of the file, from 1
    """

    callback: str
    line: int


def pause_in_callback(files: Mapping[str, str]) -> Pause | None:
    """
    Return the first pause in a function that is given to a timer, a subscription or a service.

    What such a function calls in the same file belongs to it.  ``await asyncio.sleep()`` lets
    others work and is none; nor is a pause in a ``while`` loop, which is the one to blame.
    """
    for tree in trees(files):
        for name, body in bodies_of_callbacks(tree):
            if line := _pause(body):
                return Pause(name, line)
    return None


def bodies_of_callbacks(tree: ast.Module) -> Iterator[tuple[str, ast.AST]]:
    """Yield each function that a callback comes to, once, with the name of that callback."""
    functions = {
        node.name: node
        for node in ast.walk(tree)
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
    }
    seen: set[int] = set()
    for callback in _callbacks(tree):
        name = last_name(callback)
        for body in _reached(functions.get(name, callback), functions, seen):
            yield name, body


def _callbacks(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield what is given as a callback: a name, a method or a lambda."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or last_name(node.func) not in _CALLBACKS:
            continue
        place = _CALLBACKS[last_name(node.func)]
        given = [one.value for one in node.keywords if one.arg == 'callback']
        for callback in given or node.args[place : place + 1]:
            if isinstance(callback, ast.Call) and last_name(callback.func) == 'partial':
                yield from callback.args[:1]
            else:
                yield callback


def _reached(
    first: ast.AST, functions: Mapping[str, ast.AST], seen: set[int]
) -> Iterator[ast.AST]:
    """
    Yield a function and those that it calls, in this file.

    :param seen: what was yielded before, without a pause: a file may have thousands of callbacks
    """
    left = [first]
    for body in left:
        if id(body) in seen:
            continue
        seen.add(id(body))
        yield body
        for node in ast.walk(body):
            called = functions.get(last_name(node.func)) if isinstance(node, ast.Call) else None
            if called is not None and id(called) not in seen:
                left.append(called)


def _pause(body: ast.AST) -> int | None:
    """Return the line of the first pause in a function."""
    if not isinstance(body, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
        return None
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
    """Tell whether a pause is surely so short that nothing waits for it."""
    value = call.args[0].value if call.args and isinstance(call.args[0], ast.Constant) else None
    return isinstance(value, (int, float)) and value < SHORT_S

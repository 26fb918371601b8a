"""Parse students' Python code in several threads, without running it."""

from __future__ import annotations

import ast
import threading
from typing import Literal
import warnings

_ONE_AT_A_TIME = threading.Lock()
"""Serialises calls of the parser: Python before 3.11.5 shares the recursion depth between threads,
and warnings are switched off for all threads."""


class NotPythonError(ValueError):
    """Report that Python cannot parse a text."""


def parsed(text: str) -> ast.Module:
    """
    Return the syntax tree of a file.

    :raises NotPythonError: if Python cannot parse it
    """
    tree = _read(text, 'exec')
    assert isinstance(tree, ast.Module)
    return tree


def expression(text: str) -> ast.AST:
    """
    Return the syntax tree of one expression.

    :raises NotPythonError: if Python cannot parse it
    """
    return _read(text, 'eval')


def _read(text: str, mode: Literal['exec', 'eval']) -> ast.AST:
    try:
        with _ONE_AT_A_TIME, warnings.catch_warnings():
            warnings.simplefilter('ignore')  # such as invalid escape sequences in student code
            return ast.parse(text, mode=mode)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise NotPythonError(str(error)) from None

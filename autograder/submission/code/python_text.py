"""Learners' Python as a syntax tree: read by several threads, never run."""

from __future__ import annotations

import ast
import threading
from typing import Literal
import warnings

_ONE_AT_A_TIME = threading.Lock()
"""Python before 3.11.5 counts the depth of a tree for all threads together, and warnings are
switched off for all of them."""


class NotPythonError(ValueError):
    """Python cannot read a text."""


def parsed(text: str) -> ast.Module:
    """
    Return the syntax tree of a file.

    :raises NotPythonError: if Python cannot read it
    """
    tree = _read(text, 'exec')
    assert isinstance(tree, ast.Module)
    return tree


def expression(text: str) -> ast.AST:
    """
    Return the syntax tree of one expression.

    :raises NotPythonError: if Python cannot read it
    """
    return _read(text, 'eval')


def _read(text: str, mode: Literal['exec', 'eval']) -> ast.AST:
    try:
        with _ONE_AT_A_TIME, warnings.catch_warnings():
            warnings.simplefilter('ignore')  # about odd escapes in a learner's text
            return ast.parse(text, mode=mode)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise NotPythonError(str(error)) from None

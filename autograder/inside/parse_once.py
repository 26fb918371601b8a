"""
Parse each message definition once a build, and not once for each of its generators.

Five programs generate code from one definition, and each parses its text, which is most of its
work (0.14 s of processor time for one message).  Here the first one writes the tree down, as JSON,
and the others read it.
"""

from __future__ import annotations

from collections.abc import Callable
import hashlib
import json
import os
from pathlib import Path
from typing import Any


def parse_once(parse: Callable[[str], Any], folder: Path) -> Callable[[str], Any]:
    """
    Return a parser that looks first for what another process has parsed.

    :param parse: rosidl's own, from a text to a tree of lark
    :param folder: where the trees are kept, which exists
    """

    def parsed(text: str) -> Any:
        path = folder / f'{hashlib.sha256(text.encode()).hexdigest()}.json'
        try:
            return to_tree(json.loads(path.read_text(encoding='utf-8')))
        except FileNotFoundError:
            pass
        tree = parse(text)
        written = path.with_suffix(f'.{os.getpid()}')
        written.write_text(json.dumps(to_json(tree)), encoding='utf-8')
        written.replace(path)
        return tree

    return parsed


def to_json(node: Any) -> list[Any]:
    """Return a tree of lark as lists: a name and its children, or a token's type and text."""
    if hasattr(node, 'children'):
        return [str(node.data), [to_json(child) for child in node.children]]
    return [node.type, str(node)]


def to_tree(found: list[Any]) -> Any:
    """Return the tree of :func:`to_json`'s lists."""
    from lark import Token, Tree

    name, rest = found
    if isinstance(rest, str):
        return Token(name, rest)
    return Tree(name, [to_tree(one) for one in rest])

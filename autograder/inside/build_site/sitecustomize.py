"""
Parse each message definition once a build, and not once for each of its generators.

Seven programs generate code from one definition.  Each compiles the grammar of IDL and parses the
text, which is three quarters of its work (0.4 s of processor time for two messages).  Here the
first one writes the tree down, as JSON in the folder that :data:`KEPT_IN` names, and the others
read it.  Python imports a module of this name by itself; only builds find this one.
"""

from __future__ import annotations

from collections.abc import Callable
import hashlib
import json
import os
from pathlib import Path
import sys
import types
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))
from when_imported import when_imported  # type: ignore[import-not-found]

del sys.path[0]

KEPT_IN = 'ROS2_COURSE_PARSED'


def change(parser: types.ModuleType) -> None:
    """Have rosidl's parser of definitions look first for what another process has parsed."""
    folder = Path(os.environ[KEPT_IN])
    parse: Callable[[str], Any] = parser.get_ast_from_idl_string

    def parse_once(text: str) -> Any:
        path = folder / f'{hashlib.sha256(text.encode()).hexdigest()}.json'
        try:
            return to_tree(json.loads(path.read_text(encoding='utf-8')))
        except FileNotFoundError:
            pass
        tree = parse(text)
        written = path.with_suffix(f'.{os.getpid()}')
        folder.mkdir(exist_ok=True)
        written.write_text(json.dumps(to_json(tree)), encoding='utf-8')
        written.replace(path)
        return tree

    parser.get_ast_from_idl_string = parse_once  # type: ignore[attr-defined]


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


if KEPT_IN in os.environ:
    when_imported('rosidl_parser.parser', change)

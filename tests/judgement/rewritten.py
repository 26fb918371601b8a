"""
Rewrite programs without changing their behaviour: other comments, names, order and layout.

A recording contains the behaviour of a program, so the same recording with a rewritten text must
get the same verdicts.
"""

import ast
from collections.abc import Mapping
import io
import tokenize

MISLEADING = '  # self.destroy_node() print(self) create_timer spin_once( time.sleep(9) once=True'


def blanked(files: Mapping[str, str]) -> dict[str, str]:
    """Return files whose Python code is empty."""
    return {name: '' if name.endswith('.py') else text for name, text in files.items()}


def commented(files: Mapping[str, str]) -> dict[str, str]:
    """Return files with a misleading comment after each statement, on the same line."""
    return {
        name: _commented(text) if name.endswith('.py') else text for name, text in files.items()
    }


def _commented(text: str) -> str:
    lines = text.splitlines(keepends=True)
    try:
        tokens = list(tokenize.generate_tokens(io.StringIO(text).readline))
    except (tokenize.TokenError, SyntaxError):
        return text
    ends = {token.start[0] for token in tokens if token.type == tokenize.NEWLINE}
    ends -= {token.start[0] for token in tokens if token.type == tokenize.COMMENT}
    for number in ends:
        line = lines[number - 1]
        lines[number - 1] = line.rstrip('\n') + MISLEADING + '\n' * line.endswith('\n')
    return ''.join(lines)


def rewritten(files: Mapping[str, str]) -> dict[str, str]:
    """Return files without comments and docstrings, with other local names, order and layout."""
    return {
        name: _rewritten(text) if name.endswith('.py') else text for name, text in files.items()
    }


def _rewritten(text: str) -> str:
    try:
        tree = ast.parse(text)
    except SyntaxError:
        return text
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            _rename_locals(node)
        if isinstance(node, ast.ClassDef):
            _turn_methods_around(node)
        if isinstance(node, (ast.FunctionDef, ast.ClassDef, ast.Module)) and _says(node.body[:1]):
            node.body = node.body[1:] or [ast.Pass()]
    return ast.unparse(tree)


def _says(first: list[ast.stmt]) -> bool:
    """Return whether a statement is only a string, like a docstring."""
    return (
        bool(first) and isinstance(first[0], ast.Expr) and isinstance(first[0].value, ast.Constant)
    )


def _rename_locals(function: ast.FunctionDef | ast.AsyncFunctionDef) -> None:
    """Rename the local variables of a function without nested scopes."""
    inside = list(ast.walk(function))
    scopes = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Lambda, ast.ListComp)
    if any(isinstance(one, (*scopes, ast.Global, ast.Nonlocal)) for one in inside[1:]):
        return
    made = {
        one.id for one in inside if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)
    }
    for one in inside:
        if isinstance(one, ast.Name) and one.id in made:
            one.id = f'{one.id}_0'


def _turn_methods_around(class_: ast.ClassDef) -> None:
    """Reverse the order of a class's methods, in the positions of methods."""
    places = [
        place
        for place, one in enumerate(class_.body)
        if isinstance(one, ast.FunctionDef) and not one.decorator_list
    ]
    names = {class_.body[place].name for place in places}  # type: ignore[attr-defined]
    if len(names) == len(places):
        turned = [class_.body[place] for place in reversed(places)]
        for place, method in zip(places, turned):
            class_.body[place] = method

"""
Start a node file inside the sandbox, the way ``ros2 run`` would.

Usage: run_node.py FILE [arguments of the program].  The file runs as a script.  If it only defines
``main`` and leaves the call to an entry point, ``main()`` is called afterwards.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
import sys
import types

import gate  # type: ignore[import-not-found]  # beside this file, inside the sandbox


def outside_definitions(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield all nodes that are executed when the file is, without those of functions."""
    for child in ast.iter_child_nodes(tree):
        if not isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
            yield child
            yield from outside_definitions(child)


def leaves_main_to_others(tree: ast.Module) -> bool:
    """Tell whether the file neither calls ``main`` nor asks whether it is the script."""
    names = {node.id for node in outside_definitions(tree) if isinstance(node, ast.Name)}
    return not names & {'main', '__name__'}


def main() -> None:
    """Run the file that the command line names."""
    gate.wait()
    path, sys.argv = sys.argv[1], sys.argv[1:]
    source = Path(path).read_text(encoding='utf-8')
    tree = ast.parse(source, path)  # a SyntaxError ends the program with Python's own message
    sys.path.insert(0, str(Path(path).parent))
    module = types.ModuleType('__main__')
    module.__file__ = path
    sys.modules['__main__'] = module
    exec(compile(source, path, 'exec'), module.__dict__)
    if leaves_main_to_others(tree) and callable(getattr(module, 'main', None)):
        module.main()


if __name__ == '__main__':
    main()

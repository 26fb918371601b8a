"""
Start a node file inside the sandbox, the way ``ros2 run`` would.

Usage: run_node.py FILE [arguments of the program].  A file with an ``if __name__ == '__main__'``
block, or one that is a plain script, runs as a script; a file that only defines ``main`` is
imported and ``main()`` is called, as an entry point does.
"""

from __future__ import annotations

import ast
import importlib.util
from pathlib import Path
import runpy
import sys

import gate  # type: ignore[import-not-found]  # beside this file, inside the sandbox


def runs_by_itself(source: str) -> bool:
    """Tell whether executing the file as a script starts something."""
    for statement in ast.parse(source).body:
        calls = isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call)
        loops = isinstance(statement, (ast.While, ast.For, ast.Try, ast.With))
        tests = isinstance(statement, ast.If) and '__name__' in ast.dump(statement.test)
        if calls or loops or tests:
            return True
    return False


def main() -> None:
    """Run the file that the command line names."""
    gate.wait()
    path, sys.argv = sys.argv[1], sys.argv[1:]
    sys.path.insert(0, str(Path(path).parent))
    try:
        by_itself = runs_by_itself(Path(path).read_text(encoding='utf-8'))
    except SyntaxError:
        by_itself = True  # Python's own message, with the line, is the best there is
    if by_itself:
        runpy.run_path(path, run_name='__main__')
        return
    name = Path(path).stem
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    if hasattr(module, 'main'):
        module.main()
    else:
        print(f'{Path(path).name} defines no main() and starts nothing.', file=sys.stderr)


if __name__ == '__main__':
    main()

"""
Start a node file inside the sandbox as ``ros2 run`` would.

Usage: run_node.py FILE [arguments of the program].  The file runs as a script.  If it defines
``main`` but leaves the call to an entry point, this program calls ``main()`` afterwards.  Without
arguments, this program forks on request (:mod:`autograder.inside.forks`), and each fork gets its
arguments from the grader.

The file can import a folder of modules next to it as a package, even if the folder has the name of
the course's message package: in an installed package, modules and messages share one folder.  If
such a folder contains a copy of the file, the file runs as a module of that package, as with an
entry point.
"""

import ast
from collections.abc import Iterator
from contextlib import suppress
import gc
import importlib
import importlib.util
import inspect
from pathlib import Path
import sys
import types

import gate  # type: ignore[import-not-found]  # next to this file, inside the sandbox
from rclpy_patches import patch_rclpy, use_lazy_imports  # type: ignore[import-not-found]

INSIDE = Path('/grader/inside')
NO_PACKAGE = ('test', 'tests', 'launch', 'config')
OF_EVERY_NODE = ('rcl_interfaces', 'type_description_interfaces', 'rosgraph_msgs')
"""Message packages that every node loads."""
INNER = ('builtin_interfaces', 'service_msgs', 'std_msgs')
"""Packages whose messages most nodes use, mostly as fields of other messages."""


def outside_definitions(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield all nodes of a syntax tree except those inside functions."""
    for child in ast.iter_child_nodes(tree):
        if not isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
            yield child
            yield from outside_definitions(child)


def never_calls_main(tree: ast.Module) -> bool:
    """Return whether the file neither calls ``main`` nor checks ``__name__``."""
    names = {node.id for node in outside_definitions(tree) if isinstance(node, ast.Name)}
    return not names & {'main', '__name__'}


def join_packages(folder: Path) -> list[Path]:
    """
    Extend installed packages with the folders of the same name, which take precedence.

    :returns: all package folders in the folder of the node file
    """
    packages = sorted({file.parent for file in folder.glob('*/*.py')})
    packages = [one for one in packages if one.name.isidentifier() and one.name not in NO_PACKAGE]
    for package in packages:
        with suppress(ImportError, ValueError):
            if importlib.util.find_spec(package.name) is not None:
                installed = importlib.import_module(package.name)
                installed.__path__ = [str(package), *installed.__path__]
    return packages


def import_common_modules() -> None:
    """
    Import what every node imports, while the probe is still starting.

    Submodules of rclpy are not imported, because that could hide a missing import in the program.
    """
    # The threads and processes that these imports start have ended when the grader releases the
    # program, so the first line of the program runs exactly at the release.
    import rclpy  # noqa: F401
    from rosidl_generator_py import import_type_support  # type: ignore[import-untyped]

    for package in OF_EVERY_NODE:
        for kind in ('msg', 'srv'):
            with suppress(ImportError):
                importlib.import_module(f'{package}.{kind}')
    for package in (*OF_EVERY_NODE, *INNER):
        import_type_support(package)  # loads only libraries, no Python module
    importlib.import_module('concurrent.futures')
    # Fill the cache of inspect, because the first log line looks up the file of each module.
    inspect.getmodule(inspect.currentframe())


def arguments_of_fork() -> list[str]:
    """Fork on request, and return the arguments of the program in each fork."""
    import forks  # type: ignore[import-not-found]

    arguments: list[str] = forks.serve()
    # The student's modules may have the same names as the grader's.
    sys.path[0] = str(INSIDE)
    for module in ('forks', 'confine'):
        del sys.modules[module]
    return arguments


def main() -> None:
    """Run the file that the command line names."""
    gc.disable()  # imported modules are never garbage
    use_lazy_imports()
    patch_rclpy()
    import_common_modules()
    gc.freeze()
    if len(sys.argv) == 1:
        sys.argv += arguments_of_fork()
    gc.enable()
    gate.wait()
    path, sys.argv = sys.argv[1], sys.argv[1:]
    source = Path(path).read_text(encoding='utf-8')
    tree = ast.parse(source, path)  # a SyntaxError ends the program with Python's own message
    packages = join_packages(Path(path).parent)
    sys.path.insert(0, str(Path(path).parent))
    module = types.ModuleType('__main__')
    for package in packages:
        if any(file.read_text(encoding='utf-8') == source for file in package.glob('*.py')):
            module.__package__ = package.name
    module.__file__ = path
    sys.modules['__main__'] = module
    exec(compile(source, path, 'exec'), module.__dict__)
    if never_calls_main(tree) and callable(getattr(module, 'main', None)):
        module.main()


if __name__ == '__main__':
    main()

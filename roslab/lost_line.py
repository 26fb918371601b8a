"""
Refuse to run a whole program as an ordinary cell if its ``%%node`` line is missing.

In a notebook ``__name__`` is always ``'__main__'``, so the program's ``main()`` would run in the
cell, spin there and never return.
"""

import ast
from pathlib import Path
from typing import Any

from IPython.core.error import InputRejected

from autograder.exam import catalog
from roslab.error_hints import running_cell
from roslab.errors import RoslabError


class NodeLineMissingError(RoslabError, InputRejected):
    """Raised for a cell that is a whole program without its ``%%node`` line; it was not run."""


class ProgramsRefused(ast.NodeTransformer):
    """The hook that IPython calls on the syntax tree of each cell before running it."""

    def __init__(self, shell: Any) -> None:
        self._shell = shell

    def visit_Module(self, tree: ast.Module) -> ast.Module:
        """
        Return the syntax tree of a cell unchanged.

        :raises NodeLineMissingError: if the cell would start a ROS program that spins forever
        """
        if _goes_on(tree) and any(map(_is_start, tree.body)):
            raise NodeLineMissingError(
                'this cell is a whole program, and the notebook would wait for its main() '
                f'forever. It was not run. Write this as its first line: %%node {self._name()}'
            )
        return tree

    def _name(self) -> str:
        """Return the file name that the ``%%node`` line probably had, or a placeholder."""
        cell = running_cell(self._shell)
        if cell is None:
            return 'my_node'
        if cell.module:  # the saved notebook still contains the line
            return cell.module
        for name in catalog.names(hidden=False):
            exam = catalog.load(name, hidden=False)
            if cell.grade_id and cell.grade_id in exam.cells:
                files = [Path(file) for file in exam.requires if file.endswith('.py')]
                return files[0].stem if files else 'my_node'
        return 'my_node'


def refuse_programs(shell: Any) -> None:
    """Install the hook that refuses cells that are whole programs."""
    shell.ast_transformers.append(ProgramsRefused(shell))


def _goes_on(tree: ast.Module) -> bool:
    """Return whether a cell uses ROS and spins, through rclpy or in its own loop."""
    nodes = list(ast.walk(tree))
    ros = any(isinstance(node, ast.Name) and node.id == 'rclpy' for node in nodes)
    loops = any(isinstance(node, ast.While) for node in nodes)
    called = (ast.unparse(node.func) for node in nodes if isinstance(node, ast.Call))
    return ros and (loops or any(name.rpartition('.')[2].startswith('spin') for name in called))


def _is_start(statement: ast.stmt) -> bool:
    """Return whether a statement starts the program: ``if __name__ ...`` or a bare ``main()``."""
    if isinstance(statement, ast.If):
        return ast.unparse(statement.test) in (
            "__name__ == '__main__'",
            "'__main__' == __name__",
        )
    return isinstance(statement, ast.Expr) and ast.unparse(statement) == 'main()'

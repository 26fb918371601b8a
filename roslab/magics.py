"""
Save a cell as a file: the magics ``%%node``, ``%%rosmsg``, ``%%rospkg`` and ``%%answer``.

Each magic saves its cell in the learner's package, so the notebook runs, colcon builds and the
grader judges the same text.  ``%%node NAME`` also runs the cell as the module NAME;
``%%answer`` prints the letter that it recognised.  An ordinary cell that contains a whole program
has probably lost its ``%%node`` line.  In a notebook ``__name__`` is always ``'__main__'``, so the
program's ``main()`` would run in the cell, spin there and never return: such a cell is refused.
"""

import ast
from collections.abc import Callable
import importlib.util
from pathlib import Path
import sys
from types import ModuleType
from typing import Any

from IPython.core.error import InputRejected
from IPython.core.magic import no_var_expand

from autograder.exam import catalog
from autograder.submission.cells import (
    CellFile,
    CellSyntaxError,
    chosen_letter,
    NotALetterError,
    parse_cell,
)
from roslab.error_hints import running_cell
from roslab.errors import (
    AnswerRefusedError,
    NameRefusedError,
    NodeSyntaxError,
    not_written_yet,
    RoslabError,
)
from roslab.output import say
from roslab.package_files import learner_package, LearnerPackage, note_save
from roslab.tracebacks import code_name, where

KINDS = ('node', 'rosmsg', 'rospkg', 'answer')


def register(shell: Any) -> None:
    """Register the magics with an IPython shell."""
    for kind in KINDS:
        shell.register_magic_function(_magic(shell, kind), 'cell', kind)
    if _keep_empty_body not in shell.input_transformers_cleanup:
        shell.input_transformers_cleanup.append(_keep_empty_body)


def _magic(shell: Any, kind: str) -> Callable[[str, str], None]:
    @no_var_expand
    def magic(line: str, cell: str) -> None:
        __tracebackhide__ = True
        run_cell(kind, line, cell, shell.user_ns)

    magic.__doc__ = f'Save the cell in the package; see roslab.magics (%%{kind}).'
    return magic


def _keep_empty_body(lines: list[str]) -> list[str]:
    """Add an empty body to a magic line without one, because IPython would reject the line."""
    alone = len(lines) == 1 and lines[0].startswith(tuple(f'%%{kind}' for kind in KINDS))
    return [*lines, '\n'] if alone else lines


def run_cell(kind: str, line: str, cell: str, namespace: dict[str, Any]) -> None:
    """Save a cell and, if it is a ``%%node`` cell, run it and add its names to ``namespace``."""
    __tracebackhide__ = True
    package = learner_package()
    file = _read(kind, line, cell)
    if kind == 'node':
        _refuse_known_module(file, package)
    path = package.save(file)
    note_save(path)
    lines = 'line' if file.body.count('\n') == 1 else 'lines'
    saved = f'Saved {package.shown(path)} ({file.body.count(chr(10))} {lines})'
    if kind == 'answer':
        _say_letter(file)
    elif kind == 'node':
        module = _run_node(file, path)
        skipped = _export(module, namespace)
        defined = _defined(module)
        say(f'{saved}{f"; defined {defined}" if defined else ""}.')
        for name in skipped:
            say(f'Other cells cannot use your {name}: in the notebook, this is roslab.{name}.')
    elif file.unsolved or not file.body.strip():
        where = 'in place of YOUR CODE HERE' if file.unsolved else 'below the first line'
        raise not_written_yet(
            f'%%{kind} {file.name} is not written yet: write your lines {where}, then run '
            'the cell again.'
        )
    else:
        say(f'{saved}.')


def _say_letter(file: CellFile) -> None:
    """Print which answer the grader will read; the file is saved in any case."""
    __tracebackhide__ = True
    try:
        letter = chosen_letter(file.body)
    except NotALetterError as error:
        hint = 'Put the letter in quotes.' if error.reason == 'no_quotes' else 'Write one letter.'
        raise AnswerRefusedError(f'%%answer {file.name}: {error}. {hint}') from None
    if letter is None:
        raise not_written_yet(
            f"%%answer {file.name} is not written yet: write 'a', 'b', 'c' or 'd' in place of "
            'None, then run the cell again.'
        )
    say(f'Saved your answer to {file.name}: {letter}')


def _read(kind: str, line: str, cell: str) -> CellFile:
    __tracebackhide__ = True
    try:
        file = parse_cell(f'%%{kind} {line.strip()}\n{cell}')
    except CellSyntaxError as error:
        raise NameRefusedError(str(error)) from None
    assert file is not None  # the first line is always a magic of this module
    return file


def _refuse_known_module(file: CellFile, package: LearnerPackage) -> None:
    """Refuse a file name that another module already uses, such as rclpy."""
    __tracebackhide__ = True
    loaded = sys.modules.get(file.name)
    origin = getattr(loaded, '__file__', None)
    if loaded is None:
        spec = importlib.util.find_spec(file.name)
        if spec is None:
            return
        origin = spec.origin
    ours = origin is not None and (
        Path(origin) == package.path_of(file) or Path(origin).parent == package.root
    )
    if not ours:
        raise NameRefusedError(
            f'%%node {file.name}: a Python module with that name already exists, and importing '
            'it would no longer work. Choose a different name, as in %%node temp_publisher.'
        )


def _run_node(file: CellFile, path: Path) -> ModuleType:
    """Run the saved text as a module; tracebacks show the lines of the cell."""
    __tracebackhide__ = True
    # Compile under a file name that stands for the cell, so that messages show the cell's lines.
    name = code_name(f'%%node {file.name}\n{file.body}', str(path))
    tree = _without_main_call(_parse(file, name))
    module = ModuleType(file.name)
    module.__file__ = str(path)
    sys.modules[file.name] = module
    try:
        exec(compile(tree, name, 'exec', dont_inherit=True), module.__dict__)
    except NotImplementedError as error:
        sys.modules.pop(file.name, None)
        reason = str(error) or 'write it in place of the stub, then run the cell again.'
        raise not_written_yet(f'%%node {file.name} is not written yet: {reason}') from None
    except BaseException:
        sys.modules.pop(file.name, None)
        raise
    return module


def _parse(file: CellFile, name: str) -> ast.Module:
    __tracebackhide__ = True
    try:
        tree = ast.parse(file.body, name)
    except SyntaxError as error:
        line = (error.lineno or 1) + file.first_line
        text = (error.text or '').rstrip('\n')
        caret = ' ' * max(0, (error.offset or 1) - 1) + '^'
        said = f'{error.msg}\n  {where(name, line)}\n    {text}\n    {caret}'
        raise NodeSyntaxError(said) from None
    ast.increment_lineno(tree, file.first_line)
    return tree


def _without_main_call(tree: ast.Module) -> ast.Module:
    """Remove a bare ``main()`` at the top level, which would block the notebook."""
    for statement in tree.body:
        if isinstance(statement, ast.Expr) and ast.unparse(statement).startswith('main('):
            say(
                f'Line {statement.lineno} of the cell calls main() whenever the file is read. The '
                'call was skipped, because this cell would never end. Write the call below: '
                "if __name__ == '__main__':"
            )
            tree.body = [other for other in tree.body if other is not statement]
    return tree


def _export(module: ModuleType, namespace: dict[str, Any]) -> list[str]:
    """Copy public names to the notebook; return those that would hide roslab's own names."""
    import roslab

    skipped = []
    for name, value in vars(module).items():
        if name.startswith('_'):
            continue
        own = getattr(roslab, name, None) if name in roslab.__all__ else None
        if own is not None and value is not own and namespace.get(name) is own:
            skipped.append(name)
        else:
            namespace[name] = value
    return skipped


def _defined(module: ModuleType) -> str:
    names = [
        name
        for name, value in vars(module).items()
        if not name.startswith('_') and getattr(value, '__module__', None) == module.__name__
    ]
    return ', '.join(names)


class NodeLineMissingError(RoslabError, InputRejected):
    """Raised for a cell that is a whole program without its ``%%node`` line; it was not run."""


class ProgramsRefused(ast.NodeTransformer):
    """The hook that IPython calls on the syntax tree of each cell before running it."""

    def __init__(self, shell: Any) -> None:
        self._shell = shell

    def visit_Module(self, tree: ast.Module) -> ast.Module:
        """Return a cell unchanged; NodeLineMissingError if it would start a ROS program."""
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

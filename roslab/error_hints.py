"""
Show what to do next instead of a traceback.

The course's kernel loads this IPython extension.  Some errors come from the order in which cells
were run, or from the notebook itself; the extension shows each of them as one sentence.  The
exception object is unchanged, so code that catches it is not affected.  All other errors are
shown as usual.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
import json
import os
from pathlib import Path
import re
import symtable
import sys
import textwrap
import traceback
from typing import Any

from IPython.core.error import UsageError
from IPython.core.inputtransformer2 import TransformerManager

from autograder.submission.cells import CellFile, CellSyntaxError, parse_cell
from roslab.errors import RoslabError
from roslab.interrupts import interrupted
from roslab.output import current_cell
from roslab.tracebacks import is_library, where

_SHOWN = 44
"""Number of characters shown of a cell's first line, enough to find the cell."""
_INIT_TWICE = 'Context.init() must only be called once'
_NO_INIT = (
    'RuntimeError: rclpy.init() was called, but ROS 2 runs in this notebook already. '
    'Remove that call, and do not call main() here: start(...) runs a node in the background.'
)
_INVALID_HANDLE = (
    'InvalidHandle: this node, or the node that owns this object, was stopped or replaced. '
    'Run first: the cell that starts that node.'
)
_ORDER = (
    'If the message above does not help: not all cells above this one were run to the end and in '
    'order. Run first: all of them, with the menu Run, Run All Above Selected Cell.'
)

_MAGICS = str(Path(__file__).with_name('magics.py'))
_MAGIC_BELOW = re.compile(r'Line magic function `(%%\w+)` not found')

_SENTENCES = (RoslabError, NotImplementedError, TimeoutError)
"""The course's own errors, whose messages already explain what to do."""

_WRITTEN_WRONGLY = (SyntaxError, UsageError)
"""Errors that running the cells in a different order would not have prevented."""

_failed: set[int] = set()
"""Numbers of executions that failed, except for those of unwritten exercises."""
_executed: dict[int, str] = {}
"""Ids of executed cells by execution number; a cell's text may differ from the saved file."""


@dataclass(frozen=True)
class NotebookCell:
    """
    A code cell of the notebook.

    :param identifier: its id in the notebook file
    :param file: the file that a cell such as ``%%node`` saves
    :param grade_id: nbgrader id of an exercise's cell
    :param execution: the n of its ``In [n]``, None if the saved notebook has none
    """

    identifier: str
    heading: str
    source: str
    file: CellFile | None
    grade_id: str = ''
    execution: int | None = None

    @property
    def module(self) -> str | None:
        """The module that a ``%%node`` cell creates."""
        return self.file.name if self.file and self.file.kind == 'node' else None

    @property
    def names(self) -> frozenset[str]:
        """The names that the cell defines in the notebook."""
        if self.file is None:
            return defined_names(self.source)
        names = defined_names(self.file.body) if self.module else frozenset()
        return frozenset(name for name in names if name[0] != '_')

    @property
    def place(self) -> str:
        """Return a description of where the cell is."""
        first = next((line.strip() for line in self.source.splitlines() if line.strip()), '')
        shown = textwrap.shorten(first, _SHOWN, placeholder=' ...')
        section = f'in "{self.heading}", ' if self.heading else ''
        return f'{section}the cell that begins with: {shown}'


def load_ipython_extension(shell: Any) -> None:
    """Install the handler that shows a sentence instead of a traceback where that helps more."""
    if _show not in getattr(shell, '_course_guides', ()):
        shell._course_guides = (_show,)
        shell.set_custom_exc((Exception, KeyboardInterrupt), _show)
        shell.events.register('pre_run_cell', lambda _: _note(shell))


def advice(error: BaseException, shell: Any) -> str | None:
    """Return the text that replaces the traceback of an error; None for the usual traceback."""
    at_once = isinstance(error, KeyboardInterrupt) or isinstance(
        error.__context__, KeyboardInterrupt
    )
    own = _raised_by_learner(error)
    if at_once or (interrupted() and not own):
        return _interrupted(error)
    if isinstance(error, UsageError) and (found := _MAGIC_BELOW.match(str(error))):
        return (
            f'UsageError: {found[1]} has to be the first line of its cell. Move all lines above '
            'it, even comments, below it, and run the cell again.'
        )
    if type(error) is NotImplementedError and own:
        return _not_written(error)
    if type(error).__name__ == 'InvalidHandle':
        return _INVALID_HANDLE
    if type(error) is RuntimeError and str(error) == _INIT_TWICE:
        return _NO_INIT
    if type(error) in (NameError, ModuleNotFoundError) and own:
        return _find_defining_cell(error, shell)
    return None


def _find_defining_cell(error: Any, shell: Any) -> str | None:
    """Return a hint at the cell that defines a missing name or module, None if no cell does."""
    missing, is_module = error.name, isinstance(error, ModuleNotFoundError)
    if not missing:
        return None
    # Ignore comments: only a call in code can pass a bare name to check().
    if re.search(rf'(?m)^[^#\n]*\bcheck\(\s*{re.escape(missing)}\b', _history(shell)[-1]):
        return (
            f'NameError: check() takes the name of an exercise in quotes. Write: '
            f'check({missing!r})'
        )
    cell = _first_cell_with(missing, is_module, shell)
    if cell is None:
        return None
    kind = 'module ' if is_module else ''
    return f'{type(error).__name__}: {kind}{missing} does not exist yet. Run first: {cell.place}'


def advice_shown(error: BaseException) -> str:
    """Return the sentence that replaced the traceback of an error, empty if there was none."""
    shown: str = getattr(error, '_course_advice', '')
    return shown or (str(error) if hasattr(error, '_render_traceback_') else '')


def notebook_path() -> Path | None:
    """Return the path of this notebook, or None if it is unknown."""
    named = os.environ.get('JPY_SESSION_NAME', '')  # set by Jupyter's servers
    if named.endswith('.ipynb') and Path(named).is_file():
        return Path(named)
    here = sorted(Path.cwd().glob('*.ipynb'))
    return here[0] if len(here) == 1 else None


def running_cell(shell: Any) -> NotebookCell | None:
    """Return the running cell as last saved, or None if it is unknown."""
    cells = read_cells()
    here = _running_index(cells, shell)
    return cells[here] if here is not None else None


def read_cells(path: Path | None = None) -> list[NotebookCell]:
    """Return the code cells of a notebook, by default the running one, as last saved, or none."""
    path = path or notebook_path()
    if path is None:
        return []
    try:
        cells = json.loads(path.read_text(encoding='utf-8'))['cells']
        return list(_code_cells(cells))
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return []


def texts_now(shell: Any) -> list[str]:
    """Return the source of the code cells, as last run or otherwise as saved; none if unknown."""
    saved = read_cells()
    if not saved:
        return []
    ran = dict(enumerate(_history(shell)))
    texts = {cell.identifier or number: cell.source for number, cell in enumerate(saved)}
    texts |= {_executed[number]: ran[number] for number in sorted(_executed) if number in ran}
    nameless = [text for number, text in ran.items() if number not in _executed]
    return [*texts.values(), *nameless]


def defined_names(source: str) -> frozenset[str]:
    """Return the names that a cell binds at the top level; the cell may contain magics."""
    first, _, below = source.partition('\n')
    captured = re.match(r'%%capture\s+([A-Za-z_]\w*)', first)
    names = {captured[1]} if captured else set()
    try:
        plain = TransformerManager().transform_cell(below if first.startswith('%%') else source)
        symbols = symtable.symtable(plain, 'cell', 'exec').get_symbols()
    except (SyntaxError, ValueError, RecursionError):
        return frozenset(names)
    if re.search(r'(?m)^from roslab import \*', plain):
        names |= set(sys.modules['roslab'].__all__)
    bound = (one.get_name() for one in symbols if one.is_assigned() or one.is_imported())
    return frozenset(names | set(bound))


def _show(shell: Any, kind: Any, error: BaseException, trace: Any, tb_offset: Any = None) -> None:
    said = None
    if (inside := _inside_magic(trace)) is not None:
        trace, tb_offset = inside, 0
    own_words = getattr(error, '_render_traceback_', None)
    # If this extension itself fails, still show the learner's error.
    with suppress(Exception):
        if own_words is None or not isinstance(error, _SENTENCES):
            said = advice(error, shell)
            alone = said is not None and own_words is None
            if not isinstance(error, _WRITTEN_WRONGLY):
                said = said or _out_of_order(shell)
        # NotImplementedError is normal: the exercises above may not be solved yet.
        if not isinstance(error, NotImplementedError):
            _failed.add(len(_history(shell)) - 1)
    if said is None:
        # An error without a frame of the learner's code is a syntax error; hide IPython's frames.
        own = any(not is_library(frame.filename) for frame in _frames(error))
        shell.showtraceback((kind, error, trace), tb_offset=tb_offset, running_compiled_code=own)
        return
    # Store the error as IPython does, so that explain() can find it.
    sys.last_type, sys.last_value, sys.last_traceback = kind, error, trace
    with suppress(AttributeError):  # some errors, such as frozen dataclasses, refuse attributes
        error._course_advice = said  # type: ignore[attr-defined]
    lines: list[str] = []
    if own_words is not None:
        lines = own_words()
    elif not alone:
        lines = shell.InteractiveTB.structured_traceback(kind, error, trace, tb_offset=tb_offset)
    shell._showtraceback(kind, error, [*lines, said])


def _inside_magic(trace: Any) -> Any:
    """Return the part of a traceback inside a ``%%`` cell, or None."""
    inside = None
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == _MAGICS:
            inside = trace.tb_next
        trace = trace.tb_next
    return inside


def _history(shell: Any) -> Sequence[str]:
    return getattr(shell.history_manager, 'input_hist_raw', None) or ('',)


def _cell_id() -> str | None:
    running = current_cell()
    return running.request.get('metadata', {}).get('cellId') if running else None


def _note(shell: Any) -> None:
    """Record which cell is about to run."""
    number = len(_history(shell))
    _executed.pop(number, None)
    if identifier := _cell_id():
        _executed[number] = identifier


def _out_of_order(shell: Any) -> str | None:
    """Return a hint if the cells above the running cell were not run in order, else None."""
    cells = read_cells()
    here = _running_index(cells, shell)
    if not here:
        return None
    index = {cell.source.strip(): number for number, cell in enumerate(cells)}
    places = {cell.identifier: at for at, cell in enumerate(cells) if cell.identifier}
    ran: list[int] = []
    for number, source in enumerate(_history(shell)[:-1]):
        at = places.get(_executed.get(number, ''), index.get(source.strip()))
        if at is not None and at < here and number not in _failed:
            ran = [*(other for other in ran if other != at), at]
    above = [number for number, cell in enumerate(cells[:here]) if cell.source.strip()]
    return None if ran[-len(above) :] == above else _ORDER


def _interrupted(error: BaseException) -> str:
    own = [frame for frame in _frames(error) if not is_library(frame.filename)]
    place = f' in {where(own[-1].filename, own[-1].lineno)}' if own else ''
    return (
        f'KeyboardInterrupt: the cell was interrupted{place}. ROS 2 and the nodes that start(...) '
        'runs keep running.'
    )


def _not_written(error: BaseException) -> str:
    stub = _frames(error)[-1]
    return (
        f'NotImplementedError in {where(stub.filename, stub.lineno)}: this is not written yet. '
        'Replace that line with your own code, run its cell, then run this one again.'
    )


def _raised_by_learner(error: BaseException) -> bool:
    frames = [f for f in _frames(error) if not f.filename.startswith('<frozen importlib')]
    own = bool(frames) and not is_library(frames[-1].filename)
    # exec() in a cell runs code with this file name.
    return own or (bool(frames) and frames[-1].filename == '<string>')


def _frames(error: BaseException) -> Sequence[traceback.FrameSummary]:
    return traceback.extract_tb(error.__traceback__)


def _first_cell_with(name: str, as_module: bool, shell: Any) -> NotebookCell | None:
    """Return the nearest cell that defines a name, above the running cell if possible."""
    cells = read_cells()
    here = _running_index(cells, shell)
    found = [
        index
        for index, cell in enumerate(cells)
        if index != here and (cell.module == name if as_module else name in cell.names)
    ]
    above = [index for index in found if here is None or index < here]
    chosen = above[-1:] if here is not None and above else found[:1]
    return cells[chosen[0]] if chosen else None


def _running_index(cells: Sequence[NotebookCell], shell: Any) -> int | None:
    identifier, source = _cell_id(), _history(shell)[-1].strip()
    for index, cell in enumerate(cells):
        if cell.identifier == identifier or (source and cell.source.strip() == source):
            return index
    return None


def _code_cells(cells: Sequence[dict[str, Any]]) -> Iterator[NotebookCell]:
    heading = ''
    for cell in cells:
        source = cell['source'] if isinstance(cell['source'], str) else ''.join(cell['source'])
        if cell['cell_type'] == 'markdown':
            titles = re.findall(r'(?m)^#{1,6}\s+(.+?)\s*$', source)
            heading = titles[-1] if titles else heading
        elif cell['cell_type'] == 'code':
            grade_id = cell.get('metadata', {}).get('nbgrader', {}).get('grade_id', '')
            about = heading, source, saved_file(source), grade_id, cell.get('execution_count')
            yield NotebookCell(cell.get('id', ''), *about)


def saved_file(source: str) -> CellFile | None:
    """Return the file that a cell saves, None if it saves none or its first line is wrong."""
    try:
        return parse_cell(source)
    except CellSyntaxError:
        return None

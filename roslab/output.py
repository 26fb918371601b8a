"""
Print text and tables in the correct place.

A notebook frontend gets a table as HTML.  A notebook that is executed without a frontend
(nbclient, nbgrader) gets the same facts as plain text on stdout.  Nothing is written to stderr:
nbgrader treats a single line there as a failed cell.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence, Sized
from html import unescape
from pathlib import Path
import re
import sys
from typing import Any, NamedTuple
from urllib.parse import quote, unquote

from autograder.explaining.feedback_html import section_id
from autograder.submission.notebook import read_release

_HEADING = re.compile(r'^#{1,6} (.+)$', re.MULTILINE)
_SECTION = re.compile(r'href="([^"#]+\.ipynb)#([^"]+)"')


def shell() -> Any | None:
    """Return the running IPython shell, or None outside IPython."""
    if 'IPython' not in sys.modules:
        return None
    from IPython import get_ipython

    return get_ipython()


class Cell(NamedTuple):
    """The execution of a cell: the n of ``In [n]``, and the header and metadata of its request."""

    number: int
    request: Mapping[str, Any]

    @property
    def has_frontend(self) -> bool:
        """Return whether a frontend shows the output: its requests contain the id of the cell."""
        return 'cellId' in self.request.get('metadata', {})


def current_cell() -> Cell | None:
    """Return the cell that is being executed, or None outside a notebook kernel."""
    running = shell()
    get_parent = getattr(running, 'get_parent', None)
    if running is None or get_parent is None:
        return None
    return Cell(running.execution_count, get_parent() or {})


def has_frontend() -> bool:
    """Return whether a notebook frontend shows the running cell."""
    cell = current_cell()
    return cell is not None and cell.has_frontend


def say(text: str) -> None:
    """Print a message at once, so that it keeps its position among the log lines of nodes."""
    print(text, flush=True)


def counted(things: Sized, word: str) -> str:
    """Return the number of things with their name, such as ``1 node`` or ``2 nodes``."""
    return f'{len(things)} {word}{"s" * (len(things) != 1)}'


def text_table(rows: Sequence[Sequence[str]], right: Collection[int] = ()) -> str:
    """Return rows as lines with aligned columns."""
    widths = [max(map(len, column)) for column in zip(*rows)]
    return '\n'.join(
        '  '.join(
            cell.rjust(width) if number in right else cell.ljust(width)
            for number, (cell, width) in enumerate(zip(row, widths))
        ).rstrip()
        for row in rows
    )


def show(text: str, html: str) -> None:
    """Show a table: HTML in a frontend; the same facts as plain text on stdout otherwise."""
    if not has_frontend():
        say(text)
        return
    from IPython.display import display

    display({'text/plain': text, 'text/html': _with_links(html)}, raw=True)


def _with_links(page: str) -> str:
    """
    Return HTML whose links to sections of notebooks work in the frontend of the running cell.

    JupyterLab finds a heading only after it has drawn it, but waits for a cell.  For JupyterLab,
    a link leads to the cell with the heading.

    VS Code opens a link to a section as a second copy of the notebook, without a kernel.  For
    VS Code, a link leads to the heading if it is in the same notebook, otherwise to the whole
    notebook.
    """
    cell = current_cell()
    cell_id = str(cell.request.get('metadata', {}).get('cellId', '')) if cell else ''
    if not cell_id:
        return page
    in_vscode = cell_id.startswith('vscode-notebook-cell')
    return _SECTION.sub(_vscode_link if in_vscode else _jupyterlab_link, page)


def _jupyterlab_link(link: re.Match[str]) -> str:
    address, section = map(unescape, link.groups())
    try:
        cell_id = _cell_with_heading(Path(unquote(address)), section)
    except (OSError, ValueError, KeyError, TypeError):
        cell_id = ''  # not a file here, or not a notebook
    return f'href="{link[1]}#cell-id={quote(cell_id)}"' if cell_id else link[0]


def _cell_with_heading(path: Path, section: str) -> str:
    """Return the id of the cell whose heading has this section id, empty if there is none."""
    for cell in read_release(path)['cells']:
        if cell['cell_type'] == 'markdown':
            headings = _HEADING.findall(cell['source'].replace('`', ''))
            if section in map(section_id, headings):
                return str(cell.get('id', ''))
    return ''


def _vscode_link(link: re.Match[str]) -> str:
    address, section = link.groups()
    heading_id = re.sub(r'[^\w-]', '', unquote(unescape(section)).lower())
    return f'href="{address}"' if '/' in address else f'href="#{heading_id}"'


class ElapsedTime:
    """
    One line that counts the seconds in a frontend; without a frontend, it never changes.

    :param always: print the line even without a frontend
    :param progress: computes the progress from the end of the output so far
    """

    def __init__(
        self,
        text: str,
        always: bool = False,
        progress: Callable[[str], str] = lambda _: '',
    ) -> None:
        self._text = text
        self._always = always
        self._progress = progress
        self._handle: Any = None

    def __enter__(self) -> ElapsedTime:
        if has_frontend():
            from IPython.display import display

            self._handle = display(self._line(f'{self._text} ...'), raw=True, display_id=True)
        elif self._always:
            say(f'{self._text} ...')
        return self

    def tick(self, seconds: float, output: str) -> None:
        """Show the elapsed time [s] and the progress."""
        if self._handle is not None:
            how_far = self._progress(output)
            text = f'{self._text} ... {seconds:.0f} s{how_far and f", {how_far}"}'
            self._handle.update(self._line(text), raw=True)

    def __exit__(self, *_: object) -> None:
        """Remove the line."""
        if self._handle is not None:
            self._handle.update(self._line(''), raw=True)

    @staticmethod
    def _line(text: str) -> dict[str, str]:
        return {'text/plain': text}

"""
Execute the solved lessons, and put their outputs below the cells of the students' lessons.

The cell of an exercise keeps its stub and has no output.  The cells after it show the outputs for
a correct answer, because they would fail without an answer.  These outputs contain no code of an
answer.
"""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
import re

import nbformat
from nbformat.v4 import new_markdown_cell, new_notebook
from traitlets.config import Config

from autograder.authoring.execute import executed
from autograder.authoring.lesson_frame import lesson_map, outlines, START_HERE
from autograder.layout import Layout, lesson_files
from autograder.submission.notebook import marks_of

AT_ONCE = 2
"""Number of lessons executed in parallel; most of the time they wait for messages."""
INDEX = 'index.ipynb'
SHOWN = ('text/html', 'image/svg+xml', 'image/png', 'text/plain')
"""MIME types that a page without a kernel can show, in order of preference."""
LEXER = 'ipython3'
"""Name of the Pygments lexer that supports the magic lines of cells."""
DIAGRAM = re.compile(r'```mermaid\n.*?accTitle: (.*?)\n *accDescr: (.*?)\n.*?```', re.DOTALL)
"""A Mermaid diagram; drawing it needs a script of 3 MB, so the book shows its description."""
YOURS = (
    '*You write this cell in JupyterLab. The outputs from here to the next exercise come from a '
    'correct answer.*'
)
ABOUT = """\
# Reading the lessons

You can read these pages without running anything. Their outputs come from real ROS 2 nodes.
To write nodes of your own, open the lessons in JupyterLab: `make lab`.
"""
CONTENTS = '```{toctree}\n:hidden:\n:glob:\n\n*/*\n```'


def write_pages(layout: Layout, folder: Path) -> None:
    """
    Execute the solved lessons, and write one page for each lesson and a page that lists them.

    :param folder: folder that receives the notebooks that Sphinx reads
    :raises CellExecutionError: if a cell of a solved lesson raised an error
    """
    names = [path.relative_to(layout.notebooks) for path in lesson_files(layout.notebooks)]
    # Name the cell in each request, as JupyterLab does: roslab then shows pictures, not text.
    frontend = Config({'Session': {'metadata': {'cellId': 'book'}}})
    with ThreadPoolExecutor(AT_ONCE) as pool:
        solved = list(
            pool.map(lambda name: executed(layout.solutions / name, config=frontend), names)
        )
    for name, notebook in zip(names, solved):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        released = nbformat.read(layout.notebooks / name, as_version=4)
        nbformat.write(page(released, notebook), folder / name)
    nbformat.write(first_page(layout), folder / INDEX)


def page(release: nbformat.NotebookNode, solved: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """Return the students' lesson with the outputs of the solved one; cell ids are the same."""
    outputs = {cell.id: list(_shown(cell)) for cell in solved.cells if 'outputs' in cell}
    cells, after = [], 0
    for cell in release.cells:
        cells.append(cell)
        if cell.cell_type == 'markdown':
            text = DIAGRAM.sub(r'> **\1.** \2', cell.source)
            cell.source = text.replace(START_HERE, INDEX)
        elif marks_of(cell).get('solution'):
            after = len(cells)  # only the last of several exercises in a row gets the note
        else:
            cell.outputs = outputs[cell.id]
            if cell.outputs and after:
                note = new_markdown_cell(YOURS, id=f'{cells[after - 1].id}-yours'[:64])
                cells.insert(after, note)
                after = 0
    release.cells = cells
    release.metadata.language_info.pygments_lexer = LEXER
    return release


def _shown(cell: nbformat.NotebookNode) -> Iterator[nbformat.NotebookNode]:
    """Yield the outputs of a cell, each in one MIME type; skip those that cannot be shown."""
    for output in cell.outputs:
        if 'data' in output:
            kind = next((one for one in SHOWN if output.data.get(one)), None)
            if kind is None:
                continue
            output.data = {kind: output.data[kind]}
        yield output


def first_page(layout: Layout) -> nbformat.NotebookNode:
    """Return the page that lists the lessons."""
    texts = (ABOUT, lesson_map(outlines(layout.notebooks)), CONTENTS)
    return new_notebook(cells=[new_markdown_cell(text) for text in texts])

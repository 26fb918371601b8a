"""
Execute the solved lessons: ``python -m autograder.authoring.execute [LESSON ...]``.

If a lesson ends without an error, the ROS release and the date are stored in its metadata, and the
course's release copies them into the lesson's contents.
"""

import argparse
import asyncio
from collections.abc import Sequence
from datetime import date
from pathlib import Path
import sys
import tempfile
from typing import Any

from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
import nbformat
from nbformat import NotebookNode

from autograder.files import write_atomically
from autograder.layout import Layout, lesson_files
from autograder.submission.outline import FACTS
from environment.install_files import KERNEL_NAME, KERNEL_TITLE

CELL_TIMEOUT_S = 400
"""Time limit of a cell [s]; a build of messages may take 300 s."""


def executed(path: Path, **more: Any) -> NotebookNode:
    """Return a notebook with its outputs; CellExecutionError if a cell raised an error."""
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory(prefix='lesson_') as folder:  # for the cells' ROS workspace
        client = NotebookClient(
            notebook,
            kernel_name=KERNEL_NAME,
            timeout=CELL_TIMEOUT_S,
            resources={'metadata': {'path': folder}},
            **more,
        )
        asyncio.run(client.async_execute())  # execute() leaves an event loop open
    return notebook


def execute(path: Path) -> None:
    """Execute a notebook and, if no cell raises an error, store the date in its file."""
    executed(path)
    notebook = nbformat.read(path, as_version=4)
    today = date.today()
    facts = notebook.metadata.setdefault(FACTS, {})
    facts['executed'] = f'with {KERNEL_TITLE} on {today.day} {today:%B %Y}'
    write_atomically(path, f'{nbformat.writes(notebook)}\n'.encode())


def main(arguments: Sequence[str] | None = None) -> int:
    """Execute the named lessons, or all; return 0 if all ended without an error, else 1."""
    parser = argparse.ArgumentParser(
        prog='python -m autograder.authoring.execute', description=__doc__
    )
    parser.add_argument('lessons', nargs='*', metavar='LESSON', help='folder, such as 03_topics')
    chosen = parser.parse_args(arguments).lessons
    failed = 0
    for path in lesson_files(Layout.here().solutions):
        name = path.parent.name
        if chosen and name not in chosen:
            continue
        try:
            execute(path)
            print(f'{name}: executed', flush=True)
        except CellExecutionError as error:
            failed += 1
            print(f'{name}: {error}', flush=True)
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())

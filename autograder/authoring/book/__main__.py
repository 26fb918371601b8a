"""Build the book: ``python -m autograder.authoring.book --sphinx PYTHON``."""

import argparse
from collections.abc import Sequence
import os
from pathlib import Path
import shutil
import subprocess
import sys

from nbclient.exceptions import CellExecutionError

from autograder.authoring.book.pages import write_pages
from autograder.layout import Layout
from environment.places import PROJECT


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Write ``book/html/`` in the course's work folder.

    :returns: 0, or 1 if a lesson raised an error or Sphinx gave a warning
    """
    parser = argparse.ArgumentParser(prog='python -m autograder.authoring.book')
    parser.add_argument('--sphinx', metavar='PYTHON', required=True, help='a Python with Sphinx')
    chosen = parser.parse_args(arguments)
    layout = Layout.here()
    pages, html = layout.work / 'book' / 'pages', layout.work / 'book' / 'html'
    shutil.rmtree(pages.parent, ignore_errors=True)
    try:
        write_pages(layout, pages)
    except CellExecutionError as error:
        print(f'book: {error}', file=sys.stderr)
        return 1
    if build(chosen.sphinx, pages, html):
        return 1
    print(f'{(html / "index.html").relative_to(layout.root)}: open this page in a browser')
    return 0


def build(sphinx: str, pages: Path, html: Path) -> int:
    """Convert pages to HTML with the given Python, which has Sphinx; return Sphinx's exit code."""
    return subprocess.run(
        [sphinx, '-m', 'sphinx', '-W', '-q', '-c', str(Path(__file__).parent), pages, html],
        # conf.py names a function of this project, which creates the ids of headings.
        env={**os.environ, 'PYTHONPATH': str(PROJECT)},
        check=False,
    ).returncode


if __name__ == '__main__':
    sys.exit(main())

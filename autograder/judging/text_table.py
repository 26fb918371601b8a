"""Read a table that is written as text, so that a row is read as what it says."""

from __future__ import annotations

from pathlib import Path
import re

FOLDER = Path(__file__).parent / 'causes'


def rows(text: str) -> list[list[str]]:
    """
    Return the rows of a table, each with its cells.

    :param text: rows with an empty line between them, a cell in each line; a line that is indented
        continues the one above it, behind one space; a block that begins with # is a comment
    """
    blocks = (block for block in text.strip().split('\n\n') if block[0] != '#')
    return [re.sub(r'\n +', ' ', block).split('\n') for block in blocks]


def rows_of(name: str) -> list[list[str]]:
    """Return the rows of a file of causes, such as ``by_code.txt``."""
    return rows((FOLDER / name).read_text(encoding='utf-8'))

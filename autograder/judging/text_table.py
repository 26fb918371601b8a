"""Read a table that is written as text, so that a row is read as what it says."""

from __future__ import annotations

import re


def rows(text: str) -> list[list[str]]:
    """
    Return the rows of a table, each with its cells.

    :param text: rows with an empty line between them, a cell in each line; a line that is indented
        continues the one above it, behind one space
    """
    blocks = text.strip().split('\n\n')
    return [re.sub(r'\n +', ' ', block).split('\n') for block in blocks]

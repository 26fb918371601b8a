"""Read the tables of causes, which are text files to make each row readable."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
import re
from typing import NamedTuple

from autograder.exam.exam import Cause

FOLDER = Path(__file__).parent
_ABOUT = ('near', 'seen', 'topic', 'base', 'name')
"""Names in braces whose values help to find the line, see :class:`autograder.exam.exam.Cause`."""


class Row(NamedTuple):
    """
    One row of a table of causes.

    :param cause_id: short stable name of the cause; may contain names in braces
    :param more: the other words of the first line, which ``|`` separates
    :param when: the evidence: a pattern, or conditions on the code; empty in ``by_evidence.txt``
    :param text: what is wrong, with names in braces
    :param try_this: the repair, with names in braces
    """

    cause_id: str
    more: Sequence[str]
    when: str
    text: str
    try_this: str

    def cause(self, **words: object) -> Cause:
        """Return the cause, with values for the names in braces."""
        about = [str(words[name]) for name in _ABOUT if name in words]
        text, try_this = self.text.format(**words), self.try_this.format(**words)
        return Cause(self.cause_id.format(**words), text, try_this, about)


def rows(text: str) -> list[list[str]]:
    """
    Return the rows of a table, each as a list of cells.

    :param text: rows are separated by an empty line, and each line is a cell.  An indented line
        continues the previous one after a space.  A block that begins with # is a comment
    """
    blocks = (block for block in text.strip().split('\n\n') if block[0] != '#')
    return [re.sub(r'\n +', ' ', block).split('\n') for block in blocks]


@cache
def rows_of(name: str) -> tuple[Row, ...]:
    """Return the rows of a file of causes, such as ``by_code.txt``."""
    found = []
    for head, *when, text, try_this in rows((FOLDER / name).read_text(encoding='utf-8')):
        cause_id, *more = head.split('|')
        found.append(Row(cause_id, more, ''.join(when), text, try_this))
    return tuple(found)


@cache
def acts_by_cause() -> dict[str, str]:
    """Return the acts of each cause in ``places.txt``."""
    text = (FOLDER / 'places.txt').read_text(encoding='utf-8').replace('\n  ', ' ')
    lines = (line.split(': ') for line in text.splitlines() if line and line[0] != '#')
    return {one: acts for causes, acts in lines for one in causes.split()}


def cause_of(
    situation: str,
    *,
    about: Sequence[str] = (),
    act: str = '',
    line: int | None = None,
    closer: Sequence[Cause] = (),
    **words: object,
) -> Cause:
    """
    Return the cause for a situation from ``by_evidence.txt``.

    :param words: values for the names in braces; the other parameters are fields of the cause
    """
    cause = _by_situation()[situation].cause(**words)
    return replace(cause, about=about or cause.about, act=act, line=line, closer=closer)


@cache
def _by_situation() -> dict[str, Row]:
    return {(row.more or [row.cause_id])[0]: row for row in rows_of('by_evidence.txt')}

"""Read the tables of causes, which are text files to make each row readable."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from autograder.exam.exam import Cause
from autograder.exam.words import rows

FOLDER = Path(__file__).parent


def rows_of(name: str) -> list[list[str]]:
    """Return the rows of a file of causes, such as ``by_code.txt``."""
    return rows((FOLDER / name).read_text(encoding='utf-8'))


@cache
def acts_by_cause() -> dict[str, str]:
    """Return the acts of each cause in ``places.txt``."""
    text = (FOLDER / 'places.txt').read_text(encoding='utf-8').replace('\n  ', ' ')
    rows = (line.split(': ') for line in text.splitlines() if line and line[0] != '#')
    return {one: acts for causes, acts in rows for one in causes.split()}


def cause_of(situation: str, **words: object) -> Cause:
    """
    Return the cause for a situation from ``by_evidence.txt``.

    :param words: values for the names in braces
    """
    cause_id, text, try_this = _sentences()[situation]
    about = [
        str(words[name]) for name in ('near', 'seen', 'topic', 'base', 'name') if name in words
    ]
    return Cause(cause_id, text.format(**words), try_this.format(**words), about)


@cache
def _sentences() -> dict[str, tuple[str, str, str]]:
    found = {}
    for head, text, try_this in rows_of('by_evidence.txt'):
        cause_id, _, situation = head.partition('|')
        found[situation or cause_id] = (cause_id, text, try_this)
    return found

"""
Read the texts of causes and slips from the text file next to a module.

The module contains the rules of an exam, and the text file the sentences that learners read.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
import re
from typing import Any

from autograder.errors import ExamInvalid
from autograder.exam.exam import Failed
from autograder.exam.specification import Cause, Rule, Slip

_ABOUT = ('near', 'seen', 'topic', 'base', 'name')
"""Names in braces whose values help to find the faulty line."""


def about_of(words: Mapping[str, object]) -> list[str]:
    """Return those values for names in braces that help to find the faulty line."""
    return [str(words[name]) for name in _ABOUT if name in words]


def rows(text: str) -> list[list[str]]:
    """
    Return the rows of a table, each as a list of cells.

    :param text: rows are separated by an empty line, and each line is a cell.  An indented line
        continues the previous one after a space.  A block that begins with # is a comment
    """
    blocks = (block for block in text.strip().split('\n\n') if block[0] != '#')
    return [re.sub(r'\n +', ' ', block).split('\n') for block in blocks]


class Causes:
    """
    The causes of one text file, by name.

    A row of the file has these lines: ``cause``, or ``cause|name`` if several rows have the same
    cause id; what is wrong; the fix.  Further lines are fields of
    :class:`autograder.exam.specification.Cause`: ``act: ...``, ``about:`` and ``closer:`` with
    words, or names of causes, separated by spaces; ``expected:`` and ``observed:`` with the other
    sentences of a check that fails for this cause, see :meth:`failed`.

    :param module: path of the module or of its text file, which has the same name
    :param words: values for the names in braces
    """

    def __init__(self, module: str | Path, **words: Any) -> None:
        """Read the file; a row without a sentence or a fix raises :class:`ExamInvalid`."""
        self._file, self._words = Path(module).with_suffix('.txt'), words
        self._rows: dict[str, list[str]] = {}
        for head, *lines in rows(self._file.read_text(encoding='utf-8')):
            if len(lines) < 2:
                raise ExamInvalid(f'{self._file.name}, {head}: expected a sentence and a fix.')
            cause_id, _, name = head.partition('|')
            self._rows[name or cause_id] = [cause_id, *lines]

    def __getitem__(self, name: str) -> Cause:
        """Return a cause that needs no further values."""
        return self.of(name)

    def of(
        self,
        name: str,
        /,
        about: Sequence[str] = (),
        act: str = '',
        line: int | None = None,
        closer: Sequence[Cause] = (),
        **words: Any,
    ) -> Cause:
        """
        Return a cause, with values for further names in braces.

        :param words: the values; the other parameters are fields of the cause, see
            :class:`autograder.exam.specification.Cause`
        :raises ExamInvalid: if the file has no such row
        """
        head = (one.format(**self._words, **words) for one in self._row(name)[:3])
        cause_id, text, try_this = head
        about = about or self._field(name, 'about', words).split() or about_of(words)
        others = self._field(name, 'closer', words).split()
        closer = closer or [self.of(one, **words) for one in others]
        act = act or self._field(name, 'act', words)
        return Cause(cause_id, text, try_this, about, act, line, closer)

    def _row(self, name: str) -> Sequence[str]:
        if name not in self._rows:
            known = ', '.join(self._rows)
            raise ExamInvalid(
                f'{self._file.name}: there is no cause {name!r}.', f'Known: {known}.'
            )
        return self._rows[name]

    def _field(self, name: str, field: str, words: Mapping[str, Any]) -> str:
        """Return a further line of a row, empty if the row lacks it."""
        lines = (one.partition(': ') for one in self._row(name)[3:])
        found = (said for key, _, said in lines if key == field)
        return next(found, '').format(**self._words, **words)

    def failed(
        self,
        name: str,
        /,
        known: Cause | None = None,
        place: int | None = None,
        share: float = 0.0,
        **words: Any,
    ) -> Failed:
        """
        Return the failure of a check: what was expected, what was observed, and the cause.

        :param known: a more certain cause, which replaces the one of the row
        :param words: see :meth:`of`; the other parameters are fields of
            :class:`autograder.exam.exam.Failed`
        :raises ExamInvalid: if the row lacks one of these sentences
        """
        expected, observed = (self._field(name, one, words) for one in ('expected', 'observed'))
        if not expected or not observed:
            raise ExamInvalid(f'{self._file.name}, {name}: add the lines expected: and observed:.')
        why = known or self.of(name, **words)
        return Failed(expected=expected, observed=observed, why=why, place=place, share=share)

    def slip(self, name: str, /, *rules: Rule, sometimes: bool = False, **words: Any) -> Slip:
        """Return a cause with its rules, see :class:`autograder.exam.specification.Slip`."""
        return Slip.of(self.of(name, **words), *rules, sometimes=sometimes)

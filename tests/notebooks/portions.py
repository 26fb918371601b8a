"""Measure the lengths of the cells of a lesson, and compare them with limits."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
import re
from statistics import median

from autograder.submission.cells import CellSyntaxError, parse_cell
from autograder.submission.notebook import Notebook

WORDS = (25, 60)
"""Minimum and maximum of the median number of words per text cell."""
LINES = (1, 5)
"""Minimum and maximum of the median number of lines per code cell, files excluded."""
MOST_LINES = 12
MOST_LINES_IN_A_FILE = 100


@dataclass(frozen=True)
class Portions:
    """
    The lengths of the cells of one lesson.

    Well-known notebooks that learners like have 30 to 50 words per text cell and 1 to 5 lines per
    code cell; notebooks that learners abandon have long texts and code cells of 90 lines.

    :param words: number of words of each text cell
    :param lines: number of lines of each code cell that is not a file
    :param file_lines: number of lines of each code cell that is a file of a package
    """

    words: tuple[int, ...]
    lines: tuple[int, ...]
    file_lines: tuple[int, ...]

    def problems(self) -> Iterator[str]:
        """Yield one sentence for each figure outside its range."""
        for what, values, (least, most) in (
            ('words per text cell', self.words, WORDS),
            ('lines per code cell', self.lines, LINES),
        ):
            if not least <= median(values) <= most:
                yield f'expected a median of {least} to {most} {what}, got {median(values):g}.'
        for what, values, limit in (
            ('code cell', self.lines, MOST_LINES),
            ('file', self.file_lines, MOST_LINES_IN_A_FILE),
        ):
            if values and max(values) > limit:
                yield f'expected no {what} longer than {limit} lines, got one of {max(values)}.'


def portions(notebook: Notebook) -> Portions:
    """Measure the cells of a lesson."""
    words: list[int] = []
    lines: list[int] = []
    file_lines: list[int] = []
    for cell in notebook['cells']:
        if cell['cell_type'] == 'markdown':
            # Code blocks and HTML tags are not read as words.
            shown = re.sub(r'```.*?```|<[^<>]+>', ' ', cell['source'], flags=re.DOTALL)
            words.append(len(re.findall(r"\w[\w'.-]*", shown)))
        elif cell['cell_type'] == 'code':
            file = None
            with suppress(CellSyntaxError):
                file = parse_cell(cell['source'])
            count = sum(1 for line in cell['source'].splitlines() if line.strip())
            (file_lines if file else lines).append(count)
    return Portions(tuple(words), tuple(lines), tuple(file_lines))

"""Enter marks in a column of a file exported from a learning platform, for re-import."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
import re

from autograder.classroom.standing import by_status
from autograder.errors import GraderError
from autograder.explaining.feedback import number
from autograder.exports.marks import Mark
from autograder.submission.inbox import student_id


@dataclass
class Filled:
    """
    The changes to the file.

    :param row: the word for a row in messages
    :param kept: values of cells that are kept, each with the reason
    :param replaced: student, old value and new value of each changed cell
    :param left_out: students without an entry, each with the reason
    :param untouched: number of rows without a submission
    """

    platform: str
    data: bytes = b''
    column: str = ''
    kept: Mapping[str, str] = field(default_factory=dict)
    filled: int = 0
    replaced: list[tuple[str, str, str]] = field(default_factory=list)
    left_out: list[tuple[str, str]] = field(default_factory=list)
    untouched: int = 0
    row: str = 'line'

    def text(self) -> str:
        """Return the changes as text, one line each."""
        lines = [f'{self.column}: {self.filled} score{"s" * (self.filled != 1)} entered.']
        lines += [f'replaced: {who}: {old} -> {new}' for who, old, new in self.replaced]
        lines += [f'not entered: {line}' for line in by_status(self.left_out)]
        if self.untouched:
            rows = f'{self.untouched} {self.row}{"s" * (self.untouched != 1)}'
            lines.append(f'Without a submission here, so unchanged: {rows}.')
        return '\n'.join(lines)

    def enter(self, row: list[str], index: int, mark: Mark, factor: float) -> None:
        """Write one cell, unless there is no mark or the platform allows none."""
        old = row[index].strip()
        if mark.points is None:
            kept = f'; {self.platform} keeps {old}' if old else ''
            self.left_out.append((mark.student, f'{mark.status}{kept}'))
            return
        if old.upper() in self.kept:
            self.left_out.append((mark.student, self.kept[old.upper()]))
            return
        new = number(mark.points * factor)
        if old and to_number(old) != to_number(new):
            self.replaced.append((mark.student, old, new))
        row[index] = new
        self.filled += 1


def add_names(lines: dict[str, set[int]], text: str, row: int) -> None:
    """Add a row under an id, and under the id into which ``collect`` converts it."""
    for name in {text.strip(), student_id(text.strip())} - {''}:
        lines.setdefault(name, set()).add(row)


def matched(
    lines: Mapping[str, set[int]], marks: Sequence[Mark], columns: str, done: Filled
) -> dict[int, Mark]:
    """Return the marks by row, from the rows by id; leave out students with no row or several."""
    found: dict[int, list[Mark]] = {}
    for mark in marks:
        rows = lines.get(mark.student, set())
        if len(rows) == 1:
            found.setdefault(min(rows), []).append(mark)
            continue
        where = ', '.join(str(row + 1) for row in sorted(rows))
        shared = f'{done.row}s {where} have this id'
        why = shared if rows else f'{done.platform} has no such {columns}'
        done.left_out.append((mark.student, why))
    for row, several in found.items():
        if len(several) > 1:
            names = ' and '.join(mark.student for mark in several)
            why = f'{names} match the same row of {done.platform}, {done.row} {row + 1}'
            done.left_out += [(mark.student, why) for mark in several]
    return {row: several[0] for row, several in found.items() if len(several) == 1}


def factor_for(
    where: str, column: str, possible: float | None, marks: Sequence[Mark], scale: bool
) -> float:
    """
    Return the factor for points: 1 unless scaling is requested.

    :param possible: the maximum on the platform, None if the file does not contain it
    :raises GraderError: if the two maxima differ and ``scale`` is not set
    """
    most = max((mark.max_points for mark in marks), default=0.0)
    if possible is None or most <= 0 or abs(possible - most) < 0.005:
        return 1.0
    got = f'{where}: expected {number(most)} points possible for {column}, got {number(possible)}'
    if possible <= 0:
        raise GraderError(
            f'{got}, which would scale all marks to 0.',
            f'Try: set the points of the assignment on the platform to {number(most)}',
        )
    if scale:
        return possible / most
    raise GraderError(
        f'{got}.',
        'Try: change the points of the assignment on the platform, or use --scale to multiply by '
        f'{number(possible / most)}',
    )


def to_number(text: str) -> float | None:
    """Read a number with a point or a comma; None if it is not a number."""
    parts = re.split('[.,]', text.strip())
    joined = f'{"".join(parts[:-1])}.{parts[-1]}' if len(parts) > 1 else parts[0]
    try:
        return float(joined)
    except ValueError:
        return None

"""Read CSV files from people and learning platforms; read and write the grader's JSON files."""

import csv
from dataclasses import dataclass
import io
import json
from pathlib import Path
from typing import Any

from autograder.errors import GraderError
from autograder.files import json_bytes, write_atomically
from autograder.submission.reading import read_file

BOM = '\N{ZERO WIDTH NO-BREAK SPACE}'


@dataclass(frozen=True)
class Table:
    """
    The cells of a CSV file; the first row is the header.

    :param delimiter: comma, semicolon or tab
    :param bom: whether the file begins with a byte order mark
    """

    rows: list[list[str]]
    delimiter: str = ','
    newline: str = '\n'
    bom: bool = False

    @property
    def header(self) -> list[str]:
        """Return the names of the columns."""
        return self.rows[0]

    def to_bytes(self) -> bytes:
        """Return the file with its current cells, in UTF-8."""
        text = io.StringIO()
        writer = csv.writer(text, delimiter=self.delimiter, lineterminator=self.newline)
        writer.writerows(self.rows)
        return ((BOM if self.bom else '') + text.getvalue()).encode('utf-8')


def parse_table(data: bytes) -> Table:
    """Return the cells of a CSV file without empty lines; ValueError if it is not a table."""
    try:
        text = data.decode('utf-8')
    except UnicodeDecodeError as error:
        raise ValueError('the text is not UTF-8; save it as CSV UTF-8') from error
    bom, text = text.startswith(BOM), text.removeprefix(BOM)
    first = text.partition('\n')[0]
    delimiter = max(',;\t', key=first.count)
    try:
        rows = list(csv.reader(io.StringIO(text, newline=''), delimiter=delimiter, strict=True))
    except csv.Error as error:
        raise ValueError(f'a line is not valid CSV ({error})') from error
    rows = [row for row in rows if row] or [[]]
    for line, row in enumerate(rows, start=1):
        if len(row) != len(rows[0]):
            raise ValueError(f'line {line} has {len(row)} fields, line 1 has {len(rows[0])}')
    return Table(rows, delimiter, '\r\n' if '\r\n' in text else '\n', bom)


def read_bytes(path: Path, what: str, fix: str) -> bytes:
    """Read a file; GraderError with its name in words and the advice ``fix`` if that fails."""
    try:
        return path.read_bytes()
    except OSError as error:
        raise GraderError(f'{path}: {what} cannot be read: {error.strerror}.', fix) from error


def read_json(path: Path) -> Any:
    """Return the content of a JSON file; None if it is missing or damaged."""
    data, _ = read_file(path, path.name)
    try:
        return json.loads(data or b'null')
    except (ValueError, RecursionError):
        return None


def save_json(path: Path, data: Any) -> None:
    """Write a JSON file, unless it would not change or would be new and empty."""
    new, (there, _) = json_bytes(data), read_file(path, path.name)
    if new != there and (data or there is not None):
        write_atomically(path, new)

"""The command ``export``: write the results of the last grading for other programs."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
import sys

from autograder.classroom.people import read_people
from autograder.classroom.results_of_class import ClassResults, graded
from autograder.commands import FOR_REVIEW, OK
from autograder.errors import GraderError
from autograder.explaining.feedback import printable
from autograder.exports import canvas
from autograder.exports.as_json import results_json
from autograder.exports.gradescope import RESULTS, results_bytes, VISIBILITIES
from autograder.exports.gradescope_zip import autograder_zip
from autograder.exports.junit import junit_xml
from autograder.exports.marks import AUTOMATIC, GRADEBOOK, Mark, marks, SOURCES
from autograder.exports.table import checks_csv, marks_csv
from autograder.files import refuse_existing, safe_name, write_file
from autograder.layout import Layout
from autograder.sandboxes.isolation import MODES, WEAK

Marked = Sequence[tuple[ClassResults, Sequence[Mark]]]
Made = tuple[Mapping[Path, bytes | None], bool, str]
"""Content by path, None to remove the file; whether a score is missing; text to print."""


def options(parser: argparse.ArgumentParser) -> None:
    """Describe the formats and their options."""
    formats = parser.add_subparsers(required=True, metavar='FORMAT', dest='format')

    def add(
        name: str, text: str, ending: str, make: Callable[..., Made], one: bool = False
    ) -> argparse.ArgumentParser:
        made: argparse.ArgumentParser = formats.add_parser(name, help=text, description=text)
        if one:
            made.add_argument('assignment', metavar='ASSIGNMENT')
        else:
            made.add_argument('assignment', nargs='?', metavar='ASSIGNMENT', help='default: all')
        made.add_argument(
            '--to',
            type=Path,
            metavar='PATH',
            help='file or folder to write (default: in _work/exports/)',
        )
        made.add_argument('--force', action='store_true', help='replace an existing file')
        made.set_defaults(ending=ending, make=make)
        return made

    table = add(
        'csv',
        'write a table with one row per submission (RFC 4180, safe to open in a spreadsheet)',
        '.csv',
        _csv,
    )
    _add_points(table, AUTOMATIC)
    for name, text, ending, write in (
        (
            'checks-csv',
            'write a table with one row per submission and check',
            '.checks.csv',
            checks_csv,
        ),
        (
            'json',
            'write all results as JSON (see docs/results.schema.json)',
            '.json',
            results_json,
        ),
        ('junit', 'write JUnit XML for CI servers', '.junit.xml', junit_xml),
    ):
        add(name, text, ending, _of_results(write))
    filled = 'fill one column of a gradebook file exported from Canvas'
    book = add('canvas', filled, '.canvas.csv', _canvas, one=True)
    book.add_argument(
        '--gradebook', type=Path, required=True, metavar='FILE', help='file from Canvas'
    )
    book.add_argument(
        '--column', required=True, metavar='NAME', help='column to fill: header, title or id'
    )
    book.add_argument(
        '--scale', action='store_true', help="scale points to Canvas's points possible"
    )
    _add_points(book, GRADEBOOK)
    results = add(
        'gradescope', 'write a results.json per submission', '.gradescope', _gradescope, True
    )
    packed = 'pack an autograder zip file for Gradescope'
    container = add('gradescope-autograder', packed, '.gradescope.zip', _autograder, True)
    container.add_argument(
        '--allow-weak',
        choices=[mode for mode in WEAK if MODES[mode].keeps_secrets],
        default='',
        metavar='MODE',
        help='weakest isolation to accept on Gradescope (see docs/exports.md)',
    )
    for one in (results, container):
        one.add_argument(
            '--visibility',
            choices=VISIBILITIES,
            default=VISIBILITIES[0],
            help='when students see the tests (default: %(default)s)',
        )
    parser.set_defaults(run=run)


def _add_points(parser: argparse.ArgumentParser, default: str) -> None:
    parser.add_argument(
        '--points',
        choices=SOURCES,
        default=default,
        help="points of the checks alone, or nbgrader's marks with manual grades and late "
        'penalties (default: %(default)s)',
    )


def run(chosen: argparse.Namespace) -> int:
    """Write one format."""
    layout = Layout.here()
    name = layout.assignment_named(chosen.assignment) if chosen.assignment else 'all'
    path = chosen.to or layout.work / 'exports' / f'{name}{chosen.ending}'
    files, left_out, said = chosen.make(layout, chosen, path)
    refuse_existing(files, chosen.force)
    for file, data in files.items():
        if data is None:
            file.unlink(missing_ok=True)
        else:
            write_file(file, data, chosen.force, 0o600 if chosen.make is _autograder else 0o644)
    print('\n'.join(filter(None, (str(path), printable(said)))))
    return FOR_REVIEW if left_out else OK


def _marked(layout: Layout, chosen: argparse.Namespace) -> Marked:
    """Return the chosen results, with the marks of all students."""
    source = getattr(chosen, 'points', AUTOMATIC)
    return [(one, marks(layout, one, source)) for one in graded(layout, chosen.assignment)]


def _without_mark(marked: Marked) -> bool:
    """Print the students without a mark; return whether there are any."""
    missing = [(one, mark) for one, given in marked for mark in given if mark.points is None]
    for one, mark in missing:
        line = f'no mark: {one.assignment}: {mark.student}: {mark.status}'
        print(printable(line), file=sys.stderr)
    return bool(missing)


def _csv(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    marked = _marked(layout, chosen)
    return {path: marks_csv(marked, read_people(layout))}, _without_mark(marked), ''


def _of_results(write: Callable[[Iterable[ClassResults]], bytes]) -> Callable[..., Made]:
    def make(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
        marked = _marked(layout, chosen)
        return {path: write([one for one, _ in marked])}, _without_mark(marked), ''

    return make


def _canvas(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    if path.resolve() == chosen.gradebook.resolve():
        raise GraderError(
            f'{path}: the output would overwrite the gradebook from Canvas.',
            'Try: --to with a different name',
        )
    ((_, given),) = _marked(layout, chosen)
    data = canvas.read_file(chosen.gradebook)
    done = canvas.fill(data, str(chosen.gradebook), chosen.column, given, chosen.scale)
    return {path: done.data}, bool(done.left_out), done.text()


def _gradescope(layout: Layout, chosen: argparse.Namespace, folder: Path) -> Made:
    ((found, given),) = marked = _marked(layout, chosen)
    files = {
        folder / safe_name(one.student) / RESULTS: None  # removes the file of an earlier grading
        if mark.points is None
        else results_bytes(one, chosen.visibility)
        for one, mark in zip(found.results, given)
    }
    return files, _without_mark(marked), ''


def _autograder(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    assignment = layout.assignment_named(chosen.assignment)
    data = autograder_zip(layout, assignment, chosen.visibility, chosen.allow_weak)
    said = 'It holds the hidden exams and the secret of the course: keep it as secret as they are.'
    return {path: data}, False, said

"""The command ``export``: write the results of the last grading for other programs."""

import argparse
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
import sys

from autograder.classroom.collected import collected_work
from autograder.classroom.pages import page_name
from autograder.classroom.people import read_people
from autograder.classroom.results_of_class import graded
from autograder.classroom.standing import by_status
from autograder.classroom.tables import read_bytes
from autograder.commands import (
    ASSIGNMENT,
    ASSIGNMENT_OR_ALL,
    describe,
    flag,
    FOR_REVIEW,
    OK,
    Option,
    option,
    takes,
)
from autograder.errors import GraderError
from autograder.explaining.feedback import number, printable
from autograder.exports import canvas, lti, moodle
from autograder.exports.as_json import results_json
from autograder.exports.feedback_zip import feedback_zip
from autograder.exports.gradescope import autograder_zip, VISIBILITIES
from autograder.exports.junit import junit_xml
from autograder.exports.marks import AUTOMATIC, GRADEBOOK, Mark, marks, SOURCES
from autograder.exports.table import checks_csv, marks_csv
from autograder.files import refuse_existing, write_atomically
from autograder.layout import Layout
from autograder.sandboxes.isolation import MODES, WEAK

Made = tuple[bytes, bool, str]
"""Content of the file (empty for no file), whether a score is missing, and text to print."""
Make = Callable[[Layout, argparse.Namespace, Path], Made]
COMMON = (
    option(
        '--to',
        'file to write (default: a file in _work/exports/, which is replaced)',
        type=Path,
        metavar='PATH',
    ),
    flag('--force', 'replace an existing file that --to names'),
)


POINTS = option(
    '--points',
    "points of the checks alone, or nbgrader's marks with manual grades and late penalties "
    '(default: %(default)s)',
    choices=SOURCES,
    default=GRADEBOOK,
)


def _formats(parser: argparse.ArgumentParser) -> None:
    """Add a subcommand with its options for each format."""
    formats = parser.add_subparsers(required=True, metavar='FORMAT', dest='format')
    for name, (make, ending, text) in FORMATS.items():
        parser = formats.add_parser(name, help=text, description=text)
        describe(parser, make, *(COMMON if ending else ()))


@takes(_formats)
def run(chosen: argparse.Namespace) -> int:
    """Export the results in one format."""
    layout = Layout.here()
    make, ending, _ = FORMATS[chosen.format]
    if chosen.assignment:
        chosen.assignment = layout.assignment_named(chosen.assignment)
    name = f'{chosen.assignment or "all"}{ending}'
    to = getattr(chosen, 'to', None)
    path = to or layout.work / 'exports' / name
    if ending:
        refuse_existing([path], chosen.force or not to)
    data, left_out, said = make(layout, chosen, path)
    if data:
        write_atomically(path, data, 0o600 if make is _autograder else 0o644)
        print(path)
    if said:
        print(printable(said))
    return FOR_REVIEW if left_out else OK


def _marks(layout: Layout, chosen: argparse.Namespace) -> list[Mark]:
    """Return the marks of the chosen assignments; print the points lost for lateness."""
    source = getattr(chosen, 'points', AUTOMATIC)
    found = [
        mark for one in graded(layout, chosen.assignment) for mark in marks(layout, one, source)
    ]
    for mark in found:
        if mark.late_points:
            lost = f'{number(mark.late_points)} points off, {number(mark.points or 0.0)} left'
            _warn(f'late: {mark.assignment}: {mark.student}: {lost}')
    return found


def _without_mark(given: Sequence[Mark]) -> bool:
    """Print the students who have no mark, and return whether there are any."""
    missing = [mark for mark in given if mark.points is None]
    for name in dict.fromkeys(mark.assignment for mark in missing):
        of_it = [(mark.student, mark.status) for mark in missing if mark.assignment == name]
        for line in by_status(of_it):
            _warn(f'no mark: {name}: {line}')
    return bool(missing)


def _warn(line: str) -> None:
    print(printable(line), file=sys.stderr)


def _of_marks(write: Callable[[Layout, Sequence[Mark]], bytes], *options: Option) -> Make:
    @takes(ASSIGNMENT_OR_ALL, *options)
    def make(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
        given = _marks(layout, chosen)
        return write(layout, given), _without_mark(given), ''

    return make


def _download(path: Path, download: Path, what: str, fix: str) -> bytes:
    """Read a platform's file, which the output must not replace, even with ``--force``."""
    if path.resolve() == download.resolve():
        raise GraderError(
            f'{path}: the output would overwrite {what}.', 'Try: --to with a different name'
        )
    return read_bytes(download, what, fix)


@takes(
    ASSIGNMENT,
    option('--gradebook', 'file from Canvas', type=Path, required=True, metavar='FILE'),
    option('--column', 'column to fill: header, title or id', required=True, metavar='NAME'),
    flag('--scale', "scale points to Canvas's points possible"),
    POINTS,
)
def _canvas(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    file = chosen.gradebook
    data = _download(path, file, 'the gradebook from Canvas', canvas.FIX)
    given = _marks(layout, chosen)
    done = canvas.fill(data, str(file), chosen.column, given, chosen.scale)
    return done.data, bool(done.left_out), done.text()


@takes(
    ASSIGNMENT,
    option(
        '--worksheet', 'grading worksheet from Moodle', type=Path, required=True, metavar='FILE'
    ),
    option(
        '--column',
        'header of the grade column in the worksheet (default: %(default)s)',
        default=moodle.GRADE,
        metavar='NAME',
    ),
    flag('--scale', "scale points to Moodle's maximum grade"),
    POINTS,
)
def _moodle(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    file = chosen.worksheet
    data = _download(path, file, 'the worksheet from Moodle', moodle.FIX)
    given = _marks(layout, chosen)
    works = collected_work(layout, chosen.assignment)
    numbers = {student: one.number for student, one in works.items() if one.number}
    done = moodle.fill(data, str(file), given, numbers, chosen.column, chosen.scale)
    return done.data, bool(done.left_out), done.text()


@takes(
    ASSIGNMENT,
    option(
        '--platform',
        'settings of the platform (see docs/exports.md)',
        type=Path,
        required=True,
        metavar='FILE',
    ),
    flag('--dry-run', 'find the students on the platform, but send nothing'),
    POINTS,
)
def _lti(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    given, platform = _marks(layout, chosen), lti.read_platform(chosen.platform)
    url = lti.line_item(platform, chosen.platform, chosen.assignment)
    done = lti.send(platform, url, given, chosen.dry_run)
    said = 'Nothing was sent.' if chosen.dry_run else ''
    return b'', bool(done.left_out), '\n'.join(filter(None, (done.text(), said)))


@takes(ASSIGNMENT, POINTS)
def _feedback(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    from autograder.gradebook.converters import feedback  # nbgrader takes seconds to import

    given = _marks(layout, chosen)
    ready = [mark.student for mark in given if mark.points is not None]
    pages = feedback(layout, chosen.assignment, ready)
    works = collected_work(layout, chosen.assignment)
    if absent := sorted({*ready} - pages.keys()):
        said = f'{chosen.assignment}: no feedback page for {", ".join(absent)}.'
        raise GraderError(printable(said), 'Try: make grade, then run the same command again')
    left_out = _without_mark(given)
    for mark in given:  # nbgrader has no page that says why a file cannot be read.
        page = layout.reports / chosen.assignment / page_name(mark.student)
        if mark.result and mark.result.unusable and mark.points is None and page.is_file():
            pages[mark.student] = page.read_bytes()
    if not pages:
        return b'', left_out, 'There is no page to pack, so nothing was written.'
    said = f'Packed {len(pages)} page{"s" * (len(pages) != 1)}.'
    return feedback_zip(pages, works), left_out, said


@takes(
    ASSIGNMENT,
    option(
        '--allow-weak',
        'weakest isolation to accept on Gradescope (see docs/exports.md)',
        choices=[mode for mode in WEAK if MODES[mode].keeps_secrets],
        default='',
        metavar='MODE',
    ),
    option(
        '--visibility',
        'when students see the tests (default: %(default)s)',
        choices=VISIBILITIES,
        default=VISIBILITIES[0],
    ),
)
def _autograder(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    data = autograder_zip(layout, chosen.assignment, chosen.visibility, chosen.allow_weak)
    said = 'The zip contains the hidden exams and the course secret: keep it secret.'
    return data, False, said


FORMATS: Mapping[str, tuple[Make, str, str]] = {
    'csv': (
        _of_marks(lambda layout, given: marks_csv(given, read_people(layout)), POINTS),
        '.csv',
        'write a table with one row per submission (RFC 4180, safe to open in a spreadsheet)',
    ),
    'checks-csv': (
        _of_marks(lambda _, given: checks_csv(given)),
        '.checks.csv',
        'write a table with one row per submission and check',
    ),
    'json': (
        _of_marks(lambda _, given: results_json(given)),
        '.json',
        'write all results as JSON (see docs/results.schema.json)',
    ),
    'junit': (
        _of_marks(lambda _, given: junit_xml(given)),
        '.junit.xml',
        'write JUnit XML for CI servers',
    ),
    'canvas': (_canvas, '.canvas.csv', 'fill one column of a gradebook file exported from Canvas'),
    'moodle': (_moodle, '.moodle.csv', 'enter the grades in a grading worksheet from Moodle'),
    'lti': (_lti, '', 'send the marks to a learning platform by LTI 1.3'),
    'feedback': (
        _feedback,
        '.feedback.zip',
        'pack feedback pages with the file names that Canvas and Moodle expect',
    ),
    'gradescope-autograder': (
        _autograder,
        '.gradescope.zip',
        'pack an autograder zip file for Gradescope',
    ),
}
"""Function, file name ending and description for ``--help`` of each format, by its name."""

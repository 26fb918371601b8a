"""The command ``export``: write the results of the last grading for other programs."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
import sys

from autograder.classroom.delivered import read_delivered
from autograder.classroom.people import read_people
from autograder.classroom.results_of_class import ClassResults, graded
from autograder.classroom.tables import read_bytes
from autograder.collect.namesakes import read_namesakes
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
from autograder.exports.gradescope import RESULTS, results_bytes, results_in, VISIBILITIES
from autograder.exports.gradescope_zip import autograder_zip
from autograder.exports.junit import junit_xml
from autograder.exports.marks import AUTOMATIC, GRADEBOOK, Mark, marks, SOURCES
from autograder.exports.table import checks_csv, marks_csv
from autograder.files import keep, refuse_existing, safe_name
from autograder.layout import Layout
from autograder.sandboxes.isolation import MODES, WEAK

Marked = Sequence[tuple[ClassResults, Sequence[Mark]]]
Made = tuple[Mapping[Path, bytes | None], bool, str]
"""Content by path (None removes the file), whether a score is missing, and text to print."""
Make = Callable[[Layout, argparse.Namespace, Path], Made]
VISIBILITY = option(
    '--visibility',
    'when students see the tests (default: %(default)s)',
    choices=VISIBILITIES,
    default=VISIBILITIES[0],
)
COMMON = (
    option(
        '--to', 'file or folder to write (default: in _work/exports/)', type=Path, metavar='PATH'
    ),
    flag('--force', 'replace an existing file'),
)


def _points(default: str) -> Option:
    return option(
        '--points',
        "points of the checks alone, or nbgrader's marks with manual grades and late penalties "
        '(default: %(default)s)',
        choices=SOURCES,
        default=default,
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
    name = layout.assignment_named(chosen.assignment) if chosen.assignment else 'all'
    path = getattr(chosen, 'to', None) or layout.work / 'exports' / f'{name}{ending}'
    files, left_out, said = make(layout, chosen, path)
    refuse_existing(files, getattr(chosen, 'force', False))
    for file, data in files.items():
        if data is None:
            file.unlink(missing_ok=True)
        else:
            keep(file, data, 0o600 if make is _autograder else 0o644)
    print('\n'.join(filter(None, (str(path) if files else '', printable(said)))))
    return FOR_REVIEW if left_out else OK


def _marked(layout: Layout, chosen: argparse.Namespace) -> Marked:
    """Return the results and marks of each chosen assignment; print who lost points as late."""
    source = getattr(chosen, 'points', AUTOMATIC)
    found = [(one, marks(layout, one, source)) for one in graded(layout, chosen.assignment)]
    for one, given in found:
        for mark in given:
            if mark.late_points:
                lost = f'{number(mark.late_points)} points less, to {number(mark.points or 0.0)}'
                line = f'late: {one.assignment}: {mark.student}: {lost}'
                print(printable(line), file=sys.stderr)
    return found


def _without_mark(marked: Marked) -> bool:
    """Print who has no mark, and return whether there is such a student."""
    missing = [(one, mark) for one, given in marked for mark in given if mark.points is None]
    for one, mark in missing:
        line = f'no mark: {one.assignment}: {mark.student}: {mark.status}'
        print(printable(line), file=sys.stderr)
    return bool(missing)


@takes(ASSIGNMENT_OR_ALL, _points(AUTOMATIC))
def _csv(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    marked = _marked(layout, chosen)
    return {path: marks_csv(marked, read_people(layout))}, _without_mark(marked), ''


def _of_results(write: Callable[[Marked], bytes]) -> Make:
    @takes(ASSIGNMENT_OR_ALL)
    def make(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
        marked = _marked(layout, chosen)
        return {path: write(marked)}, _without_mark(marked), ''

    return make


def _keep_download(path: Path, download: Path, what: str) -> None:
    """Refuse to write over the file that a platform exported, even with ``--force``."""
    if path.resolve() == download.resolve():
        raise GraderError(
            f'{path}: the output would overwrite {what}.', 'Try: --to with a different name'
        )


@takes(
    ASSIGNMENT,
    option('--gradebook', 'file from Canvas', type=Path, required=True, metavar='FILE'),
    option('--column', 'column to fill: header, title or id', required=True, metavar='NAME'),
    flag('--scale', "scale points to Canvas's points possible"),
    _points(GRADEBOOK),
)
def _canvas(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    _keep_download(path, chosen.gradebook, 'the gradebook from Canvas')
    ((_, given),) = _marked(layout, chosen)
    data = canvas.read_file(chosen.gradebook)
    done = canvas.fill(data, str(chosen.gradebook), chosen.column, given, chosen.scale)
    return {path: done.data}, bool(done.left_out), done.text()


@takes(
    ASSIGNMENT,
    option(
        '--worksheet', 'grading worksheet from Moodle', type=Path, required=True, metavar='FILE'
    ),
    option(
        '--column',
        'header of the grades in the worksheet (default: %(default)s)',
        default=moodle.GRADE,
        metavar='NAME',
    ),
    flag('--scale', "scale points to Moodle's maximum grade"),
    _points(GRADEBOOK),
)
def _moodle(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    _keep_download(path, chosen.worksheet, 'the worksheet from Moodle')
    ((found, given),) = _marked(layout, chosen)
    numbers = {
        student: of_one[found.assignment]
        for student, of_one in read_namesakes(layout).numbers.items()
        if found.assignment in of_one
    }
    data = read_bytes(chosen.worksheet, 'the worksheet from Moodle', moodle.FIX)
    done = moodle.fill(data, str(chosen.worksheet), given, numbers, chosen.column, chosen.scale)
    return {path: done.data}, bool(done.left_out), done.text()


@takes(
    ASSIGNMENT,
    option(
        '--platform',
        'settings of the platform (see docs/exports.md)',
        type=Path,
        required=True,
        metavar='FILE',
    ),
    flag('--dry-run', 'only find the students on the platform'),
    _points(GRADEBOOK),
)
def _lti(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    ((found, given),) = _marked(layout, chosen)
    platform = lti.read_platform(chosen.platform)
    url = lti.line_item(platform, chosen.platform, found.assignment)
    done = lti.send(platform, url, given, chosen.dry_run)
    said = 'Nothing was sent.' if chosen.dry_run else ''
    return {}, bool(done.left_out), '\n'.join(filter(None, (done.text(), said)))


@takes(ASSIGNMENT, _points(GRADEBOOK))
def _feedback(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    from autograder.gradebook.converters import feedback  # nbgrader takes seconds to import

    ((found, given),) = marked = _marked(layout, chosen)
    ready = [mark.student for mark in given if mark.points is not None]
    pages = feedback(layout, found.assignment, ready)
    names = {
        student: one
        for (assignment, student), one in read_delivered(layout).items()
        if assignment == found.assignment
    }
    if absent := sorted({*ready} - pages.keys()):
        said = f'{found.assignment}: no feedback page for {", ".join(absent)}.'
        raise GraderError(printable(said), 'Try: make grade, then the same command again')
    said = f'{len(pages)} pages.'
    return {path: feedback_zip(pages, names)}, _without_mark(marked), said


@takes(ASSIGNMENT, VISIBILITY)
def _gradescope(layout: Layout, chosen: argparse.Namespace, folder: Path) -> Made:
    ((found, given),) = marked = _marked(layout, chosen)
    files = {
        # None removes a file of an earlier grading.
        folder / safe_name(one.student) / RESULTS: None
        if mark.points is None
        else results_bytes(one, chosen.visibility)
        for one, mark in zip(found.results, given)  # those without a submission come last
    }
    files |= dict.fromkeys(set(results_in(folder, found.assignment)) - set(files))
    return files, _without_mark(marked), ''


@takes(
    ASSIGNMENT,
    option(
        '--allow-weak',
        'weakest isolation to accept on Gradescope (see docs/exports.md)',
        choices=[mode for mode in WEAK if MODES[mode].keeps_secrets],
        default='',
        metavar='MODE',
    ),
    VISIBILITY,
)
def _autograder(layout: Layout, chosen: argparse.Namespace, path: Path) -> Made:
    assignment = layout.assignment_named(chosen.assignment)
    data = autograder_zip(layout, assignment, chosen.visibility, chosen.allow_weak)
    said = 'It contains the hidden exams and the secret of the course: keep it secret.'
    return {path: data}, False, said


FORMATS: Mapping[str, tuple[Make, str, str]] = {
    'csv': (
        _csv,
        '.csv',
        'write a table with one row per submission (RFC 4180, safe to open in a spreadsheet)',
    ),
    'checks-csv': (
        _of_results(lambda marked: checks_csv(one for one, _ in marked)),
        '.checks.csv',
        'write a table with one row per submission and check',
    ),
    'json': (
        _of_results(results_json),
        '.json',
        'write all results as JSON (see docs/results.schema.json)',
    ),
    'junit': (_of_results(junit_xml), '.junit.xml', 'write JUnit XML for CI servers'),
    'canvas': (
        _canvas,
        '.canvas.csv',
        'fill one column of a gradebook file exported from Canvas',
    ),
    'moodle': (_moodle, '.moodle.csv', 'fill the grades in a grading worksheet from Moodle'),
    'lti': (_lti, '', 'send the marks to a learning platform by LTI 1.3'),
    'feedback': (
        _feedback,
        '.feedback.zip',
        'pack feedback pages with the file names that Canvas and Moodle expect',
    ),
    'gradescope': (_gradescope, '.gradescope', 'write a results.json per submission'),
    'gradescope-autograder': (
        _autograder,
        '.gradescope.zip',
        'pack an autograder zip file for Gradescope',
    ),
}
"""Function, file name ending and description for ``--help`` of each format, by its name."""

"""
The instructor's commands for a class as a whole: ``report``, ``stats``, ``similar``, ``export``.

Here are only their options and what they print; each has modules of its own.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
import json
from pathlib import Path
import sys
from typing import Any, TYPE_CHECKING

from autograder.classroom.results_of_class import ClassResults, graded, one_graded
from autograder.commands.exit_codes import FOR_REVIEW, OK
from autograder.errors import GraderError
from autograder.explaining.feedback import number, printable
from autograder.exports.gradescope import VISIBILITIES
from autograder.exports.marks import AUTOMATIC, GRADEBOOK, Mark, marks, SOURCES
from autograder.layout import Layout
from autograder.results import shortened
from autograder.sandboxes.isolation import MODES, WEAK

if TYPE_CHECKING:
    from autograder.classroom.similarity import Pair, Similar
    from autograder.classroom.statistics import ClassNumbers

COMMON_LINES = 6
BAR = 40
CAUSE_CHARS = 100


def add_class_commands(commands: Any) -> None:
    """
    Describe the commands.

    :param commands: what :meth:`argparse.ArgumentParser.add_subparsers` returns
    """
    report = commands.add_parser('report', help='write the page of a class in numbers again')
    report.add_argument('assignment', nargs='?', metavar='ASSIGNMENT', help='default: all graded')
    report.set_defaults(run=_report)

    stats = commands.add_parser('stats', help='the last grading in numbers: marks, checks, causes')
    stats.add_argument('assignment', nargs='?', metavar='ASSIGNMENT', help='default: all graded')
    stats.add_argument('--json', action='store_true', help='print it as JSON')
    stats.set_defaults(run=_stats)

    similar = commands.add_parser('similar', help='list similar submissions to look at')
    similar.add_argument('assignment', metavar='ASSIGNMENT')
    similar.add_argument('--submitted', type=Path, metavar='DIR', help='as for grade')
    similar.add_argument(
        '--at-least',
        type=_percent,
        default=85.0,
        metavar='PERCENT',
        help='list pairs from here on (default: %(default)g)',
    )
    similar.add_argument('--json', action='store_true', help='all of it, as JSON')
    similar.set_defaults(run=_similar)
    _add_export(commands)


def _add_export(commands: Any) -> None:
    """Describe ``export`` and its formats."""
    export = commands.add_parser('export', help='the last grading for other programs')
    formats = export.add_subparsers(required=True, metavar='FORMAT', dest='format')

    def add(name: str, text: str, run: Any, one: bool = False) -> argparse.ArgumentParser:
        made: argparse.ArgumentParser = formats.add_parser(name, help=text, description=text)
        if one:
            made.add_argument('assignment', metavar='ASSIGNMENT')
        else:
            made.add_argument('assignment', nargs='?', metavar='ASSIGNMENT', help='default: all')
        made.add_argument('--to', type=Path, metavar='PATH', help='default: _work/exports/...')
        made.add_argument('--force', action='store_true', help='replace what is there')
        made.set_defaults(run=run)
        return made

    table = add('csv', 'a line a submission, RFC 4180, safe in a spreadsheet', _csv)
    _add_points(table, AUTOMATIC)
    add('checks-csv', 'a line a check of each submission', _checks_csv)
    add('json', 'everything, see docs/results.schema.json', _json)
    add('junit', 'JUnit XML for CI servers', _junit)
    canvas = add('canvas', 'fill one column of the gradebook file that Canvas gave', _canvas, True)
    canvas.add_argument(
        '--gradebook', type=Path, required=True, metavar='FILE', help='from Canvas'
    )
    canvas.add_argument('--column', required=True, metavar='NAME', help='its header, title or id')
    canvas.add_argument('--scale', action='store_true', help="to Canvas's points possible")
    _add_points(canvas, GRADEBOOK)
    results = add('gradescope', 'results.json of each submission', _gradescope, True)
    _add_visibility(results)
    container = add('gradescope-autograder', 'an autograder zip for Gradescope', _container, True)
    _add_visibility(container)
    container.add_argument(
        '--allow-weak',
        choices=[mode for mode in WEAK if MODES[mode].keeps_secrets],
        default='',
        metavar='MODE',
        help='isolation that may be used there (see docs/exports.md)',
    )


def _add_points(parser: argparse.ArgumentParser, default: str) -> None:
    parser.add_argument(
        '--points',
        choices=SOURCES,
        default=default,
        help='of the checks alone, or as nbgrader has them: with manual grades, less what is late '
        '(default: %(default)s)',
    )


def _add_visibility(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--visibility',
        choices=VISIBILITIES,
        default=VISIBILITIES[0],
        help='when students see the tests (default: %(default)s)',
    )


def _percent(text: str) -> float:
    """Read a number from 1 to 100."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1 <= value <= 100:
        raise argparse.ArgumentTypeError(f'expected a number from 1 to 100, got {text!r}')
    return value


# -- report and stats -----------------------------------------------------------------------


def _report(chosen: argparse.Namespace) -> int:
    """Write the pages."""
    from autograder.classroom.class_report import write_class_report

    layout = Layout.here()
    for one in graded(layout, chosen.assignment):
        print(write_class_report(layout, one.assignment))
    return OK


def _stats(chosen: argparse.Namespace) -> int:
    """Print a class in numbers."""
    from autograder.classroom.statistics import class_numbers

    layout = Layout.here()
    found = [class_numbers(layout, one) for one in graded(layout, chosen.assignment)]
    if chosen.json:
        print(json.dumps([one.to_json() for one in found]))
    else:
        print('\n\n'.join(stats_text(one) for one in found))
    return FOR_REVIEW if any(one.review for one in found) else OK


def stats_text(numbers: ClassNumbers) -> str:
    """Return a class in numbers as plain text."""
    lines = [
        f'{numbers.assignment}: {numbers.submissions} submission{"s" * (numbers.submissions != 1)}'
    ]
    lines += [f'  for review: {student}: {fault}' for student, fault in numbers.review]
    lines += _marks_lines(numbers)
    if numbers.checks:
        lines.append('  failed  not run  mean points  check')
    for check in numbers.checks:
        mean = f'{number(check.mean_points)} of {number(check.max_points)}'
        lines.append(
            f'  {check.failed:6}  {check.not_run:7}  {mean:>11}  {check.exam}/{check.check}'
        )
        for words, count in check.causes[:1]:
            words = shortened(' '.join(words.split()), CAUSE_CHARS)
            lines.append(f'{"":33}{count} of {check.failed}: {words}')
    lines += [f'  flag: {student}: {flag}' for student, flag in numbers.flagged]
    lines += [f'  slowest: {student}: {seconds:.1f} s' for student, seconds in numbers.slowest]
    if numbers.repeated:
        lines.append(f'  run twice: {", ".join(numbers.repeated)}')
    if numbers.recorded:
        lines.append(f'  {numbers.recorded} needed no run: from recordings, or nothing to run')
    lines += [f'  NOT PROTECTED: {lack}' for lack in numbers.lacks]
    lines.append(f'  isolation {", ".join(numbers.modes) or "none needed"}')
    if numbers.versions:
        versions = ', '.join(f'{name} {text}' for name, text in numbers.versions.items())
        lines.append(f'  recorded with {versions}')
    return printable('\n'.join(lines))


def _marks_lines(numbers: ClassNumbers) -> list[str]:
    marks = numbers.marks
    if marks is None:
        return ['  nobody has a mark']
    lines = [
        f'  points of {number(marks.max_points)}: mean {number(marks.mean)}, median '
        f'{number(marks.median)}, quarters {number(marks.lower_quartile)} and '
        f'{number(marks.upper_quartile)}, from {number(marks.lowest)} to '
        f'{number(marks.highest)}; {marks.full} of {marks.count} have all'
    ]
    most = max(marks.bins)
    for place, count in enumerate(marks.bins):
        low, high = (
            number(marks.max_points * edge / len(marks.bins)) for edge in (place, place + 1)
        )
        lines.append(
            f'  {low:>6} - {high:<6} {count:4} {"#" * round(BAR * count / most)}'.rstrip()
        )
    return lines


# -- similar --------------------------------------------------------------------------------


def _similar(chosen: argparse.Namespace) -> int:
    """Print the pairs."""
    from autograder.classroom.similarity import similar

    layout = Layout.here()
    assignment = layout.assignment_named(chosen.assignment)
    submitted = chosen.submitted or layout.submitted
    found = similar(layout, assignment, submitted, chosen.at_least / 100)
    print(json.dumps(found.to_json()) if chosen.json else similar_text(found))
    return OK


def similar_text(found: Similar) -> str:
    """Return the list to look at as plain text."""
    lines = [f'{found.assignment}: {found.compared} submissions compared. {found.warning}']
    if found.typical is not None:
        lines.append(f'Two of this class are typically {found.typical:.0%} alike.')
    for pair in found.pairs:
        lines += ['', *_pair_lines(pair)]
    if not found.pairs:
        lines.append(f'No two are {found.at_least:.0%} alike or more.')
    if found.more:
        lines.append(f'\n... and {found.more} more pairs; a higher --at-least shortens the list.')
    if found.short:
        lines.append('')
        lines.append(f'Too little of their own to compare: {", ".join(found.short)}')
    return printable('\n'.join(lines))


def _pair_lines(pair: Pair) -> list[str]:
    names = ' = '.join(pair.first)
    if pair.second:
        names = f'{names}  ~  {" = ".join(pair.second)}'
    said = f'{pair.score:4.0%}  {names}'
    if pair.renamed:
        said += f'  (only names differ in {pair.renamed:.0%} of the common lines)'
    lines = [said]
    left = COMMON_LINES
    for part in pair.common:
        for first, second in list(zip(part.first, part.second))[:left]:
            lines.append(f'      | {first}' + (f'   <>   {second}' if first != second else ''))
            left -= 1
        if left <= 0:
            break
    more = sum(len(part.first) for part in pair.common) - (COMMON_LINES - left)
    return [*lines, f'      | ... {more} more lines (--json has all)'] if more else lines


# -- export ---------------------------------------------------------------------------------


def _place(chosen: argparse.Namespace, layout: Layout, ending: str) -> Path:
    """Return the file to write, which may not be there yet."""
    from autograder.files import refuse_existing

    if chosen.to is not None:
        path = Path(chosen.to)
    else:
        name = layout.assignment_named(chosen.assignment) if chosen.assignment else 'all'
        path = layout.work / 'exports' / f'{name}{ending}'
    refuse_existing([path], chosen.force)
    return path


def _write(chosen: argparse.Namespace, path: Path, data: bytes, mode: int = 0o644) -> None:
    from autograder.files import write_file

    write_file(path, data, chosen.force, mode)
    print(path)


def _without_mark(everybody: Sequence[tuple[ClassResults, Sequence[Mark]]]) -> int:
    """Name everyone who has no mark yet; return the exit code."""
    code = OK
    for of_class, given in everybody:
        for mark in given:
            if mark.points is None:
                line = f'no mark: {of_class.assignment}: {mark.student}: {mark.status}'
                print(printable(line), file=sys.stderr)
                code = FOR_REVIEW
    return code


def _csv(chosen: argparse.Namespace) -> int:
    """Write marks."""
    from autograder.classroom.people import read_people
    from autograder.exports.table import marks_csv

    layout = Layout.here()
    path = _place(chosen, layout, '.csv')
    everybody = [
        (one, marks(layout, one, chosen.points)) for one in graded(layout, chosen.assignment)
    ]
    _write(chosen, path, marks_csv(everybody, read_people(layout)))
    return _without_mark(everybody)


def _checks_csv(chosen: argparse.Namespace) -> int:
    """Write checks."""
    from autograder.exports.table import checks_csv

    return _all(chosen, '.checks.csv', checks_csv)


def _json(chosen: argparse.Namespace) -> int:
    """Write everything."""
    from autograder.exports.as_json import results_json

    return _all(chosen, '.json', results_json)


def _junit(chosen: argparse.Namespace) -> int:
    """Write JUnit XML."""
    from autograder.exports.junit import junit_xml

    return _all(chosen, '.junit.xml', junit_xml)


def _all(chosen: argparse.Namespace, ending: str, make: Any) -> int:
    """Write one file that is made of results alone."""
    layout = Layout.here()
    path = _place(chosen, layout, ending)
    found = graded(layout, chosen.assignment)
    _write(chosen, path, make(found))
    return _without_mark([(one, marks(layout, one, AUTOMATIC)) for one in found])


def _canvas(chosen: argparse.Namespace) -> int:
    """Fill a column of Canvas's file."""
    from autograder.exports import canvas

    layout = Layout.here()
    path = _place(chosen, layout, '.canvas.csv')
    if path.resolve() == chosen.gradebook.resolve():
        raise GraderError(f'{path}: expected another file than the one that Canvas gave.')
    given = marks(layout, one_graded(layout, chosen.assignment), chosen.points)
    data = canvas.read_file(chosen.gradebook)
    done = canvas.fill(data, str(chosen.gradebook), chosen.column, given, chosen.scale)
    _write(chosen, path, done.data)
    print(printable(done.text()))
    return FOR_REVIEW if done.left_out else OK


def _gradescope(chosen: argparse.Namespace) -> int:
    """Write one folder per submission."""
    from autograder.exports.gradescope import RESULTS, results_bytes
    from autograder.files import refuse_existing, safe_name, write_file

    layout = Layout.here()
    found = one_graded(layout, chosen.assignment)
    folder = chosen.to or layout.work / 'exports' / f'{found.assignment}.gradescope'
    paths = {one.student: folder / safe_name(one.student) / RESULTS for one in found.results}
    refuse_existing(paths.values(), chosen.force)
    given = marks(layout, found, AUTOMATIC)
    for one, mark in zip(found.results, given):
        if mark.points is None:
            paths[one.student].unlink(missing_ok=True)  # of an earlier grading
        else:
            data = results_bytes(one, chosen.visibility)
            write_file(paths[one.student], data, chosen.force)
    print(folder)
    return _without_mark([(found, given)])


def _container(chosen: argparse.Namespace) -> int:
    """Write the autograder zip, readable by its owner alone."""
    from autograder.exports.gradescope_zip import autograder_zip

    layout = Layout.here()
    assignment = layout.assignment_named(chosen.assignment)
    path = _place(chosen, layout, '.gradescope.zip')
    data = autograder_zip(layout, assignment, chosen.visibility, chosen.allow_weak)
    _write(chosen, path, data, mode=0o600)
    print('It holds the hidden exams and the secret of the course: keep it as secret as they are.')
    return OK

"""
Show results: one HTML page per student, one for the class, and a table in the terminal.

``class.html`` shows the distribution of marks, failed checks and their causes, and all students.
Names, messages and log lines come from students.  So the pages escape all text, allow no script
and load nothing, and the table contains no control characters.
"""

from collections.abc import Mapping, Sequence
import json
from pathlib import Path
from urllib.parse import quote

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup
from rich.console import Console
from rich.table import Table
from rich.text import Text

from autograder.classroom.people import read_people
from autograder.classroom.results_of_class import (
    ClassResults,
    has_mark,
    missing_protections,
    modes,
)
from autograder.classroom.standing import absent, names_for_email, Standing, TO_GRADE
from autograder.classroom.statistics import BINS, CheckNumbers, class_numbers, Marks
from autograder.explaining.feedback import headline, number, printable
from autograder.explaining.feedback_html import checks_html, with_unique_ids
from autograder.files import safe_name, write_atomically
from autograder.layout import Layout
from autograder.results import shortened, SubmissionResult
from drawing import svg

WHY_CHARS = 160
WIDTH, HEIGHT = 640, 200
BASE, TOP, GAP = 160, 28, 8
"""Bottom of the bars, top of the highest bar, and gap between two bars [px]."""


def write_all_reports(
    layout: Layout,
    assignment: str,
    results: Sequence[SubmissionResult],
    summary: str = '',
    by_hand: int = 0,
) -> Path:
    """
    Replace the results of a class and all its pages.

    The results are written first, atomically: all other commands read them, and the pages can be
    generated again.

    :param by_hand: number of submissions that wait for manual grading
    :raises GraderError: if the class list is wrong, or the file of ``collect`` is damaged; then
        nothing is written
    """
    read_people(layout)  # Report a wrong class list before anything is written.
    pages = layout.reports / assignment
    data = json.dumps([result.to_json() for result in results], indent=1)
    write_atomically(pages / 'results.json', f'{data}\n'.encode())
    (pages / 'students').mkdir(exist_ok=True)
    student = _templates().get_template('student.html.j2')
    for result in results:  # A student's own page shows no name.
        page = with_unique_ids(student.render(result=result))
        write_atomically(pages / page_name(result.student), page.encode(), lasting=False)
    written = {page_name(result.student) for result in results}
    for path in (pages / 'students').iterdir():
        if f'students/{path.name}' not in written:
            path.unlink()
    return write_class_report(layout, ClassResults(assignment, tuple(results)), summary, by_hand)


def write_class_report(
    layout: Layout, graded: ClassResults, summary: str = '', by_hand: int = 0
) -> Path:
    """Write the page of a class and return its path; GraderError if the class list is wrong."""
    numbers = class_numbers(layout, graded)
    by_exam: dict[str, list[CheckNumbers]] = {}
    for check in numbers.checks:
        by_exam.setdefault(check.exam, []).append(check)
    results, marks = graded.results, numbers.marks
    unusable = [(one.student, (one.unusable.rstrip('.'),)) for one in results if one.unusable]
    text = (
        _templates()
        .get_template('class_report.html.j2')
        .render(
            numbers=numbers,
            picture=Markup(histogram(marks)) if marks else '',  # noqa: S704 - only numbers
            exams=list(by_exam.items()),
            students={one.student for one in results},
            results=sorted(results, key=lambda one: (not one.review, one.points, one.student)),
            flagged=[*unusable, *((one.student, one.flags) for one in results if one.flags)],
            summary=summary,
            by_hand=by_hand,
            people=read_people(layout),
            names=names_for_email(absent(numbers.missing)),
        )
    )
    folder = layout.reports / graded.assignment
    write_atomically(folder / 'class.html', text.encode('utf-8', 'replace'))
    return folder / 'class.html'


def _labels(marks: Marks) -> list[tuple[str, int]]:
    """Return the range of points of each bar, as text, and its number of submissions."""
    *lower, last = marks.rows()
    rows = [(f'{low} to below {high}', count) for low, high, count in lower]
    return [*rows, (f'{last[0]} to {last[1]}', last[2])]


def histogram(marks: Marks) -> str:
    """Return the histogram of the marks as HTML, with a table of the same numbers."""
    most = max(marks.bins)
    step = WIDTH / BINS
    parts = [svg.line(0, BASE, WIDTH, BASE)]
    for place, (low, high, count) in enumerate(marks.rows()):
        height = (BASE - TOP) * count / most
        middle = (place + 0.5) * step
        if count:
            top = BASE - height
            parts.append(svg.box(place * step + GAP / 2, top, step - GAP, height, colour=svg.BLUE))
            parts.append(svg.text(middle, top - 6, str(count), anchor='middle', bold=True))
        parts.append(svg.text(middle, BASE + 16, f'{low}–{high}', anchor='middle', size=11))
    parts.append(svg.text(WIDTH / 2, BASE + 34, 'points', anchor='middle', faint=True))
    labels = _labels(marks)
    words = ', '.join(f'{label}: {count}' for label, count in labels if count)
    title = f'Distribution of the points of {marks.count} submissions'
    said = f'Number of submissions by points. {words}.'
    return svg.picture(WIDTH, HEIGHT, title, said, parts, [('Points', 'Submissions'), *labels])


def with_name(student: str, people: Mapping[str, str]) -> str:
    """Return a student id, followed by the student's name if it is known."""
    return f'{student} ({people[student]})' if student in people else student


def page_name(student: str) -> str:
    """Return the relative path of a student's page; it is valid for any student id."""
    return f'students/{safe_name(student)}.html'


def _templates() -> Environment:
    """Return the environment of the page templates, which escapes all values."""
    templates = Environment(
        loader=FileSystemLoader(Path(__file__).parents[1] / 'templates'),
        autoescape=True,
        trim_blocks=True,
        undefined=StrictUndefined,
        finalize=lambda value: printable(value) if type(value) is str else value,
    )
    templates.filters.update(
        number=number,
        with_name=with_name,
        words=lambda name: str(name).replace('_', ' ').capitalize(),
        checks=lambda exam: Markup(checks_html(exam)),  # noqa: S704 - it escapes all text
        link=lambda student: quote(page_name(student)),
        why=headline,
        has_mark=has_mark,
        modes=modes,
        lacks=missing_protections,
    )
    return templates


def print_table(
    console: Console,
    assignment: str,
    results: Sequence[SubmissionResult],
    people: Mapping[str, str],
    missing: Sequence[Standing],
) -> None:
    """
    Print students, points and first causes as a table, then the flags for the instructor.

    :param missing: work that could not be collected; its rows contain the reasons
    """
    exams = [exam for one in results for exam in one.exams]
    weak = ', '.join(sorted({exam.mode for exam in exams if exam.not_protected}))
    title = f'{assignment} (WEAK ISOLATION: {weak})' if weak else assignment
    table = Table(title=title, title_justify='left')
    table.add_column('Student', overflow='fold')
    table.add_column('Points', justify='right', no_wrap=True)
    table.add_column('First cause', overflow='fold')
    rows = []
    for result in results:
        points = f'{number(result.points)} of {number(result.max_points)}'
        given = Text('for review', style='bold red') if result.review else Text(points)
        rows.append((result.student, given, headline(result)))
    for one in missing:
        given = Text('not graded' if one.status in TO_GRADE else 'nothing')
        rows.append((one.student, given, one.reason))
    people = {**people, **{one.student: one.person for one in missing if one.person}}
    for student, given, why in rows:
        # Use Text objects: rich must not interpret square brackets from students as markup.
        cause = Text(printable(shortened(why.replace('\n', ' '), WHY_CHARS)))
        table.add_row(Text(printable(with_name(student, people))), given, cause)
    console.print(table)
    for result in results:
        for flag in result.flags:
            console.print(Text(printable(f'flag: {result.student}: {flag}')))

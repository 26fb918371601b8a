"""
Show results: one HTML page per student, an index of the class, and a table in the terminal.

Names, messages and log lines come from students.  So the pages escape all text, allow no script
and load nothing, and the table contains no control characters.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
import json
from pathlib import Path
from typing import Any
from urllib.parse import quote

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup
from rich.console import Console
from rich.table import Table
from rich.text import Text

from autograder.classroom.not_collected import names_to_write_to, NotCollected
from autograder.classroom.results_of_class import has_mark, lacks, modes
from autograder.explaining.feedback import headline, number, printable
from autograder.explaining.feedback_html import checks_html, with_unique_ids
from autograder.files import keep, safe_name
from autograder.results import ExamResult, shortened, SubmissionResult

WHY_CHARS = 160
NOBODY: Mapping[str, str] = {}


def write_reports(
    folder: Path,
    assignment: str,
    results: Sequence[SubmissionResult],
    summary: str = '',
    people: Mapping[str, str] = NOBODY,
    missing: Sequence[NotCollected] = (),
) -> Path:
    """
    Replace the results of a class and their pages.

    The results are written first, atomically: all other commands read them, and the pages can be
    generated again.

    :param folder: folder that receives ``<assignment>/index.html`` and ``<assignment>/students/``
    :param summary: one sentence about the grading
    :param people: names by student id, for the index; a student's own page shows no name
    :param missing: the work that could not be collected
    :returns: path of the index page
    """
    pages = folder / assignment
    data = json.dumps([result.to_json() for result in results], indent=1)
    keep(pages / 'results.json', f'{data}\n'.encode())
    (pages / 'students').mkdir(exist_ok=True)
    templates = _templates()
    written = {page_name(result.student) for result in results}
    for result in results:
        page = templates.get_template('student.html.j2').render(result=result)
        _put(pages / page_name(result.student), with_unique_ids(page))
    index = pages / 'index.html'
    page = templates.get_template('index.html.j2').render(
        assignment=assignment,
        results=results,
        flagged=worth_a_look(results),
        summary=summary,
        people=people,
        missing=missing,
        names=names_to_write_to(missing),
    )
    _put(index, page)
    for path in (pages / 'students').iterdir():
        if f'students/{path.name}' not in written:
            path.unlink()
    return index


def _put(path: Path, text: str) -> None:
    """Write a page atomically: a reader sees either the old page or the new page."""
    unfinished = path.with_name(f'.{path.name}')
    unfinished.write_text(text, encoding='utf-8')
    unfinished.replace(path)


def worth_a_look(results: Sequence[SubmissionResult]) -> list[tuple[str, tuple[str, ...]]]:
    """Return each student with flags for the instructor; unreadable submissions come first."""
    found = [(one.student, (one.unusable.rstrip('.'),)) for one in results if one.unusable]
    return [*found, *((one.student, one.flags) for one in results if one.flags)]


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
        checks=_checks,
        link=lambda student: quote(page_name(student)),
        why=headline,
        has_mark=has_mark,
        modes=modes,
        lacks=lacks,
    )
    return templates


def _checks(exam: ExamResult) -> Any:
    """Return the checks of an exam as HTML, in which all text from students is escaped."""
    return Markup(checks_html(exam))  # noqa: S704


def print_table(
    console: Console,
    assignment: str,
    results: Sequence[SubmissionResult],
    people: Mapping[str, str] = NOBODY,
    missing: Sequence[NotCollected] = (),
) -> None:
    """
    Print a table of students, points and first causes, then the flags for the instructor.

    :param people: names by student id
    :param missing: the work that could not be collected
    """
    exams = [exam for one in results for exam in one.exams]
    weak = ', '.join(sorted({exam.mode for exam in exams if exam.not_protected}))
    title = f'{assignment} (WEAK ISOLATION: {weak})' if weak else assignment
    table = Table(title=title, title_justify='left')
    table.add_column('Student', overflow='fold')
    table.add_column('Points', justify='right', no_wrap=True)
    table.add_column('First cause', overflow='fold')
    for result in results:
        points = f'{number(result.points)} of {number(result.max_points)}'
        why = shortened(headline(result).replace('\n', ' '), WHY_CHARS)
        # Use Text objects: rich must not interpret square brackets from students as markup.
        table.add_row(
            Text(printable(with_name(result.student, people))),
            Text('for review', style='bold red') if result.review else Text(points),
            Text(why),
        )
    for one in missing:
        why = shortened(one.reason.replace('\n', ' '), WHY_CHARS)
        row = f'{one.student} ({one.person})' if one.person else one.student, 'nothing', why
        table.add_row(*(Text(printable(cell)) for cell in row))
    console.print(table)
    if missing:
        text = f'Nothing to grade yet from: {names_to_write_to(missing)}'
        console.print(Text(printable(text)), soft_wrap=True)
    for result in results:
        for flag in result.flags:
            console.print(Text(printable(f'flag: {result.student}: {flag}')))

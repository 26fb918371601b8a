"""
Write the page of a class: the distribution of marks, failed checks and their causes.

The page is one HTML file next to the students' pages.  It can be opened from disk, loads nothing
and has no script; a table repeats the numbers in the picture.  Names and causes come from
students, so all text is escaped.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from markupsafe import Markup

from autograder.classroom.not_collected import (
    names_to_write_to,
    not_collected,
    NotCollected,
)
from autograder.classroom.pages import _templates, NOBODY, worth_a_look, write_reports
from autograder.classroom.people import read_people
from autograder.classroom.results_of_class import ClassResults
from autograder.classroom.statistics import (
    BINS,
    CheckNumbers,
    class_numbers,
    ClassNumbers,
    Marks,
)
from autograder.explaining.feedback import number
from autograder.files import keep
from autograder.layout import Layout
from autograder.results import SubmissionResult
from drawing import svg

PAGE = 'class.html'
WIDTH, HEIGHT = 640, 200
BASE, TOP, GAP = 160, 28, 8
"""Bottom of the bars, top of the highest bar, and gap between two bars [px]."""


def write_class_report(layout: Layout, graded: ClassResults, summary: str = '') -> Path:
    """
    Write the page of a class and return its path.

    :param summary: one sentence about the grading
    """
    path = layout.reports / graded.assignment / PAGE
    students = {one.student for one in graded.results}
    missing = not_collected(layout, graded.assignment, students)
    numbers = class_numbers(layout, graded)
    page = class_page(graded, numbers, summary, read_people(layout), missing)
    keep(path, page.encode('utf-8', 'replace'))
    return path


def write_all_reports(
    layout: Layout, assignment: str, results: Sequence[SubmissionResult], summary: str = ''
) -> Path:
    """
    Replace the results of a class and all its pages.

    :param results: the results of all students
    :param summary: one sentence about the grading
    :returns: path of the index page
    """
    people = read_people(layout)
    missing = not_collected(layout, assignment, {one.student for one in results})
    index = write_reports(layout.reports, assignment, results, summary, people, missing)
    write_class_report(layout, ClassResults(assignment, tuple(results)), summary)
    return index


def class_page(
    graded: ClassResults,
    numbers: ClassNumbers,
    summary: str = '',
    people: Mapping[str, str] = NOBODY,
    missing: Sequence[NotCollected] = (),
) -> str:
    """
    Return the page of a class as HTML.

    :param people: names by student id
    :param missing: the work that could not be collected
    """
    marks = numbers.marks
    return (
        _templates()
        .get_template('class_report.html.j2')
        .render(
            numbers=numbers,
            picture=Markup(histogram(marks)) if marks else '',  # noqa: S704 - only numbers
            bins=[(_label(marks, place), count) for place, count in enumerate(marks.bins)]
            if marks
            else [],
            exams=_by_exam(numbers.checks),
            students={one.student for one in graded.results},
            flagged=worth_a_look(graded.results),
            results=sorted(
                graded.results, key=lambda one: (not one.review, one.points, one.student)
            ),
            summary=summary,
            people=people,
            missing=missing,
            names=names_to_write_to(missing),
        )
    )


def _by_exam(checks: Sequence[CheckNumbers]) -> list[tuple[str, list[CheckNumbers]]]:
    """Group the checks by exam, in the order of the exams."""
    found: dict[str, list[CheckNumbers]] = {}
    for check in checks:
        found.setdefault(check.exam, []).append(check)
    return list(found.items())


def histogram(marks: Marks) -> str:
    """Return the histogram of the marks as SVG; a table on the page shows the same numbers."""
    most = max(marks.bins)
    step = WIDTH / BINS
    parts = [svg.line(0, BASE, WIDTH, BASE)]
    for place, count in enumerate(marks.bins):
        height = (BASE - TOP) * count / most
        middle = (place + 0.5) * step
        if count:
            top = BASE - height
            parts.append(svg.box(place * step + GAP / 2, top, step - GAP, height, colour=svg.BLUE))
            parts.append(svg.text(middle, top - 6, str(count), anchor='middle', bold=True))
        low, high = (number(marks.max_points * edge / BINS) for edge in (place, place + 1))
        parts.append(svg.text(middle, BASE + 16, f'{low}–{high}', anchor='middle', size=11))
    parts.append(svg.text(WIDTH / 2, BASE + 34, 'points', anchor='middle', faint=True))
    words = ', '.join(f'{_label(marks, place)}: {n}' for place, n in enumerate(marks.bins) if n)
    title = f'How the points of {marks.count} submissions are distributed'
    return svg.picture(WIDTH, HEIGHT, title, f'Number of submissions by points. {words}.', parts)


def _label(marks: Marks, place: int) -> str:
    """Return the range of points that a bar represents, as text."""
    low, high = (marks.max_points * edge / BINS for edge in (place, place + 1))
    if place == BINS - 1:
        return f'{number(low)} to {number(high)}'
    return f'{number(low)} to below {number(high)}'

"""
Convert the text of :mod:`autograder.explaining.feedback` to HTML, with pictures.

Visible checks in a notebook, feedback, formgrader and the report of a class use the same HTML.
All text is escaped; the HTML has no script and loads nothing.  It includes its own style, because
the styles of these pages differ.  No information is shown by colour alone.
"""

from collections.abc import Iterable, Mapping
import html
import re
from types import MappingProxyType
from urllib.parse import quote

from autograder.explaining.feedback import (
    causes_once,
    feedback_items,
    points_of,
    printable,
    remarks,
)
from autograder.explaining.picture_svg import picture_html
from autograder.results import CheckResult, ExamResult, Problem, Verdict

Lessons = Mapping[str, str]
"""Addresses of lessons by their numbers, such as ``'08'``; ``''`` is the exercise's own lesson."""
NO_LINKS: Lessons = MappingProxyType({})
HEADS = {
    Verdict.PASSED: '\N{CHECK MARK} Passed',
    Verdict.FAILED: '\N{BALLOT X} Failed',
    Verdict.NOT_RUN: '\N{EN DASH} Not checked',
}
_EDGES = {Verdict.PASSED: '#2e8b57', Verdict.FAILED: '#d64545', Verdict.NOT_RUN: '#8a8a8a'}
_BOX = 'border-left: 4px solid {edge}; padding: 1px 0 1px 12px; margin: 10px 0'
_LIST = (
    'display: grid; grid-template-columns: max-content minmax(0, 1fr); gap: 2px 12px; '
    'margin: 4px 0; padding: 0'
)
_CELL = 'float: none; width: auto; margin: 0; padding: 0'
_TERM = f'{_CELL}; text-align: left; font-weight: 600'
_TEXT = f'{_CELL}; overflow-wrap: anywhere; white-space: pre-wrap'
_PLAIN = 'margin: 2px 0; overflow-wrap: anywhere'
_ID = re.compile(r'<[a-z][^<>]*?\sid="([^"<>]*)"')
_ELSEWHERE = re.compile(r'lesson (\d+), (?:on .*|(.+))')
_WHOLE = 'max-width: 800px; line-height: 1.45'


def exam_html(
    result: ExamResult, problems: Iterable[Problem] = (), lessons: Lessons = NO_LINKS
) -> str:
    """
    Return the result of one exam for a learner, as HTML.

    :param lessons: addresses for links to the sections to read
    """
    said = [f'<p style="{_PLAIN}"><strong>{points_of(result)} points</strong></p>']
    said += [paragraph(remark) for remark in remarks(result, problems)]
    return f'<div style="{_WHOLE}">{"".join(said)}{checks_html(result, lessons)}</div>'


def paragraph(text: str) -> str:
    """Return a text as an HTML paragraph."""
    return f'<p style="{_PLAIN}">{_escaped(text)}</p>'


def checks_html(result: ExamResult, lessons: Lessons = NO_LINKS) -> str:
    """Return all checks of an exam, with pictures; ``lessons`` is as for :func:`exam_html`."""
    return ''.join(_check(check, result, lessons) for check in causes_once(result))


def _check(check: CheckResult, result: ExamResult, lessons: Lessons) -> str:
    points = points_of(check).replace(' ', '\N{NO-BREAK SPACE}')
    head = (
        f'<p style="{_PLAIN}"><strong>{HEADS[check.verdict]}:</strong> '
        f'{_escaped(" ".join(check.title.split()))} ({points})</p>'
    )
    facts = ''.join(
        f'<dt style="{_TERM}">{name}</dt><dd style="{_TEXT}">{_fact(name, text, check, lessons)}'
        '</dd>'
        for name, text in feedback_items(check)
    )
    body = f'<dl style="{_LIST}">{facts}</dl>' if facts else ''
    picture = picture_html(result.pictures.get(check.check, {}))
    style = _BOX.format(edge=_EDGES[check.verdict])
    kind = check.verdict.value.lower()
    return f'<div class="check {kind}" style="{style}">{head}{body}{picture}</div>'


def _fact(name: str, text: str, check: CheckResult, lessons: Lessons) -> str:
    number, heading = named_section(check.read)
    if name != 'read' or number not in lessons:
        return _escaped(text)
    address = html.escape(lessons[number] + (f'#{section_id(heading)}' if heading else ''))
    return f'<a href="{address}">{_escaped(text)}</a>'


def named_section(read: str) -> tuple[str, str]:
    """
    Return the number of the lesson and the heading that a section to read names, ``''`` if none.

    :param read: such as ``Part 2: Names``, ``lesson 02, When a timer ticks`` or, without heading,
        ``lesson 02, on clocks``
    """
    elsewhere = _ELSEWHERE.fullmatch(read)
    return (elsewhere[1], elsewhere[2] or '') if elsewhere else ('', read)


def section_id(heading: str) -> str:
    """Return the id of a heading, such as ``Part 2: Names``, in notebooks and their HTML."""
    return quote(' '.join(heading.split()).replace(' ', '-'), safe=":-_.!~*'()?,")


def with_unique_ids(page: str) -> str:
    """
    Return a page without repeated ids: the second ``Summary`` becomes ``Summary-2``.

    A link to ``Summary`` still leads to the first element with this id.
    """
    taken = set(_ID.findall(page))
    seen: set[str] = set()

    def unique(match: re.Match[str]) -> str:
        name, number = match[1], 1
        while name in seen or (number > 1 and name in taken):
            number += 1
            name = f'{match[1]}-{number}'
        seen.add(name)
        return f'{match[0][: -len(match[1]) - 1]}{name}"'

    return _ID.sub(unique, page)


def _escaped(text: str) -> str:
    return html.escape(printable(text))

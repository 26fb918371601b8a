"""Show the worked answer of an exercise that the learner has solved or tried three times."""

import html
from typing import Any

from autograder.errors import GraderError
from autograder.exam import catalog
from autograder.explaining.worked_answers import FOLDER, read_answers
from autograder.layout import Layout
from roslab.errors import NotHereError, RoslabError
from roslab.output import show
from roslab.progress import FILE, read_results

TRIES = 3
"""Number of tries after which the worked answer opens without full points."""
SHOW = 'Show me a worked answer'


def answer(exam: Any) -> None:
    """
    Show a worked answer, which is one of many right answers.

    :param exam: name of the exercise, as in ``check('talker')``
    :raises RoslabError: if the learner may not see the answer yet
    :raises NotHereError: if this copy has none, for example because the instructor withholds them
    """
    __tracebackhide__ = True
    found = worked_answer(exam)
    if not found:
        raise NotHereError(
            f'answer({exam!r}): this copy of the course has no worked answer of that name.'
        )
    if closed := when_it_opens(exam):
        raise RoslabError(closed)
    show(found, _as_html(found))


def offer(exam: str) -> tuple[str, str]:
    """Return how or when the worked answer opens, as text and as HTML; empty if there is none."""
    try:
        found = worked_answer(exam)
        closed = when_it_opens(exam) if found else ''
    except (GraderError, RoslabError):  # remember() has already reported the problem
        return '', ''
    if not found:
        return '', ''
    if closed:
        return closed, f'<p>{html.escape(closed)}</p>'
    line = f'{SHOW}: from roslab import answer; answer({exam!r})'
    return line, f'<details><summary>{SHOW}</summary>{_as_html(found)}</details>'


def _as_html(text: str) -> str:
    return f'<pre style="white-space: pre-wrap">{html.escape(text)}</pre>'


def worked_answer(exam: Any) -> str:
    """Return the text of a worked answer, empty if this copy contains none."""
    if exam not in catalog.names(hidden=False):
        return ''
    lesson = catalog.load(exam, hidden=False).assignment
    return read_answers(Layout.here().root / FOLDER / f'{lesson}.txt').get(exam, '')


def when_it_opens(exam: str) -> str:
    """Return when the worked answer opens, empty if it is already open."""
    results = read_results(Layout.here().work / FILE)
    left = TRIES - int(results['tries'].get(exam, 0))
    most = catalog.load(exam, hidden=False).max_points
    if left <= 0 or results['checks'].get(exam, 0) >= most:
        return ''
    tries = 'one more try' if left == 1 else f'{left} more tries'
    return f'The worked answer opens when check({exam!r}) gives full points, or after {tries}.'

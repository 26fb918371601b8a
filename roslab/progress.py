"""
Store the last results of ``check(...)`` and ``quiz(...)``; show them and the answers they unlock.

One JSON file in the course's work folder holds the results. It is never sent anywhere, and the
grader never reads it: it is for the learner and is not evidence.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
import fcntl
import html
import json
from math import inf
import os
from pathlib import Path
from typing import Any
from urllib.parse import quote

from autograder.errors import GraderError
from autograder.exam import catalog
from autograder.explaining.feedback import number
from autograder.explaining.feedback_html import section_id
from autograder.explaining.worked_answers import FOLDER, read_answers
from autograder.files import json_bytes, write_atomically
from autograder.layout import Layout, lesson_files
from autograder.submission.outline import Outline, Part, read_outline
from roslab.errors import NotHereError, RoslabError
from roslab.output import say, show, text_table

FILE = 'progress.json'
KINDS = ('checks', 'quizzes', 'tries')
ABOUT = (
    'The last results of check(...) and quiz(...): points, and whether the answer was right; and '
    'how often each answer was checked. Only progress() and answer() read this file; '
    'progress(forget=True) deletes it.'
)
TRIES = 3
"""Number of tries after which the worked answer opens without full points."""
SHOW = 'Show me a worked answer'
HEADER = ('lesson', 'minutes', 'points', 'quiz')

Results = dict[str, dict[str, float]]
"""Points in ``checks`` and numbers of ``tries`` by exam; in ``quizzes``, 1 for a right answer."""


def progress(forget: bool = False) -> None:
    """
    Show your progress: points, right answers to quizzes, and the Part that comes next.

    :param forget: delete all stored results instead
    :raises RoslabError: if the results file has invalid contents
    """
    layout = Layout.here()
    path = layout.work / FILE
    if forget:
        path.unlink(missing_ok=True)
        say(f'Deleted {path}. Your notebooks and saved files are unchanged.')
        return
    results = read_results(path)
    lessons = list(_outlines(lesson_files(layout.notebooks)))
    show(as_text(lessons, results), _as_html(lessons, results))


def remember(kind: str, name: str, result: float, tries: int = 0) -> None:
    """
    Store the last result of an exercise or question; print one line if that fails.

    Only a notebook inside the course's folder is recorded: a copy that is executed elsewhere, for
    example by a test, is not the learner's work.

    :param result: points, or whether the answer was right
    :param tries: number to add to the stored tries, 1 for a check of a completed exercise
    """
    try:
        layout = Layout.here()
        if not Path.cwd().is_relative_to(layout.root):
            return
        path = layout.work / FILE
        path.parent.mkdir(parents=True, exist_ok=True)
        # Two notebooks may finish at the same time; hold a lock to read, add and write.
        with path.with_name(f'.{FILE}.lock').open('w') as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            results = read_results(path)
            results[kind][name] = result
            if tries:
                results['tries'][name] = results['tries'].get(name, 0) + tries
            write_atomically(path, json_bytes({'about': ABOUT, **results}))
    except (GraderError, OSError, RoslabError) as error:
        say(f'progress() will not show this result. {error}')


def read_results(path: Path) -> Results:
    """Return the stored results, empty without a file; RoslabError if the file is not valid."""
    try:
        found = json.loads(path.read_text(encoding='utf-8'))
    except FileNotFoundError:
        return {kind: {} for kind in KINDS}
    except (OSError, ValueError, RecursionError):
        found = None
    if isinstance(found, dict):
        found.setdefault('tries', {})  # older files contain no tries
    if not _is_ours(found):
        raise RoslabError(
            f'{path}: this file does not contain results of check() and quiz(). Try: '
            'progress(forget=True), which deletes this file and nothing else.'
        )
    return {kind: found[kind] for kind in KINDS}


def _is_ours(found: Any) -> bool:
    tables = [found.get(kind) for kind in KINDS] if isinstance(found, dict) else [None]
    return all(
        isinstance(table, dict)
        and all(isinstance(value, (int, float)) and 0 <= value < inf for value in table.values())
        for table in tables
    )


def _outlines(paths: Iterable[Path]) -> Iterable[Outline]:
    for path in paths:
        try:
            outline = read_outline(path)
            yield outline._replace(parts=tuple(map(_in_visible_checks, outline.parts)))
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            yield Outline(path, f'{path.name} cannot be read', (), 0, {})


def _in_visible_checks(part: Part) -> Part:
    """Return a part whose maximum points are those of the visible checks, not the hidden exams."""
    if not part.checks:
        return part  # a course without exercises has no exams
    known = part.checks.keys() & set(catalog.names(hidden=False))
    most = {name: catalog.load(name, hidden=False).max_points for name in known}
    return replace(part, checks={**part.checks, **most})


def next_part(lessons: Iterable[Outline], results: Results) -> tuple[Outline, Part] | None:
    """Return the first Part with an unfinished exercise or an unanswered question, or None."""
    for lesson in lessons:
        for part in lesson.parts:
            solved = all(
                results['checks'].get(name, 0) >= points for name, points in part.checks.items()
            )
            if not solved or not results['quizzes'].keys() >= set(part.quizzes):
                return lesson, part
    return None


def headline(lessons: Iterable[Outline], results: Results) -> tuple[str, str]:
    """Return two phrases: the points so far, and what comes next."""
    points = [_points(lesson, results) for lesson in lessons]
    so_far, most = (number(sum(column)) for column in zip((0, 0), *points))
    found = next_part(lessons, results)
    if found is None:
        return f'{so_far} of {most} points', 'every exercise and question is done'
    heading = found[1].heading.partition(':')[0]
    return f'{so_far} of {most} points', f'next: lesson {found[0].number}, {heading}'


def _points(lesson: Outline, results: Results) -> tuple[float, float]:
    """Return the points reached in a lesson and the maximum."""
    found = results['checks']
    done = (
        min(found.get(name, 0), points)
        for part in lesson.parts
        for name, points in part.checks.items()
    )
    return sum(done), lesson.points


def row_of(lesson: Outline, results: Results) -> tuple[str, ...]:
    """Return the table row of a lesson: its name, minutes, points and right answers."""
    quizzes = [key for part in lesson.parts for key in part.quizzes]
    right = sum(bool(results['quizzes'].get(key)) for key in quizzes)
    points, most = _points(lesson, results)
    return (
        f'{lesson.number} {lesson.title}',
        str(lesson.minutes or ''),
        f'{number(points)} of {number(most)}' if most else '',
        f'{right} of {len(quizzes)}' if quizzes else '',
    )


def as_text(lessons: Sequence[Outline], results: Results) -> str:
    """Return the headline and one row per lesson as plain text."""
    table = [HEADER, *(row_of(lesson, results) for lesson in lessons)]
    return f'{"; ".join(headline(lessons, results))}\n\n{text_table(table, right=(1, 2, 3))}'


def _as_html(lessons: Sequence[Outline], results: Results) -> str:
    """Return the headline and one row per lesson as HTML, with links relative to the notebook."""
    points, after = map(html.escape, headline(lessons, results))
    if found := next_part(lessons, results):
        after = _link(found[0].path, after, f'#{section_id(found[1].heading)}')
    left = 'style="text-align: left"'
    head = f'<th scope="col" {left}>{HEADER[0]}</th>'
    head += ''.join(f'<th scope="col">{name}</th>' for name in HEADER[1:])
    body = ''
    for lesson in lessons:
        name, *others = map(html.escape, row_of(lesson, results))
        cells = ''.join(f'<td>{cell}</td>' for cell in others)
        link = f'<th scope="row" {left}>{_link(lesson.path, name)}</th>'
        body += f'<tr>{link}{cells}</tr>'
    return f'<p><strong>{points}; {after}</strong></p><table><tr>{head}</tr>{body}</table>'


def _link(path: Path, text: str, section: str = '') -> str:
    address = quote(os.path.relpath(path)) + section
    return f'<a href="{html.escape(address)}">{text}</a>'


# -- worked answers -------------------------------------------------------------------------


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
    show(found, _answer_html(found))


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
    return line, f'<details><summary>{SHOW}</summary>{_answer_html(found)}</details>'


def _answer_html(text: str) -> str:
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

"""
Add generated cells to the released lessons: contents, link to the next lesson, map of lessons.

nbgrader runs :class:`AddFrame` when it generates a lesson. ``solutions/START_HERE.ipynb`` has a
cell ``map``, which :func:`start_here` replaces with the table of all lessons.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import nbformat
from nbformat.v4 import new_markdown_cell
from nbgrader.preprocessors import NbGraderPreprocessor

from autograder.explaining.feedback import number
from autograder.explaining.feedback_html import section_id
from autograder.layout import lesson_files
from autograder.submission.outline import Outline, read_outline

START_HERE = 'START_HERE.ipynb'
MAP = 'map'


class AddFrame(NbGraderPreprocessor):
    """Put the contents below the title of a lesson, and a link to the next lesson at its end."""

    def preprocess(self, nb: Any, resources: Any) -> tuple[Any, Any]:
        """Add the cell with the contents and the cell with the link."""
        folder = Path(resources['metadata']['path'])
        lessons = outlines(folder.parent)
        here = [lesson.path.parent.name for lesson in lessons].index(folder.name)
        nb.cells.insert(1, new_markdown_cell(contents(lessons, here), id='lesson-contents'))
        nb.cells.append(new_markdown_cell(next_lesson(lessons, here), id='lesson-next'))
        return nb, resources


def outlines(folder: Path) -> list[Outline]:
    """Return the outlines of all lessons in ``solutions/`` or ``notebooks/``, in order."""
    return [read_outline(path) for path in lesson_files(folder)]


def contents(lessons: Sequence[Outline], here: int) -> str:
    """Return Markdown with the duration, needed lessons, last execution and links of a lesson."""
    lesson = lessons[here]
    facts = [f'{lesson.minutes} minutes.'] if lesson.minutes else []
    if before := needed(lessons, here):
        facts.append(f'First do {", ".join(_link(one, "../") for one in before)}.')
    if executed := lesson.facts.get('executed'):
        facts.append(f'Last executed {executed}.')
    links = [f'* [{part.heading}](#{section_id(part.heading)})' for part in lesson.parts[1:]]
    return '\n'.join([' '.join(['**In this lesson.**', *facts]), '', *links]).rstrip()


def needed(lessons: Sequence[Outline], here: int) -> list[Outline]:
    """Return the lessons that a lesson needs: those it names, else the previous lesson."""
    before = [lesson.number for lesson in lessons[:here][-1:]]
    numbers = lessons[here].facts.get('needs', before)
    return [lesson for lesson in lessons if lesson.number in numbers]


def unknown_needs(lessons: Sequence[Outline]) -> Iterator[str]:
    """Yield one line for each needed lesson that does not exist."""
    known = {lesson.number for lesson in lessons}
    for lesson in lessons:
        for other in sorted({*lesson.facts.get('needs', ())} - known):
            yield f'{lesson.path.parent.name}: it needs lesson {other}, which does not exist.'


def next_lesson(lessons: Sequence[Outline], here: int) -> str:
    """Return the Markdown of the last cell of a lesson: a link to the next lesson or the map."""
    if here + 1 == len(lessons):
        there = (lessons[here].path.parents[1] / START_HERE).is_file()
        link = f' [START_HERE](../{START_HERE}) shows your progress.' if there else ''
        return f'This was the last lesson.{link}'
    return f'*Next lesson:* {_link(lessons[here + 1], "../")}'


def lesson_map(lessons: Sequence[Outline]) -> str:
    """Return the table of all lessons in Markdown."""
    lines = ['| Lesson | Do first | Minutes | Points |', '|---|---|---:|---:|']
    for here, lesson in enumerate(lessons):
        before = ', '.join(one.number for one in needed(lessons, here))
        points = number(lesson.points) if lesson.points else ''
        lines.append(f'| {_link(lesson)} | {before} | {lesson.minutes or ""} | {points} |')
    return '\n'.join(lines)


def _link(lesson: Outline, up: str = '') -> str:
    path = f'{up}{lesson.path.parent.name}/{lesson.path.name}'
    return f'[{lesson.number} {lesson.title}]({path})'


def start_here(solutions: Path, release: Path) -> None:
    """Write ``START_HERE.ipynb`` with the map of the lessons, if the course has its source."""
    source = solutions / START_HERE
    if source.is_file():
        notebook = nbformat.read(source, as_version=4)
        (cell,) = (cell for cell in notebook.cells if cell.id == MAP)
        cell.source = lesson_map(outlines(solutions))
        nbformat.write(notebook, release / START_HERE)

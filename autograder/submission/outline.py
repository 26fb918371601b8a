"""Read the outline of a lesson from its notebook: title, headings, minutes, exercises, needs."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
import re
from typing import Any, NamedTuple

from autograder.submission.notebook import CHECK_PREFIX, marks_of, read_release

FACTS = 'lesson'
"""Key of the lesson's own metadata in a notebook: ``needs`` and ``executed``."""
_QUIZ = re.compile(r"""\bquiz\(['"]([\w-]+)['"]\)""")
_HEADING = re.compile(r'^(##?) (.+)$', re.MULTILINE)
_MINUTES = re.compile(r'^\|.*\| *(\d+) *\|$', re.MULTILINE)
_MINUTES_TITLE = re.compile(r'^\| *Part *\|.*\| *Minutes *\|$', re.MULTILINE)


@dataclass(frozen=True)
class Part:
    """A section of a lesson, below a second-level heading: points by exam, and keys of quizzes."""

    heading: str
    checks: dict[str, float] = field(default_factory=dict)
    quizzes: list[str] = field(default_factory=list)


class Outline(NamedTuple):
    """
    The outline of one lesson.

    :param parts: the first part precedes the first heading, and its heading is the title
    :param minutes: estimated duration, the sum in the table of parts [min]
    :param facts: the notebook's metadata with the key :data:`FACTS`
    """

    path: Path
    title: str
    parts: tuple[Part, ...]
    minutes: int
    facts: Mapping[str, Any]

    @property
    def number(self) -> str:
        """Return the number of the lesson, such as ``03``."""
        return self.path.parent.name[:2]

    @property
    def points(self) -> float:
        """Return the sum of the points of all exercises."""
        return sum(sum(part.checks.values()) for part in self.parts)


def read_outline(path: Path) -> Outline:
    """Return the outline of a notebook; raise an OSError or ValueError if it cannot be read."""
    notebook = read_release(path)
    parts, minutes = [Part(path.stem)], 0
    for cell in notebook['cells']:
        if cell['cell_type'] == 'code':
            marks = marks_of(cell)
            if marks.get('grade') and not marks.get('solution'):
                name = marks['grade_id'].removeprefix(CHECK_PREFIX)
                parts[-1].checks[name] = float(marks['points'])
            parts[-1].quizzes.extend(_QUIZ.findall(cell['source']))
            continue
        text = re.sub(r'```.*?```', '', cell['source'], flags=re.DOTALL)
        for level, heading in _HEADING.findall(text):
            if level == '##':
                parts.append(Part(heading.strip()))
            elif len(parts) == 1:
                parts[0] = Part(heading.strip(), parts[0].checks, parts[0].quizzes)
        if not minutes and _MINUTES_TITLE.search(text):
            minutes = sum(map(int, _MINUTES.findall(text)))
    facts = notebook.get('metadata', {}).get(FACTS, {})
    return Outline(path, parts[0].heading, tuple(parts), minutes, facts)

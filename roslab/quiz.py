"""
Multiple-choice questions for practice: ``quiz('03-matched')`` shows one and explains each answer.

The questions are in ``roslab/quizzes/NN_topic.yaml``, one file per lesson, as a list of::

    - key: 03-matched
      question: One or two sentences. May contain `code`.
      options:
        - text: an answer
          right: true
          why: Why it is right.
        - text: another answer
          why: Names the misconception behind it and corrects it.

The order of the options depends only on the key, so authors can put the right one anywhere.  Only
the result of the last answer is stored, see :mod:`roslab.progress`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
import random
import textwrap
from typing import Any

import yaml

from roslab.errors import RoslabError

FOLDER = Path(__file__).parent / 'quizzes'
LETTERS = 'abcd'


class QuizError(RoslabError):
    """Raised if a question does not exist or its file contains a mistake."""


@dataclass(frozen=True)
class Option:
    """One answer of a question; ``why`` is shown after the learner chooses it."""

    text: str
    right: bool
    why: str


@dataclass(frozen=True)
class Question:
    """One question with three or four options, exactly one of them right."""

    key: str
    text: str
    options: tuple[Option, ...]

    def __str__(self) -> str:
        lines = [textwrap.fill(self.text, 99)]
        for letter, option in zip(LETTERS, self.options):
            text = f'  {letter}) {option.text}'
            lines.append(textwrap.fill(text, 99, subsequent_indent='     '))
        return '\n'.join(lines)


def quiz(key: str) -> Any:
    """
    Show a question; an explanation follows each choice, and the choice may be changed.

    :param key: key of the question, such as '03-matched'
    :raises QuizError: if there is no such question; the message lists similar keys
    """
    __tracebackhide__ = True
    question = find(key)
    from roslab.widgets import QuizWidget  # slow to import, and only some lessons need it

    return QuizWidget(question)


def find(key: str, folder: Path = FOLDER) -> Question:
    """Return a question; QuizError if no question has this key, or its file has a mistake."""
    __tracebackhide__ = True
    lesson = str(key)[:2]
    own = [path for path in files(folder) if path.name.startswith(f'{lesson}_')]
    known = [question for path in own for question in load(path)]
    for question in known:
        if question.key == key:
            return question
    everything = known or [one for path in files(folder) for one in load(path)]
    keys = [one.key for one in everything]
    near = get_close_matches(str(key), keys, n=3, cutoff=0.3) or keys[:3]
    raise QuizError(
        f'quiz({key!r}): expected the key of a question, such as '
        f'{", ".join(map(repr, near)) or "none: there are no questions"}; there is no {key!r}.'
    )


def files(folder: Path = FOLDER) -> list[Path]:
    """Return the files with questions, sorted by lesson."""
    return sorted(folder.glob('*.yaml'))


def load(path: Path) -> list[Question]:
    """Read all questions of a file; QuizError if it is not a list as described above."""
    __tracebackhide__ = True
    try:
        return [_question(entry) for entry in yaml.safe_load(path.read_text(encoding='utf-8'))]
    except (yaml.YAMLError, KeyError, TypeError, AttributeError) as error:
        raise QuizError(
            f'{path.name}: this is not a list of questions: {" ".join(str(error).split())}. '
            'Try: pytest tests/unit/test_roslab_quiz.py, which names each mistake'
        ) from None


def _question(entry: Mapping[str, Any]) -> Question:
    options = [
        Option(_line(one['text']), one.get('right', False), _line(one['why']))
        for one in entry['options']
    ]
    random.Random(entry['key']).shuffle(options)
    return Question(entry['key'], _line(entry['question']), tuple(options))


def _line(text: str) -> str:
    return ' '.join(text.split())

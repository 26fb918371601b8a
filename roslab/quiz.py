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

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
import random
import re
import textwrap
from typing import Any

import yaml

from roslab.errors import RoslabError

FOLDER = Path(__file__).parent / 'quizzes'
LETTERS = 'abcd'
_KEY = re.compile(r'^\d\d-[a-z0-9]+(-[a-z0-9]+)*$')


class QuizError(RoslabError):
    """Raised if a question does not exist or its file contains a mistake."""


@dataclass(frozen=True)
class Option:
    """
    One answer of a multiple-choice question.

    :param why: explanation shown after the learner chooses the answer
    """

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
            lines.append(
                textwrap.fill(
                    option.text, 99, initial_indent=f'  {letter}) ', subsequent_indent='     '
                )
            )
        return '\n'.join(lines)


def quiz(key: str) -> Any:
    """
    Show a question; an explanation follows each choice, and the choice may be changed.

    :param key: key of the question, such as '03-matched'
    :raises QuizError: if there is no such question; the message lists similar keys
    """
    __tracebackhide__ = True
    question = find(key)
    from roslab.quiz_widget import QuizWidget  # slow to import, and only some lessons need it

    return QuizWidget(question)


def find(key: str, folder: Path = FOLDER) -> Question:
    """
    Return a question.

    :raises QuizError: if no question has this key, or its file contains a mistake
    """
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
    """
    Read all questions of one file.

    :raises QuizError: for the first mistake, with its location
    """
    __tracebackhide__ = True
    try:
        found = yaml.safe_load(path.read_text(encoding='utf-8'))
    except yaml.YAMLError as error:
        raise QuizError(
            f'{path.name}: expected YAML, got {_one_line(error)}. '
            'Quote strings that contain a colon or begin with a backtick.'
        ) from None
    if not isinstance(found, list) or not found:
        raise QuizError(
            f'{path.name}: expected a list of questions, each beginning with "- key:".'
        )
    return [_question(entry, f'{path.name}, question {n}') for n, entry in enumerate(found, 1)]


def _question(entry: Any, where: str) -> Question:
    __tracebackhide__ = True
    entry = _mapping(entry, where, needed=('key', 'question', 'options'))
    key = _text(entry, 'key', where)
    where = f'{where} ({key})'
    if not _KEY.match(key):
        raise QuizError(
            f'{where}: expected a key of the lesson and lower-case words, as in 03-matched.'
        )
    listed = entry['options']
    if not isinstance(listed, list) or not 3 <= len(listed) <= 4:
        count = len(listed) if isinstance(listed, list) else 'no list'
        raise QuizError(f'{where}: expected 3 or 4 options, got {count}.')
    options = [_option(one, f'{where}, option {n}') for n, one in enumerate(listed, 1)]
    right = sum(option.right for option in options)
    if right != 1:
        raise QuizError(f'{where}: expected one option with "right: true", got {right}.')
    if len({_plain(option.text) for option in options}) < len(options):
        raise QuizError(f'{where}: two options are the same.')
    random.Random(key).shuffle(options)
    return Question(key, _text(entry, 'question', where), tuple(options))


def _option(entry: Any, where: str) -> Option:
    __tracebackhide__ = True
    entry = _mapping(entry, where, needed=('text', 'why'), allowed=('right',))
    right = entry.get('right', False)
    if not isinstance(right, bool):
        raise QuizError(f'{where}: expected right to be true or false, got {right!r}.')
    return Option(_text(entry, 'text', where), right, _text(entry, 'why', where))


def _mapping(
    entry: Any, where: str, needed: tuple[str, ...], allowed: tuple[str, ...] = ()
) -> Mapping[str, Any]:
    __tracebackhide__ = True
    if not isinstance(entry, dict):
        raise QuizError(f'{where}: expected {", ".join(needed)}, got {entry!r}.')
    missing = [name for name in needed if name not in entry]
    unknown = [str(name) for name in entry if name not in (*needed, *allowed)]
    if missing or unknown:
        said = [f'{", ".join(missing)} is missing'] if missing else []
        said += [f'{", ".join(unknown)} is not known here'] if unknown else []
        raise QuizError(f'{where}: {" and ".join(said)}.')
    return entry


def _text(entry: Mapping[str, Any], name: str, where: str) -> str:
    """Return a one-line string; numbers and `true` without quotes are rejected."""
    __tracebackhide__ = True
    value = entry[name]
    if not isinstance(value, str) or not value.strip():
        raise QuizError(
            f'{where}: expected {name} to be a string, in quotes if necessary: {value!r}.'
        )
    text = ' '.join(value.split())
    if text.count('`') % 2:
        raise QuizError(f'{where}: {name} has an unmatched backtick.')
    return text


def _plain(text: str) -> str:
    return text.replace('`', '').casefold().rstrip('.')


def _one_line(error: Exception) -> str:
    return ' '.join(str(error).split())

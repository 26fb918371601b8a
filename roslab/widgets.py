"""The widgets of a browser: a live picture, and a question, which is plain text elsewhere."""

from dataclasses import asdict
import html
from pathlib import Path
import re
from typing import Any

import anywidget
import traitlets

from roslab.progress import remember
from roslab.quiz import LETTERS, Question

_HERE = Path(__file__).parent


class PictureWidget(anywidget.AnyWidget):
    """The newest picture as HTML; pages draw it into the elements with ``data-picture=place``."""

    _esm = _HERE / 'picture.js'
    place = traitlets.Unicode().tag(sync=True)
    picture = traitlets.Unicode().tag(sync=True)
    is_shown = False

    def __init__(self, place: str) -> None:
        super().__init__(place=place)
        # Receiving a synchronised trait would delay `picture`, which another thread sets.
        self.on_msg(lambda *_: setattr(self, 'is_shown', True))


class QuizWidget(anywidget.AnyWidget):
    """A question with radio buttons and an explanation for each option."""

    _esm = _HERE / 'quiz.js'
    _css = _HERE / 'quiz.css'
    question = traitlets.Dict().tag(sync=True)
    chosen = traitlets.Int(-1).tag(sync=True)

    def __init__(self, question: Question) -> None:
        self._text = str(question)
        options = list(map(asdict, question.options))
        super().__init__(question={'text': question.text, 'options': options})
        self.observe(lambda change: _note(question, change['new']), 'chosen')

    def __repr__(self) -> str:
        """Return the question and its lettered options, for viewers without widgets."""
        return self._text

    def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        """Add the question as HTML, for pages without a kernel."""
        data, about = super()._repr_mimebundle_(**kwargs)
        return {**data, 'text/html': as_html(self.question)}, about


def as_html(question: dict[str, Any]) -> str:
    """Return a question as HTML in which each option opens its explanation."""
    options = ''.join(
        f'<details><summary>{letter}) {_with_code(option["text"])}</summary>'
        f'<p><strong>{"Right" if option["right"] else "Wrong"}.</strong> '
        f'{_with_code(option["why"])}</p></details>'
        for letter, option in zip(LETTERS, question['options'])
    )
    return f'<div class="quiz"><p>{_with_code(question["text"])}</p>{options}</div>'


def _with_code(text: str) -> str:
    return re.sub('`(.*?)`', r'<code>\1</code>', html.escape(text))


def _note(question: Question, chosen: int) -> None:
    """Store whether the last answer was right."""
    if 0 <= chosen < len(question.options):
        remember('quizzes', question.key, question.options[chosen].right)

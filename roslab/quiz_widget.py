"""Show a question: a widget in the browser, plain text everywhere else."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import anywidget
import traitlets

from roslab.quiz import Question

_HERE = Path(__file__).parent


class QuizWidget(anywidget.AnyWidget):
    """
    A question with radio buttons and an explanation for each of them.

    :param question: what to ask
    """

    _esm = _HERE / 'quiz.js'
    _css = _HERE / 'quiz.css'
    question = traitlets.Dict().tag(sync=True)
    chosen = traitlets.Int(-1).tag(sync=True)

    def __init__(self, question: Question) -> None:
        self._text = str(question)
        super().__init__(question=_to_json(question))

    def __repr__(self) -> str:
        """Return the question and its lettered options, for viewers without widgets."""
        return self._text


def _to_json(question: Question) -> dict[str, Any]:
    return {
        'text': question.text,
        'options': [
            {'text': option.text, 'right': option.right, 'why': option.why}
            for option in question.options
        ],
    }

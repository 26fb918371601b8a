"""
Errors that a notebook shows as one line.

IPython lets an exception choose how it is shown.  These exceptions leave out the frames of this
package, which do not help learners.
"""

from __future__ import annotations

from typing import TypeVar


class RoslabError(Exception):
    """Raised for a call that cannot work, with what was expected and what to try."""

    def _render_traceback_(self) -> list[str]:
        return [f'{type(self).__name__}: {self}']


class NameRefusedError(RoslabError):
    """A magic line names no file that may be written."""


class AnswerRefusedError(RoslabError):
    """An ``%%answer`` cell holds none of the letters."""


class NodeSyntaxError(RoslabError):
    """A ``%%node`` cell is not valid Python; IPython would add its own frames to a SyntaxError."""


class NotHereError(RoslabError):
    """Something is missing that has to exist first; the message says what to run."""


E = TypeVar('E', bound=BaseException)


def shown_as(error: E, text: str) -> E:
    """
    Let a notebook show an error as a given text instead of a traceback.

    :param error: any error; its type is unchanged
    :param text: all that is shown
    """
    error._render_traceback_ = lambda: [text]  # type: ignore[attr-defined]
    return error


def not_written_yet(message: str) -> NotImplementedError:
    """
    Return the error of an exercise that still has its stub.

    :param message: which cell, and what to do
    """
    return shown_as(NotImplementedError(message), f'NotImplementedError: {message}')

"""
Define the errors that a notebook shows as one line.

IPython lets an exception choose how it is shown.  These exceptions omit the frames of this
package, which do not help learners.
"""

from typing import TypeVar


class RoslabError(Exception):
    """Raised when a call cannot work; the message gives the expected value and what to try."""

    def _render_traceback_(self) -> list[str]:
        return [f'{type(self).__name__}: {self}']


class NameRefusedError(RoslabError):
    """Raised when a magic line does not name a file that may be written."""


class AnswerRefusedError(RoslabError):
    """Raised when an ``%%answer`` cell does not contain one of the letters in quotes."""


class NodeSyntaxError(RoslabError):
    """Raised for invalid Python in a ``%%node`` cell; IPython adds frames to a SyntaxError."""


class NotHereError(RoslabError):
    """Raised when something that must already exist is missing; the message names it."""


E = TypeVar('E', bound=BaseException)


def shown_as(error: E, text: str) -> E:
    """Make a notebook show a given text instead of the traceback of an error."""
    error._render_traceback_ = lambda: [text]  # type: ignore[attr-defined]
    return error


def not_written_yet(message: str) -> NotImplementedError:
    """Return the error for an exercise whose stub is still unchanged."""
    return shown_as(NotImplementedError(message), f'NotImplementedError: {message}')

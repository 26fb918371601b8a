"""
Explain ERROR lines that come from a mistake in the code, logged in an ``except`` block.

Only the text of the line distinguishes such a mistake from an ERROR that the exercise requires.
"""

from __future__ import annotations

from collections.abc import Sequence
import re

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.exceptions import exception_cause
from autograder.judging.causes.redaction import quoted
from autograder.judging.causes.tracebacks import Traceback
from autograder.recording import ERROR, Event

_ATTRIBUTE = re.compile(r"'\w{1,40}' object has no attribute '\w{1,60}'")
_PYTHON = re.compile(
    r'has no attribute|is not defined|object is not|not supported between|unsupported operand|'
    r'positional argument|keyword argument|could not convert|can only concatenate|'
    r'not all arguments|not associated with a value|out of range|must be real|'
    r'[Dd]ivision by zero|format code|format string|'
    r'\b(?:Type|Name|Attribute|Key|Index|Assertion|UnboundLocal|ZeroDivision)Error\b'
)
"""Parts of Python's error messages, without ValueError, which exercises raise themselves."""


def why_exception_logged(run: Run, lines: Sequence[Event]) -> Cause | None:
    """
    Explain the first ERROR line if it contains one of Python's error messages.

    :param lines: log lines of the node's own logger
    """
    texts = [str(one['text']) for one in lines if one['level'] == ERROR][:1]
    attribute = _ATTRIBUTE.search(texts[0]) if texts else None
    if attribute and quoted(run, attribute[0]) == attribute[0]:
        return exception_cause(Traceback(f'AttributeError: {attribute[0]}', '', None))
    return why_error_logged(run, texts[0]) if texts and _PYTHON.search(texts[0]) else None


def why_error_logged(run: Run, text: str) -> Cause:
    """Return a cause that quotes an ERROR line of the node."""
    return Cause(
        'logged_error',
        f"Your node logs this error: '{quoted(run, text)}'.",
        'If an except logs it, take try and except out for a moment: the traceback names the '
        'line. If not, which condition leads to that line?',
    )

"""Wait for a condition while nodes run, with a time limit."""

from collections.abc import Callable
import math
from typing import TypeVar

from roslab.errors import RoslabError, shown_as
from roslab.session import session

T = TypeVar('T')

_SLICE_S = 0.05
"""Time between two checks of the condition while no callback runs, as during discovery [s]."""


def wait_in(condition: Callable[[], T], timeout_s: float) -> T:
    """
    Wait in this thread while the nodes of this kernel continue to run.

    :param condition: evaluated after each callback
    :param timeout_s: how long to wait [s]
    :returns: the last value of the condition, which is false after a timeout
    :raises RoslabError: if called from a callback, or without a time limit
    """
    if not callable(condition):
        raise RoslabError(
            'wait_until() expected a function to call repeatedly, as in '
            f'wait_until(lambda: len(heard) > 2), got {condition!r}.'
        )
    if not (isinstance(timeout_s, (int, float)) and math.isfinite(timeout_s) and timeout_s >= 0):
        raise RoslabError(f'timeout: expected a number of seconds, as in 5.0, got {timeout_s!r}.')
    if session().executor.is_this_thread:
        raise RoslabError(
            'A callback cannot wait for other callbacks: all of them run in one thread. '
            'Return from it, and do the rest in the callback that you are waiting for.'
        )
    value: T = session().progress.wait(condition, timeout_s, _SLICE_S)
    return value


def wait_until(condition: Callable[[], T], timeout: float = 5.0, what: str = 'a condition') -> T:
    """
    Wait until a condition is true; nodes continue to run meanwhile.

    :param condition: called after each callback, until it returns a true value
    :param timeout: the longest time to wait [s]
    :param what: description of the condition, for the error message
    :returns: what the condition returned
    :raises TimeoutError: after ``timeout``; its message lists possible reasons
    """
    value = wait_in(condition, timeout)
    if not value:
        hints = session().hints()
        raise timeout_error(f'Waited {timeout:g} s for {what} without success.', hints)
    return value


def timeout_error(*sentences: str) -> TimeoutError:
    """Return a TimeoutError for which a notebook shows only the given sentences."""
    text = ' '.join(sentence for sentence in sentences if sentence)
    return shown_as(TimeoutError(text), f'TimeoutError: {text}')

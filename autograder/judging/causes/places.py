"""
Find the line of the learner's code that a cause speaks about.

The table ``places.txt`` has the acts of each cause; :mod:`autograder.submission.code.acts` finds
them.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import cache

from autograder.exam.exam import Cause, Run
from autograder.judging.causes.text_table import rows_of
from autograder.submission.code.acts import place_of
from autograder.submission.code.learners_code import Code


def place_in_code(run: Run, why: Cause, lines: Collection[int] = ()) -> str:
    """
    Return the beginning of a message with the place of a cause, empty if there is no single place.

    :param lines: of the log calls that show the failure
    """
    acts = _acts().get(why.cause_id)
    if acts is None or why.text.startswith('Line '):
        return ''
    place = place_of(Code(run.files), acts, why.about, lines)
    return place.words if place else ''


@cache
def _acts() -> dict[str, str]:
    return {one: acts for causes, acts in rows_of('places.txt') for one in causes.split()}

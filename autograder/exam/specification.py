"""
Define the correct answers to the inputs of an exercise, and typical wrong answers.

An exam knows what it sends.  So what a right program answers can be computed, and so can what a
program with a known mistake answers: that is a :class:`Slip`.  The cause of a failed check is the
slip that gives the answers that came::

    Specification(
        inputs=(4.0, -8.0),
        due=each(lambda number: number / 2),
        slips=(Slip('sign_lost', 'The sign is lost.', 'Leave out abs().', each(half_of_abs)),),
    )

Nothing here decides points.  An exam is refused if its inputs cannot distinguish a slip from the
correct answers (:meth:`Specification.mistakes`): a program with that slip would pass.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
import math
from typing import Any

Rule = Callable[[Sequence[Any]], Sequence[Any]]
"""From all inputs, in order, to the answer to each: a number, a text or a tuple."""


def each(answer: Callable[[Any], Any]) -> Rule:
    """Return the rule of a program without memory, which answers each input by itself."""
    return lambda inputs: [answer(one) for one in inputs]


def same(one: Any, other: Any) -> bool:
    """
    Return whether two answers are the same; floats to nine digits, and NaN is NaN.

    :param other: as recorded: JSON has no NaN, so a float may be ``'nan'``, ``'inf'``, ``'-inf'``
    """
    if isinstance(one, float) and other in ('nan', 'inf', '-inf'):
        other = float(other)
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, float) and isinstance(other, float):
        both_nan = math.isnan(one) and math.isnan(other)
        return both_nan or math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-9)
    return bool(one == other)


@dataclass(frozen=True)
class Cause:
    """
    Why a check probably failed.

    :param cause_id: short stable name, for statistics and tests
    :param text: the reason in the learner's words
    :param try_this: the next thing to do
    """

    cause_id: str
    text: str
    try_this: str


@dataclass(frozen=True, init=False)
class Slip(Cause):
    """
    A specification with one mistake in it, which is the cause if a program answers so.

    :param rules: what a program with this mistake answers; several if the mistake has several
        forms, such as a number of digits
    """

    rules: tuple[Rule, ...]

    def __init__(self, cause_id: str, text: str, try_this: str, *rules: Rule) -> None:
        """Take the rules behind the texts."""
        super().__init__(cause_id, text, try_this)
        object.__setattr__(self, 'rules', rules)

    @classmethod
    def of(cls, cause: Cause, *rules: Rule) -> Slip:
        """Return the slip of a cause that is also named where no rule explains all answers."""
        return cls(cause.cause_id, cause.text, cause.try_this, *rules)


@dataclass(frozen=True)
class Specification:
    """
    One thing that an exercise asks for, with the inputs of one exam.

    :param inputs: in the order in which they are sent
    :param due: what a right program answers
    :param slips: the likelier first
    :param burst: how many of the last inputs come at once.  They count as one: several threads
        may answer them in any order
    :param like: tells whether two answers are the same
    """

    inputs: Sequence[Any]
    due: Rule
    slips: Sequence[Slip] = ()
    burst: int = 0
    like: Callable[[Any, Any], bool] = same

    def of(self, rule: Rule) -> list[Any]:
        """Return the answers that a rule gives, with those to a burst joined into one."""
        found = list(rule(self.inputs))
        if not self.burst:
            return found
        return [*found[: -self.burst], together(found[-self.burst :])]

    def row(self, place: int) -> Sequence[Any]:
        """Return the input in a place, or all of the burst."""
        last = len(self.inputs) - self.burst
        return (
            self.inputs[last:] if self.burst and place == last else self.inputs[place : place + 1]
        )

    @cached_property
    def answers(self) -> list[Any]:
        """Return what is due."""
        return self.of(self.due)

    @cached_property
    def _slipped(self) -> list[tuple[Slip, list[Any]]]:
        """Return each form of each slip with its answers."""
        return [(slip, self.of(rule)) for slip in self.slips for rule in slip.rules]

    def wrong(self, came: Sequence[Any], part: Collection[int] | None = None) -> list[int]:
        """
        Return the places of the inputs that were not answered as they should be.

        :param came: the answers, one for each input or burst; None where the run ended before
        :param part: only these places
        """
        places = range(len(came)) if part is None else part
        return [
            place
            for place in places
            if came[place] is not None and not self.like(self.answers[place], came[place])
        ]

    def cause(self, came: Sequence[Any], place: int, *parts: Collection[int]) -> Slip | None:
        """
        Return the slip that explains all answers, or else all those of a part.

        A part helps where a program has two mistakes; a small one is explained by too many slips.

        :param came: see :meth:`wrong`
        :param place: of a wrong answer; a part without it explains nothing
        :param parts: places that belong together, the larger part first
        """
        for part in (range(len(came)), *parts):
            seen = [one for one in part if came[one] is not None]
            for slip, slipped in self._slipped if place in seen else ():
                if all(self.like(slipped[one], came[one]) for one in seen):
                    return slip
        return None

    def mistakes(self) -> Iterator[str]:
        """Yield the slips that these inputs do not tell from the right answers or each other."""
        rules = [('what is due', self.answers)]
        rules += [(slip.cause_id, answers) for slip, answers in self._slipped]
        for number, (name, answers) in enumerate(rules):
            for other, others in rules[:number]:
                if other != name and all(map(self.like, answers, others)):
                    yield f'no input tells {name} from {other}'


def together(answers: Sequence[Any]) -> Any:
    """Return several answers as one: the sum of numbers, all parts of tuples in order."""
    if all(isinstance(one, tuple) for one in answers):
        return in_order(part for one in answers for part in one)
    return sum(answers)


def in_order(answers: Iterable[Any]) -> tuple[Any, ...]:
    """Return answers of any kinds in an order that does not depend on how they came."""
    return tuple(sorted(answers, key=_order))


def _order(answer: Any) -> tuple[Any, ...]:
    if isinstance(answer, tuple):
        return tuple(map(_order, answer))
    text = isinstance(answer, str) or (isinstance(answer, float) and not math.isfinite(answer))
    number = isinstance(answer, (int, float)) and not text
    return (text, number, answer if number else str(answer))

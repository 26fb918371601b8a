"""
Define the correct answers to the inputs of an exercise, and typical wrong answers.

An exam has fixed inputs.  So it can compute the answers of a correct program, and those of a
program with a known mistake, a :class:`Slip`.  If a check fails, its cause is the slip that gives
exactly the recorded answers::

    Specification(
        inputs=(4.0, -8.0),
        due=each(lambda number: number / 2),
        slips=(Slip('sign_lost', 'The sign is lost.', 'Leave out abs().', each(half_of_abs)),),
    )

This module does not award points.  An exam is rejected if its inputs cannot distinguish a slip
from the correct answers (:meth:`Specification.mistakes`), because a program with that slip would
pass.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
import math
from typing import Any

Rule = Callable[[Sequence[Any]], Sequence[Any]]
"""Maps all inputs, in order, to the answer to each: a number, a string or a tuple."""


def each(answer: Callable[[Any], Any]) -> Rule:
    """Return the rule of a stateless program, which answers each input independently."""
    return lambda inputs: [answer(one) for one in inputs]


def same(one: Any, other: Any) -> bool:
    """
    Return whether two answers are equal: floats to nine digits, and NaN equals NaN.

    :param one: the expected answer
    :param other: the recorded answer; JSON has no NaN, so a float may be ``'nan'``, ``'inf'`` or
        ``'-inf'``
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
    The likely reason why a check failed.

    :param cause_id: short stable name, for statistics and tests
    :param text: the reason, worded for the learner
    :param about: names, strings or numbers in the faulty line, which help to find it
    :param act: what the program does in that line, see :mod:`autograder.submission.code.acts`; by
        default, as in ``judging/causes/places.txt``
    :param line: that line, from 1, if the run shows it, as a traceback does
    :param closer: more precise causes of the same answers, each with an act; the first one whose
        act the program performs replaces this cause
    """

    cause_id: str
    text: str
    try_this: str
    about: Sequence[str] = ()
    act: str = ''
    line: int | None = None
    closer: Sequence[Cause] = ()


@dataclass(frozen=True, init=False)
class Slip(Cause):
    """
    A specification with one mistake: the likely cause if a program gives the same answers.

    :param rules: return the answers of a program with this mistake; several if the mistake has
        several forms, such as different numbers of digits
    :param sometimes: whether a program may make the mistake for only some of the inputs
    """

    rules: tuple[Rule, ...] = ()
    sometimes: bool = False

    def __init__(
        self,
        cause_id: str,
        text: str,
        try_this: str,
        *rules: Rule,
        sometimes: bool = False,
        **more: Any,
    ) -> None:
        super().__init__(cause_id, text, try_this, **more)
        object.__setattr__(self, 'rules', rules)
        object.__setattr__(self, 'sometimes', sometimes)

    @classmethod
    def of(cls, cause: Cause, *rules: Rule, sometimes: bool = False) -> Slip:
        """Return the slip for a cause that checks may also report without a matching rule."""
        more: dict[str, Any] = {'act': cause.act, 'closer': cause.closer, 'sometimes': sometimes}
        return cls(cause.cause_id, cause.text, cause.try_this, *rules, **more)


@dataclass(frozen=True)
class Specification:
    """
    The inputs of one exam with the correct answers and typical wrong ones.

    :param inputs: in the order in which they are sent
    :param slips: the most likely first
    :param burst: number of inputs at the end that are sent at once.  They have one joint answer,
        because several threads may answer them in any order
    :param like: returns whether two answers are equal
    """

    inputs: Sequence[Any]
    due: Rule
    slips: Sequence[Slip] = ()
    burst: int = 0
    like: Callable[[Any, Any], bool] = same

    def of(self, rule: Rule) -> list[Any]:
        """Return the answers that a rule gives, with those to a burst merged into one."""
        found = list(rule(self.inputs))
        if not self.burst:
            return found
        return [*found[: -self.burst], merge_answers(found[-self.burst :])]

    def row(self, place: int) -> Sequence[Any]:
        """Return the input at an index, or the whole burst."""
        last = len(self.inputs) - self.burst
        return (
            self.inputs[last:] if self.burst and place == last else self.inputs[place : place + 1]
        )

    @cached_property
    def answers(self) -> list[Any]:
        """Return the correct answers."""
        return self.of(self.due)

    @cached_property
    def _slipped(self) -> list[tuple[Slip, list[Any]]]:
        """Return each form of each slip with its answers."""
        return [(slip, self.of(rule)) for slip in self.slips for rule in slip.rules]

    def wrong(self, came: Sequence[Any], part: Collection[int] | None = None) -> list[int]:
        """
        Return the indices of the inputs with a wrong answer.

        :param came: the answers, one per input or burst; None for inputs after the end of the run
        :param part: check only these indices
        """
        places = range(len(came)) if part is None else part
        return [
            place
            for place in places
            if came[place] is not None and not self.like(self.answers[place], came[place])
        ]

    def cause(
        self, came: Sequence[Any], place: int | None = None, part: Collection[int] = ()
    ) -> Slip | None:
        """
        Return the slip that explains all answers, or otherwise all answers of one part.

        A part helps if a program has two mistakes.  A small part is unreliable: too many slips
        explain it.  A slip that happens only sometimes may explain only the wrong answers.  If
        only the burst is wrong, its answers may be mixed up.

        :param came: see :meth:`wrong`
        :param place: index of a wrong answer, by default the first
        :param part: indices that belong together; ignored if ``place`` is not among them
        """
        place = next(iter(self.wrong(came)), None) if place is None else place
        for some in (range(len(came)), part):
            seen = [one for one in some if came[one] is not None]
            for slip, slipped in self._slipped if place in seen else ():
                if all(self.like(slipped[one], came[one]) for one in seen):
                    return slip
        wrong = self.wrong(came)
        for slip, slipped in self._slipped if len(wrong) > 1 else ():
            if slip.sometimes and all(self.like(slipped[one], came[one]) for one in wrong):
                return slip
        alone = wrong == [len(came) - 1] and bool(self.burst)
        return BURST_MIXED if alone and _mixed(self.answers[-1], came[-1]) else None

    def mistakes(self) -> Iterator[str]:
        """Yield slips that the inputs cannot distinguish from correct answers or other slips."""
        named = [('the correct answers', 'the correct answers', self.answers)]
        for slip in self.slips:
            for number, rule in enumerate(slip.rules, 1):
                form = f'{slip.cause_id}, form {number}' if slip.rules[1:] else slip.cause_id
                try:
                    named.append((slip.cause_id, form, self.of(rule)))
                except Exception as error:  # an author's own code
                    yield f'the slip {form} raises {type(error).__name__}: {error}'
        for place, (cause_id, form, answers) in enumerate(named):
            for other_id, other, others in named[:place]:
                if other_id != cause_id and all(map(self.like, answers, others)):
                    yield f'no input distinguishes {form} from {other}'


def _mixed(due: Any, came: Any) -> bool:
    """Return whether an answer consists of expected values, some of them in place of others."""
    several = isinstance(due, tuple) and len(came or ()) == len(due) > 1
    return several and all(any(same(one, other) for other in due) for one in came)


BURST_MIXED = Slip(
    'burst_mixed',
    'Your node answers single messages correctly, but mixes up messages that arrive at once.',
    'Create a new message in each call of the callback, and publish it there. Store nothing for '
    'later that the next message replaces.',
)


def merge_answers(answers: Sequence[Any]) -> Any:
    """Merge several answers: the sum of numbers, or all parts of tuples in a fixed order."""
    if all(isinstance(one, tuple) for one in answers):
        return sorted_answers(part for one in answers for part in one)
    return sum(answers)


def sorted_answers(answers: Iterable[Any]) -> tuple[Any, ...]:
    """Sort answers of any types into an order that is independent of their arrival."""
    return tuple(sorted(answers, key=_order))


def _order(answer: Any) -> tuple[Any, ...]:
    if isinstance(answer, tuple):
        return tuple(map(_order, answer))
    text = isinstance(answer, str) or (isinstance(answer, float) and not math.isfinite(answer))
    number = isinstance(answer, (int, float)) and not text
    return (text, number, answer if number else str(answer))

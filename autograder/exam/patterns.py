"""
Recognise patterns of missing or extra answers, such as only the first or every second input.

A pattern explains the whole run, like a slip, but needs no rule of the exercise.  It describes the
answers, not the reason for them.
"""

from collections.abc import Sequence
from typing import Any

from autograder.exam.specification import Cause, sorted_answers, Specification
from autograder.exam.words import Causes

LONGEST = 5  # period of a pattern [inputs]
WHY = Causes(__file__)


def why_pattern(
    due: Sequence[int], came: Sequence[int | None], verb: str = 'answers', what: str = 'message'
) -> Cause | None:
    """
    Explain counts of answers by a pattern over the inputs.

    :param due: expected number of messages or log lines after each input
    :param came: the actual numbers, None for inputs that were not sent
    :param verb: what the program does once per input
    :param what: the inputs with an expected answer, in the singular
    """
    pairs = [(count, wanted) for count, wanted in zip(came, due) if wanted and count is not None]
    if len(pairs) < 2 or any(count for count, wanted in zip(came, due) if not wanted):
        return None
    right = [count == wanted for count, wanted in pairs]
    if not any(count > wanted for count, wanted in pairs):
        none = all(count in (0, wanted) for count, wanted in pairs)
        return _why_gaps(right, verb, what) if none else None
    if len(pairs) > 2 and all(count == wanted * n for n, (count, wanted) in enumerate(pairs, 1)):
        return WHY.of('one_more_each_time', verb=verb, what=what)
    first = right.index(False)
    doubled = [count == 2 * wanted for count, wanted in pairs[first:]]
    if first and len(doubled) > 1 and all(doubled):
        return WHY.of('twice_from_then_on', verb=verb, what=what, first=first + 1)
    return None


def _why_gaps(right: Sequence[bool], verb: str, what: str) -> Cause | None:
    """Explain inputs without an answer."""
    count, total = sum(right), len(right)
    words: dict[str, Any] = {'verb': verb, 'what': what}
    if 0 < count < total - 1 and all(right[:count]):
        some = what if count == 1 else f'{count} {what}s'
        return WHY.of('first_only', some=some, first_lost=count + 1, **words)
    if 1 < count < total and all(right[-count:]):
        lost = 'one' if total - count == 1 else total - count
        return WHY.of('all_but_first', lost=lost, **words)
    for period in range(2, min(LONGEST, total // 2) + 1):
        for rest in range(period):
            on = [place % period == rest for place in range(total)]
            if list(right) == on:
                return WHY.of('every_nth', period=period, **words)
            if [not one for one in right] == on:
                return WHY.of('leaves_out_every_nth', period=period, what=what)
    return None


def why_left_out(asked: Specification, came: Sequence[tuple[Any, ...] | None]) -> Cause | None:
    """
    Explain missing answers by their expected values: repetitions, or false values and zeros.

    :param came: the answers, one per input or burst; None for inputs that were not sent
    """
    due = asked.answers[: -1 if asked.burst else None]
    pairs = [
        (count == 0, one == before, not any(one))
        for one, before, count in zip(due, [None, *due], map(_count, came))
        if one and count in (0, len(one))
    ]
    if len(pairs) < len([one for one in due if one]):
        return None
    left, equal, false = zip(*pairs) if pairs else ((), (), ())
    names = {equal: 'only_new_answers', false: 'only_true_answers'}
    certain = 1 < sum(left) < len(left) - 1
    return WHY[names[left]] if certain and left in names else None


def _count(answer: tuple[Any, ...] | None) -> int | None:
    return None if answer is None else len(answer)


def why_burst_cut(asked: Specification, came: tuple[object, ...]) -> Cause | None:
    """Explain messages that arrive at once and are not all answered, from the sorted answers."""
    due = list(asked.due(asked.inputs))[-asked.burst :]
    later = due[-1][1:]  # what the node publishes without a further message, such as a stop
    for count in range(1, asked.burst):
        first, last = (
            asked.like(sorted_answers(part for one in some for part in one), came)
            for some in ((*due[:count], later), due[-count:])
        )
        few = 'message' if count == 1 else f'{count} messages'
        if last:
            return WHY.of('only_the_last', some=few)
        if first:
            return WHY.of('drops_while_busy' if count == 1 else 'the_rest_dropped', some=few)
    return None

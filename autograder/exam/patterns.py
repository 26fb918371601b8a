"""
Recognise how wrong answers are spread over the inputs: only the first, every second, from one on.

A pattern explains the whole run, like a slip, but needs no rule of the exercise.  It says what
came, and not why.
"""

from __future__ import annotations

from collections.abc import Sequence

from autograder.exam.specification import Cause, in_order, Specification

LONGEST = 5  # period of a pattern [inputs]
EACH = 'Treat each message alike, without a counter, a flag and a list that grows.'
BUSY = Cause(
    'drops_while_busy',
    'If several messages arrive at once, your node answers only the first: it drops those that '
    'arrive while it is busy.',
    'Answer in the callback of the subscription, each time, without a flag for being busy.',
)


def why_pattern(
    due: Sequence[int], came: Sequence[int | None], verb: str = 'answers', what: str = 'message'
) -> Cause | None:
    """
    Explain counts of answers by the way in which they are spread over the inputs.

    :param due: expected number of messages or log lines after each input
    :param came: their real number, None for inputs that were not sent
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
        text = f'Your node {verb} the first {what} once, the second twice, and so on.'
        return Cause('one_more_each_time', text, f'Create nothing in a callback. {EACH}')
    first = right.index(False)
    doubled = [count == 2 * wanted for count, wanted in pairs[first:]]
    if first and len(doubled) > 1 and all(doubled):
        text = f'From {what} {first + 1} on, your node {verb} each {what} twice.'
        return Cause('twice_from_then_on', text, 'Create subscriptions only in __init__().')
    return None


def _why_gaps(right: Sequence[bool], verb: str, what: str) -> Cause | None:
    """Explain inputs without an answer."""
    count, total = sum(right), len(right)
    if 0 < count < total - 1 and all(right[:count]):
        some = what if count == 1 else f'{count} {what}s'
        return Cause('first_only', f'Your node {verb} only the first {some}.', EACH)
    if 1 < count < total and all(right[-count:]):
        lost = 'one' if total - count == 1 else str(total - count)
        return Cause('all_but_first', f'Your node {verb} each {what} but the first {lost}.', EACH)
    for period in range(2, min(LONGEST, total // 2) + 1):
        for rest in range(period):
            on = [place % period == rest for place in range(total)]
            if list(right) == on:
                return Cause('every_nth', f'Your node {verb} one {what} in {period}.', EACH)
            if [not one for one in right] == on:
                text = f'Your node leaves out one {what} in {period}.'
                return Cause('leaves_out_every_nth', text, EACH)
    return None


def why_burst_cut(asked: Specification, came: tuple[object, ...]) -> Cause | None:
    """
    Explain messages that arrive at once and are not all answered.

    :param came: the answers to the burst, sorted
    """
    due = list(asked.due(asked.inputs))[-asked.burst :]
    parts = {count: in_order(part for one in due[-count:] for part in one) for count in (1, 2, 5)}
    if asked.like(in_order(due[0]), came) and not asked.like(parts[1], came):
        return BUSY
    for depth, last in parts.items():
        if depth < asked.burst and asked.like(last, came):
            kept = 'message' if depth == 1 else f'{depth} messages'
            return Cause(
                'only_the_last',
                f'If several messages arrive at once, your node answers only the last {kept}.',
                'Give create_subscription() the depth 10, and store no message for later.',
            )
    return None

"""
Recognise patterns of missing or extra answers, such as only the first or every second input.

A pattern explains the whole run, like a slip, but needs no rule of the exercise.  It describes the
answers, not the reason for them.
"""

from collections.abc import Sequence

from autograder.exam.specification import Cause, sorted_answers, Specification

QUEUE = 'Drop no messages: do not limit the size of your own list or queue.'
DEPTH = 'Give create_subscription() the depth 10; for later, store messages only in a queue.'
LONGEST = 5  # period of a pattern [inputs]
EACH = 'Treat all messages alike, without a counter, a flag or a list that grows.'
BUSY = Cause(
    'drops_while_busy',
    'If several messages arrive at once, your node answers only the first: it drops those that '
    'arrive while it is busy.',
    'Answer every message in the callback of the subscription, without a busy flag.',
)


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
        after = f'Look for what {what} {count + 1} changes in your node. {EACH}'
        return Cause('first_only', f'Your node {verb} only the first {some}.', after)
    if 1 < count < total and all(right[-count:]):
        lost = 'one' if total - count == 1 else str(total - count)
        first = 'Look for a condition on a count, a flag or an earlier value. '
        text = f'Your node {verb} all {what}s but the first {lost}.'
        return Cause('all_but_first', text, first + EACH)
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
    for count in range(1, asked.burst):
        first, last = (
            asked.like(sorted_answers(part for one in some for part in one), came)
            for some in (due[:count], due[-count:])
        )
        if first and not last:
            return BUSY if count == 1 else _dropping('the_rest_dropped', 'first', count, QUEUE)
        if last:
            return _dropping('only_the_last', 'last', count, DEPTH)
    return None


def _dropping(cause_id: str, which: str, count: int, try_this: str) -> Cause:
    """Return the cause for a burst of which only some messages are answered."""
    some = 'message' if count == 1 else f'{count} messages'
    text = f'If several messages arrive at once, your node answers only the {which} {some}.'
    return Cause(cause_id, text, try_this)

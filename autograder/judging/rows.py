"""
Compare the messages that follow each input of a run with the expected answers.

The events after one input, or after a burst, form a row.  The expected answers and the slips are
in a :class:`autograder.exam.specification.Specification`.  :mod:`.log_rows` compares log lines.
"""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
import math
from typing import Any

from autograder.exam import slips
from autograder.exam.exam import Cause, Failed, Run
from autograder.exam.patterns import why_burst_cut, why_left_out, why_pattern
from autograder.exam.specification import sorted_answers, Specification
from autograder.judging.causes.ended import while_running, why_no_endpoint, why_silent
from autograder.judging.causes.text_table import cause_of
from autograder.judging.checks import counted, field_of, require_endpoint
from autograder.judging.rhythm import seconds_between
from autograder.recording import Event, SECOND

Row = list[Event]
LATE_S = 0.015  # a message that a callback publishes at once arrives earlier [s]
ANSWER = 'if:publish() | def:publish()'
AT_START_S = 0.25  # a message that __init__ publishes arrives earlier [s]


def rows(run: Run, ask: str, events: Iterable[Event]) -> list[Row | None]:
    """
    Return the events after each input of a specification; a burst has one row.

    Events after later inputs of the run are left out.

    :param events: events of the run, each with the index of the last input before it
    :returns: None for a row whose input, or burst, was not completely sent
    """
    count, burst = len(run.asked(ask).inputs), run.asked(ask).burst
    sent, last = len(run.recording.of('input')), count - burst
    found: list[Row | None] = [[] if place < sent else None for place in range(last)]
    found += [[] if sent >= count else None] * bool(burst)
    for event in events:
        after = event['after_input']
        row = found[min(after, last)] if after is not None and after < count else None
        if row is not None:
            row.append(event)
    return found


def published(run: Run, ask: str, topic: str, *fields: str) -> list[tuple[Any, ...] | None]:
    """
    Return the values on a topic after each input; values after a burst are sorted.

    :param fields: see :func:`publishes`; by default the first field of the message
    :returns: None for an input that was not sent; a value is None if its message was too large to
        be recorded
    """

    def value(message: Event) -> Any:
        if fields:
            found = tuple(field_of(message, one) for one in fields)
            return found if len(fields) > 1 else found[0]
        return next(iter(message.get('data', {}).values()), None)

    found = [
        None if row is None else tuple(map(value, row))
        for row in rows(run, ask, run.recording.messages(topic))
    ]
    if run.asked(ask).burst and found[-1]:  # several threads may answer in any order
        found[-1] = sorted_answers(found[-1])
    return found


def without_last(run: Run, came: Sequence[Any], place: int) -> Sequence[Any]:
    """Return the answers to explain, without the last one before the end of the program."""
    last = max((one for one, answer in enumerate(came) if answer is not None), default=place)
    if run.recording.process.get('exit') is None or last == place:
        return came
    return [None if one == last else answer for one, answer in enumerate(came)]


def publishers_at(run: Run, when: str, topic: str) -> list[Event]:
    """Return the publishers on a topic in a graph: ``start``, ``end`` or that of a ``Look``."""
    ends = (end for graph in run.recording.of('graph', when=when) for end in graph['endpoints'])
    return [end for end in ends if (end['kind'], end['topic']) == ('publisher', topic)]


def seconds_after_join(run: Run, topic: str, listener: str) -> float:
    """Return the time from the join of a listener to its first message [s]."""
    joined = run.recording.of('joined', listener=listener)[0]
    first = run.recording.messages(topic, listener)[0]
    return float(first['clock_ns'] - joined['clock_ns']) / SECOND


def delays(run: Run, ask: str, topic: str) -> list[list[float]]:
    """
    Return how long after each input, or after a burst, each message on a topic arrived [s].

    :returns: empty if an input was not sent, or for a slow callback, which delays messages
    """
    sent, count = run.recording.of('input'), len(run.asked(ask).inputs)
    if run.facts.get('slow_callback') or len(sent) < count:
        return []
    last = count - run.asked(ask).burst
    begun = [one['clock_ns'] for one in (*sent[:last], *sent[count - 1 : count] * (last < count))]
    found = rows(run, ask, run.recording.messages(topic))
    return [
        [(one['clock_ns'] - start) / SECOND for one in row or ()]
        for start, row in zip(begun, found, strict=True)
    ]


def require_one_for_one(
    run: Run,
    ask: str,
    topic: str,
    came: Sequence[tuple[Any, ...] | None],
    places: Collection[int] | None = None,
) -> None:
    """
    Fail unless each input causes the expected number of messages, and none precedes the inputs.

    :param came: see :func:`published`
    :param places: indices of the inputs to check, by default all
    """
    asked = run.asked(ask)
    early = run.recording.of('message', topic=topic, after_input=None)
    if early or _unheard(run, asked, topic):
        later = seconds_between(run.recording.of('seen'), early) > AT_START_S
        raise Failed(
            expected='nothing before the first input',
            observed='a message before the first input',
            why=slips.WHY.of('speaks_unasked', closer=[slips.WHY['runs_early']] * later),
            blocks=len(early) > 1,  # a single message leaves the other answers as they are
        )
    if not any(came):
        require_endpoint(run, 'publisher', topic, run.names.published[topic])
    for place in range(len(came)) if places is None else places:
        due, count = len(asked.answers[place]), len(came[place] or ())
        if count != due:
            raise Failed(
                expected=f'{counted(due, "message")} on {topic} after message {place + 1}',
                observed=counted(count, 'message'),
                why=why_silent(while_running(run, asked, place, count < due))
                or why_other_answer(
                    asked, without_last(run, came, place), place, delays(run, ask, topic), places
                ),
                act=ANSWER,
                place=place,
            )


def _unheard(run: Run, asked: Specification, topic: str) -> bool:
    """Return whether the node published something before the probe was connected."""
    for first in run.recording.messages(topic)[:1]:
        place = first['after_input'] or 0
        due = sum(len(answer) for answer in asked.answers[: place + 1])
        return bool(first.get('number', 1) > max(due, 1))
    return False


def why_other_answer(
    asked: Specification,
    came: Sequence[tuple[Any, ...] | None],
    place: int,
    late_s: Sequence[Sequence[float]] = (),
    part: Collection[int] | None = None,
) -> Cause | None:
    """
    Explain a wrong answer by a slip, a pattern, or a wrong number of messages.

    :param late_s: see :func:`delays`; empty if unknown
    :param part: see ``Specification.cause``
    """
    if slip := asked.cause(came, place, part or ()):
        return slip
    counts = [one if one is None else len(one) for one in came]
    pattern = why_pattern(list(map(len, asked.answers)), counts) or why_left_out(asked, came)
    if pattern:
        return pattern
    more = len(came[place] or ()) - len(asked.answers[place])
    if more > 0:
        again_s = [late - first for first, late in pairwise(late_s[place])] if late_s else [0.0]
        later = max(again_s, default=0.0) > LATE_S
        return cause_of('publishes_later') if later else slips.WHY['several_answers']
    if more == 0:
        return None
    if not any(came):
        return slips.WHY['no_answer']
    if len(asked.row(place)) > 1:
        cut = why_burst_cut(asked, came[place] or ()) or slips.WHY['misses_some']
        if not late_s or any(min(row, default=math.inf) <= LATE_S for row in late_s):
            return cut
        text = f'{cut.text} It publishes some time after the messages arrive, as a timer does.'
        repair = (
            'Publish in the callback of the subscription, once per message, and not in a timer.'
        )
        return replace(cut, text=text, try_this=repair, act='kept_message | create_timer()')
    return slips.WHY['leaves_out']


def require_values(
    run: Run,
    asked: Specification,
    came: Sequence[tuple[Any, ...] | None],
    places: Collection[int] | None = None,
    what: str = 'the expected values',
    fields: Sequence[str] = (),
) -> None:
    """
    Fail unless each input is answered with the expected values, as in :func:`require_one_for_one`.

    :param what: description of the expected values that may be shown for hidden inputs
    :param fields: names of the values, if there are several for each message
    """
    for place in asked.wrong(came, places)[:1]:
        after = f'after message {place + 1}' + (f': {", ".join(fields)}' if fields[1:] else '')
        short = len(came[place] or ()) < len(asked.answers[place])
        raise Failed(
            expected=f'{shown_values(run, asked.answers[place], what)} {after}',
            observed=f'{shown_values(run, came[place])} {after}',
            why=why_silent(while_running(run, asked, place, short))
            or asked.cause(without_last(run, came, place), place, places or ())
            or (
                why_burst_cut(asked, came[place] or ()) if short and asked.row(place)[1:] else None
            ),
            place=place,
        )


def shown_values(run: Run, values: Sequence[Any] | None, secret: str = 'something else') -> str:
    """Return values as text, or ``secret`` for values that may be inputs of a hidden exam."""
    if values and run.secret:
        return secret
    texts = (f'{one:.12g}' if isinstance(one, float) else repr(one)[:40] for one in values or ())
    return ', '.join(texts) or 'nothing'


def require_all_sent(run: Run, found: Sequence[object]) -> None:
    """Fail if a run ended before all inputs were sent."""
    _require_alive(run, not found or found[-1] is not None, 'input')


def require_complete(run: Run) -> None:
    """Fail if a run ended before all steps were executed."""
    for event in run.recording.of('not_connected'):
        if run.recording.end_reason == 'not_connected':
            topic = event['topic']
            raise Failed(
                expected=f'a subscription on {topic}',
                observed='no subscription',
                why=why_no_endpoint(run, 'subscription', topic, run.names.heard.get(topic, '')),
            )
    _require_alive(run, run.recording.end_reason == 'complete', 'moment of the exam')


def _require_alive(run: Run, alive: bool, until: str) -> None:
    if not alive:
        raise Failed(
            expected=f'a node that runs until the last {until}',
            observed='a node that ended earlier',
            why=why_silent(run),
        )

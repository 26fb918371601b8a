"""
Compare the messages and log lines that follow each input of a run with the expected answers.

The events after one input, or after a burst, form a row.  The expected answers and the slips are
in a :class:`autograder.exam.specification.Specification`.
"""

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
import math
from typing import Any

from autograder.exam.exam import Cause, Failed, Run
from autograder.exam.patterns import why_burst_cut, why_pattern
from autograder.exam.slips import (
    FALSE_ALARM,
    LEAVES_OUT,
    MISSED_WARNING,
    MISSES_SOME,
    NO_ANSWER,
    REPEATED,
    RUNS_EARLY,
    SEVERAL_ANSWERS,
    UNASKED,
)
from autograder.exam.specification import sorted_answers, Specification
from autograder.judging.causes.ended import while_running, why_silent
from autograder.judging.causes.missing_logs import lines_of_code, why_left_out, why_not_logged
from autograder.judging.causes.text_table import acts_by_cause, cause_of
from autograder.judging.checks import (
    counted,
    field_of,
    lines,
    own_logs,
    require_endpoint,
    SECOND,
)
from autograder.judging.numbers import numbers_in
from autograder.judging.rhythm import seconds_between
from autograder.recording import Event, INFO, WARN

Row = list[Event]
LATE_S = 0.015  # a message that a callback publishes at once arrives earlier [s]
ANSWER = 'if:publish() | def:publish()'
AT_START_S = 0.25  # a message that __init__ publishes arrives earlier [s]


def rows(run: Run, ask: str, events: Iterable[Event]) -> list[Row | None]:
    """
    Return the events after each input of a specification; a burst has one row.

    :param ask: name of the specification
    :param events: events of the run, each with the index of the last input before it
    :returns: None for a row whose input, or burst, was not completely sent
    """
    count, burst = len(run.asked(ask).inputs), run.asked(ask).burst
    sent, last = len(run.recording.of('input')), count - burst
    found: list[Row | None] = [[] if place < sent else None for place in range(last)]
    found += [[] if sent == count else None] * bool(burst)
    for event in events:
        after = event['after_input']
        row = None if after is None else found[min(after, last)]
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


def _without_last(run: Run, came: Sequence[Any], place: int) -> Sequence[Any]:
    """Return the answers to explain, without the last one before the end of the program."""
    last = max((one for one, answer in enumerate(came) if answer is not None), default=place)
    if run.recording.process.get('exit') is None or last == place:
        return came
    return [None if one == last else answer for one, answer in enumerate(came)]


def endpoints_at(run: Run, when: str, kind: str, topic: str) -> list[Event]:
    """
    Return the endpoints on a topic in one graph of the recording.

    :param when: label of a :class:`autograder.exam.steps.Look`, ``start`` or ``end``
    :param kind: ``'publisher'`` or ``'subscription'``
    """
    ends = (end for graph in run.recording.of('graph', when=when) for end in graph['endpoints'])
    return [end for end in ends if (end['kind'], end['topic']) == (kind, topic)]


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
    begun = [one['clock_ns'] for one in (*sent[:last], *sent[-1:] * (last < count))]
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
            why=replace(UNASKED, closer=[RUNS_EARLY]) if later else UNASKED,
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
                    asked, _without_last(run, came, place), place, delays(run, ask, topic)
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
) -> Cause | None:
    """
    Explain a wrong answer by a slip, a pattern, or a wrong number of messages.

    :param late_s: see :func:`delays`; empty if unknown
    """
    if slip := asked.cause(came, place):
        return slip
    counts = [one if one is None else len(one) for one in came]
    if pattern := why_pattern(list(map(len, asked.answers)), counts):
        return pattern
    more = len(came[place] or ()) - len(asked.answers[place])
    if more > 0:
        again_s = [late - first for first, late in pairwise(late_s[place])] if late_s else [0.0]
        later = max(again_s, default=0.0) > LATE_S
        return cause_of('publishes_later') if later else SEVERAL_ANSWERS
    if more == 0:
        return None
    if not any(came):
        return NO_ANSWER
    if len(asked.row(place)) > 1:
        cut = why_burst_cut(asked, came[place] or ()) or MISSES_SOME
        if not late_s or any(min(row, default=math.inf) <= LATE_S for row in late_s):
            return cut
        text = f'{cut.text} It publishes some time after the messages arrive, as a timer does.'
        repair = (
            'Publish in the callback of the subscription, once per message, and not in a timer.'
        )
        return replace(cut, text=text, try_this=repair, act='kept_message | create_timer()')
    return LEAVES_OUT


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
            or asked.cause(_without_last(run, came, place), place, places or ()),
            place=place,
        )


def shown_values(run: Run, values: Sequence[Any] | None, secret: str = 'something else') -> str:
    """
    Return values as text for feedback, unless they may be inputs of a hidden exam.

    :param secret: the text that replaces such values
    """
    if values and run.secret:
        return secret
    texts = (f'{one:.12g}' if isinstance(one, float) else repr(one)[:40] for one in values or ())
    return ', '.join(texts) or 'nothing'


def require_all_sent(run: Run, found: Sequence[object]) -> None:
    """Fail if a run ended before all inputs were sent."""
    if found and found[-1] is None:
        raise Failed(
            expected='a node that runs until the last input',
            observed='a node that ended earlier',
            why=why_silent(run),
        )


# -- log lines -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Followed:
    """
    One input or a burst, and the log lines that followed.

    :param inputs: one input, or all inputs of a burst; each has a method ``is_in``, which returns
        whether a text shows the input
    :param row: None if the run ended before all inputs were sent
    """

    inputs: Sequence[Any]
    row: Row | None

    @property
    def logs(self) -> Row:
        """Return the lines that followed, empty if the inputs were not sent."""
        return self.row or []

    def texts(self, level: int) -> list[str]:
        """Return the lines at a level."""
        return [entry['text'] for entry in self.logs if entry['level'] == level]

    def count(self, level: int) -> int:
        """Return the number of lines at a level."""
        return len(self.texts(level))

    def numbers(self, level: int) -> list[float]:
        """Return the numbers in the lines at a level."""
        return [number for text in self.texts(level) for number in numbers_in(text)]

    def showing(self, one: Any, level: int = INFO) -> int:
        """Return the number of lines at a level that show an input."""
        return sum(map(one.is_in, self.texts(level)))


def followed(run: Run, ask: str, logger: str) -> list[Followed]:
    """
    Return every input or burst of a specification, sent or not, with the log lines after it.

    :param logger: full name of the node whose log lines are judged
    """
    found = rows(run, ask, own_logs(run, logger))
    return [Followed(run.asked(ask).row(place), row) for place, row in enumerate(found)]


def require_warnings(
    run: Run,
    asked: Specification,
    followed: Sequence[Row | None],
    places: Collection[int],
    part: Collection[int] = (),
    why_missing: Callable[[int], Cause | None] | None = None,
    shared: bool = False,
) -> None:
    """
    Fail unless inputs are followed by the expected number of WARN lines.

    :param asked: specification with the expected counts; each input has a ``kind``, its
        description in feedback
    :param followed: log lines after each input, see :func:`rows`
    :param places: indices of the inputs to check
    :param part: indices for which one slip may explain all answers, see ``Specification.cause``
    :param why_missing: explains a missing warning, given its index; by default, searches for the
        line in other places
    :param shared: whether to give partial points, see :func:`share`
    """
    came = warnings_after(followed)
    wrong = [place for place in places if (came[place] or 0) != asked.answers[place]]
    if not wrong:
        return
    place = wrong[0]
    due, count = asked.answers[place], came[place] or 0
    short = count < due
    repeats = any((one or 0) > len(asked.row(row)) for row, one in enumerate(came))
    other = MISSED_WARNING if short else REPEATED if repeats else FALSE_ALARM
    row, inputs = followed[place] or [], asked.row(place)
    then, known = while_running(run, asked, place, short), _without_last(run, came, place)
    slip = asked.cause(known, place, part)
    what = f'a burst of {len(inputs)} readings' if len(inputs) > 1 else inputs[0].kind
    raise Failed(
        expected=f'{lines(due, WARN)} after {what}',
        observed='the run ended before this input' if came[place] is None else lines(count, WARN),
        why=why_silent(then)
        or (why_missing(place) if why_missing and short else None)
        or (why_left_out(run, WARN, _warnings(followed)) if short else None)
        or (slip if any(came) else None)
        or (why_not_logged(then, row, WARN) if short and not count and not why_missing else None)
        or slip
        or why_pattern(asked.answers, known, 'warns about', 'high value')
        or _why_from_elsewhere(came, asked.answers, followed, place)
        or other,
        blocks=not any(came),  # if the node warns at all, judge the other checks too
        share=share(run, followed, len(places) - len(wrong), len(places)) if shared else 0.0,
        act=acts_by_cause()['false_alarm'],
        # If an input was not sent, the indices of the recording differ.
        place=None if None in came[:place] else place,
    )


def _why_from_elsewhere(
    came: Sequence[int | None], due: Sequence[int], followed: Sequence[Row | None], place: int
) -> Cause | None:
    """Explain a needless WARN line whose line of code never logs a correct warning."""
    exact = [row for row, count, wanted in zip(followed, came, due) if count == wanted]
    right = lines_of_code(_warnings(exact))
    others = sorted(lines_of_code(_warnings([followed[place]])) - right)
    return cause_of('other_warning', line=others[0]) if right and others else None


def _warnings(followed: Iterable[Row | None]) -> Row:
    return [line for row in followed for line in row or () if line['level'] == WARN]


def share(run: Run, followed: Sequence[Row | None], right: int, due: int) -> float:
    """
    Return the fraction of the points for the correct results of a program that ended early.

    The fraction is 0 if the run was complete, or if the CPU limit ended it: how far a program gets
    before this limit depends on the machine.
    """
    if None not in followed or run.recording.end_reason == 'cpu_limit' or not due:
        return 0.0
    return round(right / due, 2)


def warnings_after(followed: Iterable[Row | None]) -> list[int | None]:
    """Return the number of WARN lines after each input, None if the input was not sent."""
    return [row if row is None else len(_warnings([row])) for row in followed]

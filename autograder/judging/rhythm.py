"""Check that messages or log lines keep a rhythm, and explain a different one."""

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate, combinations, groupby, pairwise
import math
import operator
from statistics import median_low
from typing import Any, NamedTuple

from autograder.exam.exam import Cause, Failed, Run
from autograder.exam.steps import SETTLE_S
from autograder.judging.causes.ended import why_it_ended, why_it_sleeps, why_silent
from autograder.judging.causes.text_table import cause_of
from autograder.recording import Event, SECOND
from autograder.submission.code.acts import place_of
from autograder.submission.code.source_code import Code

GRAIN_S = 0.015
"""Tolerance of a rhythm [s]; a program that polls a clock deviates by up to 0.01 s."""
CONNECTS = 'a subscription connects'
FEW = 7  # number of messages that show how far apart messages are
FLOOD = 10
"""A flood is more than this multiple of the expected count; its recording may be incomplete."""


def require_period(
    run: Run,
    found: Sequence[Event],
    period_s: float,
    during_s: float,
    what: str = 'message',
    explain: Callable[[], Cause | None] = lambda: None,
    when: str = '',
    waited_s: float = 0.0,
) -> None:
    """
    Fail unless messages or log lines arrive once per period, on any clock, until a phase ends.

    A count that is one too high or too low is accepted.

    :param found: messages or lines of one phase, in order
    :param during_s: duration of the phase [s]
    :param what: the expected thing in the singular, such as ``message``
    :param explain: returns the exam's own cause, which has priority over causes found in the gaps
    :param when: description of the phase, appended to the expectation
    :param waited_s: time until the first message or line, at most one period [s]
    """
    seconds = _seconds(found)
    gaps = _gaps(seconds)
    more = len(seconds) - during_s / period_s
    odd = [gap for gap in gaps if not _is(period_s, gap)]
    late = waited_s > period_s + GRAIN_S
    if abs(more) <= 1.5 and not odd and not late:
        return
    sleeps = why_it_sleeps(run) if more <= 1.5 else None
    begins_late = not sleeps and (late or more < -1.5)
    if sleeps and 'reset' in Code(run.files).calls:
        sleeps = replace(sleeps, try_this='Remove reset(): it restarts the timer after the sleep.')
    rhythm = (
        why_disturbed(run, found, period_s, begins_late, what)
        or sleeps
        or why_paced(run)
        or why_other_rhythm(run, found, period_s, during_s, what)
    )
    ended = why_it_ended(run)
    observed = _rhythm(what, len(seconds), gaps, during_s / period_s)
    if ended and seconds:
        # Another thread may publish once more while an exception ends the program.
        observed = f'{what}s only until the program ended'
    only_count = bool(seconds) and not (odd or late or ended)
    in_all = f' ({during_s / period_s:.0f} {what}s)' if only_count else ''
    raise Failed(
        expected=f'one {what} every {period_s:g} s for {during_s:g} s{in_all}{when}',
        observed=observed + (f', the first after {waited_s:.2g} s' if late else ''),
        why=ended or explain() or rhythm or why_silent(run),
        at=_first_difference_ns(seconds, period_s, waited_s if late else 0.0),
        every_s=period_s,
        shown_by=found,
    )


def _first_difference_ns(seconds: Sequence[float], period_s: float, waited_s: float) -> int | None:
    """
    Return when the first message was missing or arrived too early [ns]; None if none arrived.

    :param waited_s: time until the first message if this was too long, otherwise 0 [s]
    """
    if not seconds:
        return None
    if waited_s:
        return round((seconds[0] - waited_s + period_s) * SECOND)
    odd = (
        one + min(gap, period_s)
        for one, gap in zip(seconds, _gaps(seconds))
        if not _is(period_s, gap)
    )
    return round(next(odd, seconds[-1] + period_s) * SECOND)


def seconds_between(begun: Sequence[Event], found: Sequence[Event]) -> float:
    """Return the time from the first event of one list to the next one in another [s], or 0.0."""
    starts = [one['clock_ns'] for one in begun[:1]]
    later = (one['clock_ns'] - start for start in starts for one in found)
    return next((ns / SECOND for ns in later if ns >= 0), 0.0)


class Unheard(NamedTuple):
    """A time, from ``left_ns``, without a subscription, and the messages before and after."""

    before: Event | None
    after: Event
    left_ns: int

    @property
    def missed(self) -> int:
        """Return how many messages nobody received."""
        return int(self.after['number']) - 1 - (self.before['number'] if self.before else 0)


def with_unheard(run: Run, found: Sequence[Event]) -> list[Event]:
    """
    Return messages, including those that the probe missed without a subscription.

    The number of the first message after such a time shows how many were missed.  They are
    assumed to be evenly spaced from the message before it or, if there is none, as far apart as
    the next few messages are on average.

    :param found: messages on one topic, in order
    """
    seen_ns = max((one['clock_ns'] for one in run.recording.of('seen')), default=0)
    whole = list(found)
    for one in reversed(_unheard(run, found)):
        place = whole.index(one.after)
        few = whole[place : place + FEW]
        begin, times = one.before, [event['clock_ns'] for event in few]
        if begin:
            gap_ns = (times[0] - begin['clock_ns']) / (one.missed + 1)
        else:
            gap_ns = (times[-1] - times[0]) / max(len(times) - 1, 1)
        missed = (times[0] - round(n * gap_ns) for n in range(one.missed if gap_ns else 0, 0, -1))
        whole[place:place] = [{**one.after, 'clock_ns': ns} for ns in missed if ns > seen_ns]
    return whole


def _unheard(run: Run, found: Sequence[Event]) -> list[Unheard]:
    """
    Return the times without a subscription that a message of the same publisher follows.

    Each publisher numbers its messages from 1, so a number that does not grow shows nothing.
    """
    topic = found[0].get('topic') if found else None
    heard, times = run.recording.messages(topic) if topic else [], []
    for left in run.recording.of('left', name=topic):
        count = sum(one['clock_ns'] < left['clock_ns'] for one in heard)
        before = heard[count - 1] if count else None
        times += [
            Unheard(before, after, left['clock_ns'])
            for after in heard[count : count + 1]
            if after in found and not (before and after['number'] <= before['number'])
        ]
    return times


def _why_unheard(run: Run, found: Sequence[Event], period_s: float) -> Cause | None:
    """Explain a program that published nothing while its topic had no subscription."""
    asks = place_of(Code(run.files), 'get_subscription_count()')
    for one in (one for one in _unheard(run, found) if not one.missed):
        later = _gaps(_seconds(found[found.index(one.after) :]))
        first, lasts_s = one.after is found[0], (one.after['clock_ns'] - one.left_ns) / SECOND
        # A node that skips its first calls publishes nothing at first, heard or unheard.
        if (asks if first else lasts_s > 2 * period_s) and later and _is(period_s, *later):
            return cause_of('unheard')
    return None


def _greets(run: Run, found: Sequence[Event], period_s: float) -> bool:
    """
    Return whether a message between two periods arrives when the probe subscribes again.

    With this message, the moments of the messages before it are unknown, see :func:`with_unheard`.
    """
    times = _unheard(run, found)
    if not times:
        return False
    until = [one.before for one in times[1:2] if one.before in found]
    end = found.index(until[0]) + 1 if until else len(found)
    first, *others = _seconds(found[found.index(times[0].after) : end]) or [0.0]
    moments = other_moments(run, found).get(CONNECTS, ())
    timed = [one for one in others if not _near(one, moments)]
    off = len(timed) > 2 and not _is(0.0, math.remainder(timed[0] - first, period_s))
    at_once = any(0.0 <= first - one <= SETTLE_S for one in moments)
    return off and at_once and _is(period_s, *_gaps(timed))


def why_disturbed(
    run: Run, found: Sequence[Event], period_s: float, few: bool, what: str
) -> Cause | None:
    """
    Explain a rhythm that begins late, or that other events of the run disturb.

    :param few: whether there are too few messages or lines, or the first one is late
    """
    if len(found) < 2:
        return None
    seconds = _seconds(found)
    gaps = _gaps(seconds)
    if unheard := _why_unheard(run, found, period_s):
        return unheard
    if _greets(run, found, period_s):
        return cause_of('additional', what=what, event=CONNECTS)
    if few and _is(period_s, *gaps) and _end_s(run, found) - seconds[-1] <= 1.5 * period_s:
        return cause_of('begins_late', what=what)
    late = [one for one, gap in zip(seconds[1:], gaps) if gap > period_s + GRAIN_S]
    others = other_moments(run, found)
    for kinds in [*combinations(others, 1), *combinations(others, 2)]:
        event, moments = ' or '.join(kinds), [one for kind in kinds for one in others[kind]]
        first = next((one for one in seconds if not _near(one, moments)), seconds[0])
        off = [one for one in seconds if not _is(0.0, math.remainder(one - first, period_s))]
        timed = sorted({*seconds} - {*off})
        if off and _is(period_s, *_gaps(timed)) and all(_near(one, moments) for one in off):
            return cause_of('additional', what=what, event=event)
        if late and all(_near(one - period_s, moments) for one in late):
            return cause_of('timer_reset', what=what, event=event)
    return None


def why_paced(run: Run) -> Cause | None:
    """Explain a loop whose pause is a call to ``spin_once()``, or that spins nodes in turn."""
    code = Code(run.files)
    spun = {ast.unparse(call.args[0]) for call in code.calls.get('spin_once', ()) if call.args}
    if len(run.recording.nodes) > 1 and (len(spun) > 1 or place_of(code, 'for:spin_once()')):
        return cause_of('spun_in_turn')
    paced = 'spin_once' in code.calls and 'create_timer' not in code.names
    return cause_of('paced_by_spin_once') if paced else None


def _is(seconds: float, *gaps: float) -> bool:
    return all(abs(gap - seconds) <= GRAIN_S for gap in gaps)


def _near(moment: float, moments: Sequence[float]) -> bool:
    return any(abs(moment - one) <= GRAIN_S for one in moments)


def _seconds(found: Sequence[Event]) -> list[float]:
    return [one['clock_ns'] / SECOND for one in found]


def _gaps(seconds: Sequence[float]) -> list[float]:
    return [later - earlier for earlier, later in pairwise(seconds)]


def _end_s(run: Run, found: Sequence[Event]) -> float:
    """Return when the phase of some events ends [s], infinity if this was not recorded."""
    ends = [one.get('clock_ns') or 0 for kind in ('mark', 'end') for one in run.recording.of(kind)]
    return min((end / SECOND for end in ends if end > found[-1]['clock_ns']), default=math.inf)


def other_moments(run: Run, found: Sequence[Event]) -> Mapping[str, Sequence[float]]:
    """Return the times of other events in a run [s], by description."""
    moments: dict[str, list[float]] = {}
    for one in run.recording.events:
        if one['event'] == 'input':
            name = 'a message arrives'
        elif one['event'] == 'watched' or (one['event'] == 'joined' and one['matched']):
            name = CONNECTS
        elif one['event'] == 'message' and one['topic'] != found[0].get('topic'):
            name = f'your node publishes on {one["topic"].rpartition("/")[2]}'
        else:
            continue
        moments.setdefault(name, []).append(one['clock_ns'] / SECOND)
    return moments


def just_before(run: Run, found: Sequence[Event], place: int) -> str:
    """Return what else happened between a message and the previous one; empty if nothing did."""
    begun, end = (found[one]['clock_ns'] / SECOND for one in (place - 1, place))
    happened = other_moments(run, found).items()
    return next((what for what, when in happened if any(begun < one < end for one in when)), '')


def _rhythm(what: str, count: int, gaps: Sequence[float], due: float) -> str:
    """Return a description of the number of messages and the gaps between them."""
    if is_far_too_many(count, due):
        return f'far more {what}s'
    if not gaps:
        return f'one {what}' if count else f'no {what}'
    least, most = f'{min(gaps):.2g}', f'{max(gaps):.2g}'
    return f'{count} {what}s, {least if least == most else f"{least} to {most}"} s apart'


def why_other_rhythm(
    run: Run,
    found: Sequence[Event],
    period_s: float,
    during_s: float,
    what: str = 'message',
    rate: float = 1.0,
    grain_s: float = GRAIN_S,
) -> Cause | None:
    """
    Explain messages or log lines with a different rhythm, if the gaps between them show why.

    For the other parameters see :func:`require_period`.

    :param rate: seconds of the measuring clock per virtual second
    :param grain_s: tolerance of a gap around the mean of an even rhythm [s]
    """
    gaps = [(two['clock_ns'] - one['clock_ns']) / SECOND * rate for one, two in pairwise(found)]
    due = during_s / period_s
    sizes = [len(list(some)) for _, some in groupby(found, key=operator.itemgetter('clock_ns'))]
    between = [gap for gap in gaps if gap]
    several = len(found) > due + 1.5 or median_low(sizes or [1]) > 1 or _is(period_s, *between)
    if 0.0 in gaps and several:
        steps = _gaps([place for place, size in enumerate(sizes) if size > 1])
        same = len(steps) > 1 and len(set(steps)) == 1 and steps[0] > 1 and _is(period_s, *between)
        often = f', once in {steps[0]:g} periods' if same else ''
        return cause_of('several_at_once', what=what, often=often, period_s=period_s)
    if len(gaps) < 2 and (tick_s := _slow_tick_s(run, gaps, len(found), period_s, during_s)):
        return _why_wrong_rate(run, tick_s, period_s, what)
    mean_s = sum(gaps) / len(gaps) if gaps else 0.0
    steady = len(gaps) > 1 and all(abs(gap - mean_s) <= grain_s for gap in gaps)
    if steady and abs(mean_s - period_s) > GRAIN_S:
        return _why_wrong_rate(run, mean_s, period_s, what)
    if steady and len(found) < due - 1.5:
        return cause_of('stops', what=what)
    if change := _why_changed(gaps, period_s, grain_s, what):
        return change
    if timers := _why_several_timers(gaps, period_s, what):
        return timers
    periods = [gap / period_s for gap in gaps]
    whole = (
        abs(one - round(one)) * period_s <= max(grain_s, GRAIN_S * one * period_s)
        for one in periods
    )
    if periods and not steady and min(periods) > 0.5 and all(whole):
        return cause_of('some_missing', what=what, period_s=period_s)
    again = place_of(Code(run.files), 'create_timer()@to:create_subscription()')
    return cause_of('timer_again', what=what) if again and len(found) > due + 1.5 else None


def _slow_tick_s(
    run: Run, gaps: Sequence[float], count: int, period_s: float, during_s: float
) -> float:
    """
    Return the period in the code that explains a few messages, which show none themselves [s].

    It is 0 if a timer has the right period or the program is silent.
    """
    ticks = Code(run.files).numbers('create_timer')
    if any(_is(period_s, one) for one in ticks) or (not count and why_silent(run)):
        return 0.0
    slow = (one for one in ticks if one > period_s and (not gaps or _is(gaps[0], one)))
    return float(next((one for one in slow if 0 <= count - during_s // one <= 1), 0.0))


def _why_changed(
    gaps: Sequence[float], period_s: float, grain_s: float, what: str
) -> Cause | None:
    """Explain a rhythm that is right at first, and later has a different constant period."""
    right = next((n for n, gap in enumerate(gaps) if not _is(period_s, gap)), len(gaps))
    later = gaps[right + 1 :]
    if right < 2 or len(later) < 2 or max(later) - min(later) > grain_s:
        return None
    if _is(period_s, later[0]):
        return None
    words: dict[str, Any] = {'what': what, 'mean_s': later[0], 'period_s': period_s}
    return cause_of('changes_rhythm', count=right + 1, **words)


def _why_several_timers(gaps: Sequence[float], period_s: float, what: str) -> Cause | None:
    """Explain a rhythm that ends with two equal periods of several messages each."""
    times = list(accumulate(gaps))
    count = sum(times[-1] - one < period_s - GRAIN_S for one in times)
    repeated = map(operator.sub, times[-count:], times[-2 * count : -count])
    if len(times) >= 2 * count > 2 and _is(period_s, *repeated):
        return cause_of('several_timers', what=what, count=count, period_s=period_s)
    return None


def _why_wrong_rate(run: Run, mean_s: float, period_s: float, what: str) -> Cause:
    """Explain an even rhythm with a wrong period, given the measured one."""
    words: dict[str, Any] = {'what': what, 'mean_s': mean_s, 'period_s': float(period_s)}
    ticks = Code(run.files).numbers('create_timer')
    parts = [one for one in ticks if 0 < one < mean_s and _is(0.0, math.remainder(mean_s, one))]
    closer: list[Cause] = []
    if parts and not any(_is(mean_s, one) for one in ticks):
        often = round(mean_s / parts[0])
        act = 'compared_count | %'
        closer = [cause_of('not_each_tick', **words, tick_s=parts[0], often=often, act=act)]
    right = any(_is(period_s, one) for one in ticks)
    situation = 'rate_of_calls' if right else 'wrong_rate'
    return cause_of(situation, **words, about=[f'{mean_s:.4g}'], closer=closer)


def is_far_too_many(count: float, due: float) -> bool:
    """Return whether a count is far too high, so that feedback should not show it."""
    return count > FLOOD * max(due, 1.0)

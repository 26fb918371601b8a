"""
Check stamps from the ROS clock, and explain wrong ones.

In these exams, the ROS clock starts far from system time and advances in steps.  So arithmetic is
enough to detect a wrong clock, a lost fraction or an invented stamp.
"""

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

from autograder.exam.exam import Cause, Failed, Run
from autograder.exam.scenario import RosClock
from autograder.judging.causes.ended import why_it_sleeps, why_silent
from autograder.judging.causes.text_table import cause_of
from autograder.judging.checks import field_of
from autograder.recording import Event, SECOND
from autograder.submission.code.source_code import Code

SYSTEM_TIME_S = 1e9
"""Stamps above this value are from the system clock, which passed it in 2001 [s]."""
FAR_S = 1000
"""A stamp further than this from the ROS clock is from a different clock [s]."""
MILLISECOND = 1_000_000


def require_stamps(
    run: Run, found: Iterable[tuple[Event, int]], clock: RosClock, field: str = 'timestamp'
) -> None:
    """
    Fail unless the stamp of each message is the ROS time at which the node sent it.

    :param found: messages, each with the virtual time of the earliest valid stamp [ns]; the latest
        valid stamp is the time of the message
    """
    pairs = list(found)
    for message, earliest_ns in pairs:
        stamp = field_of(message, field)
        stamp_ns = stamp['sec'] * SECOND + stamp['nanosec']
        first_ns, now_ns = clock.at(earliest_ns), clock.at(message['clock_ns'])
        if first_ns <= stamp_ns <= now_ns and clock.shows(stamp_ns):
            continue
        raise Failed(
            expected='a stamp with the ROS time when the message was sent'
            if run.secret
            else f'a stamp of {now_ns / SECOND:g} s, the ROS time when the message was sent',
            observed=_described(run, stamp_ns / SECOND, now_ns / SECOND),
            why=cause_of('prepared_stamp', field=field, about=[field])
            if _one_behind(pairs, clock, field) and not why_it_sleeps(run)
            else _why_stamp(run, field, stamp, now_ns / SECOND),
        )


def _one_behind(found: Sequence[tuple[Event, int]], clock: RosClock, field: str) -> bool:
    """Return whether each stamp is the time of the previous message, if this one was received."""
    pairs = [
        (before, earliest_ns, after)
        for (before, earliest_ns), (after, _) in pairwise(found)
        if after.get('number', 1) - before.get('number', 0) == 1
    ]
    taken = [field_of(after, field) for *_, after in pairs]
    taken_ns = [one['sec'] * SECOND + one['nanosec'] for one in taken]
    return len(taken) > 1 and all(
        clock.at(earliest_ns) <= one <= clock.at(before['clock_ns'])
        for (before, earliest_ns, _), one in zip(pairs, taken_ns)
    )


def _described(run: Run, seconds: float, now: float) -> str:
    # System time differs from run to run, so describe such a stamp without its value.
    if seconds > SYSTEM_TIME_S:
        return "a stamp from this computer's system time"
    # The fraction of an old stamp would reveal when a hidden clock began.
    if run.secret and seconds % 1:
        return f'{"an earlier" if seconds < now else "a later"} stamp'
    return f'a stamp of {seconds:.9g} s'


def _why_stamp(run: Run, field: str, stamp: dict[str, Any], now: float) -> Cause | None:
    sec, nanosec, right = stamp['sec'], stamp['nanosec'], int(now)
    if sec == nanosec == 0:
        if why := why_silent(run):
            return why
        situation = 'early_stamp' if Code(run.files).has_field(field) else 'missing_stamp'
    elif sec > SYSTEM_TIME_S:
        situation = 'wall_clock'
    elif abs(sec - right) > FAR_S:
        situation = 'other_clock'
    elif sec == right and nanosec < MILLISECOND:
        situation = 'nanoseconds'
    elif why := why_it_sleeps(run):
        return why
    else:
        situation = 'stale_stamp'
    return cause_of(situation, field=field, about=[field])

"""
Lesson 05, part 5: a listener that notices silence.

The specification, as the lesson gives it: node ``sensor_watch``; a subscription to
``std_msgs/msg/Float64`` on ``distance`` that hears a best-effort sensor and requests a deadline of
0.3 s; one INFO line with the number for each distance, one WARN line for each missed deadline, one
ERROR line that names the policy when a publisher's offer is too weak.

First come two publishers that promise no deadline, one after the other.  Then one that fits: it
sends some distances, keeps its promise, and falls silent.  How many deadlines are missed then is
known: the first comes one period after the last distance, the others follow period by period.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import takewhile

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Advance, Feed, Leave, Mark, Offer, Qos, Scenario
from autograder.judging.causes.ended import why_no_endpoint, why_silent
from autograder.judging.causes.missing_logs import why_left_out, why_not_logged
from autograder.judging.causes.redaction import quoted
from autograder.judging.checks import (
    count_of,
    own_logs,
    require_endpoint,
    require_qos,
    SECOND,
)
from autograder.judging.claims import node
from autograder.judging.numbers import numbers_in
from autograder.recording import ERROR, Event, INFO, Recording, WARN
from autograder.results import shortened

TYPE = 'std_msgs/msg/Float64'
NODE = '/sensor_watch'
DEADLINE_NS = 300_000_000
EVERY_S = 0.2  # from one distance to the next
SILENCE_S = 1.45  # from the last distance to the end: four deadlines, and time to log the last
BY_RCLPY = 'New publisher discovered on topic'
"""How the line of rclpy's own callback for refused publishers begins."""
REQUEST = {
    'RELIABILITY': 'Request reliability=ReliabilityPolicy.BEST_EFFORT.',
    'DURABILITY': 'Leave durability out: the sensor keeps nothing for latecomers.',
    'DEADLINE': 'Request deadline=Duration(seconds=0.3), which is what the sensor promises.',
    'LIVELINESS': 'Leave liveliness out: the sensor does not assert it by hand.',
}
TWICE = Cause(
    'logged_twice',
    'More than one INFO line shows the same distance.',
    'Log once in the callback, and subscribe once.',
)
WARNS_ONCE = Cause(
    'first_miss_only',
    'The sensor misses several deadlines, and not each of them gives a WARN line.',
    'Log in every call of the callback for deadline, without a flag, once= or throttle.',
)
WARNS_TWICE = Cause(
    'warned_twice',
    'More WARN lines come than deadlines are missed.',
    'Log one line in each call of the callback for deadline, however many were missed before.',
)
NOT_A_MISS = Cause(
    'warns_of_something_else',
    'WARN is for missed deadlines, and your node logs it when none is missed.',
    'Log a refused publisher as ERROR, and everything else as INFO.',
)
FIRST_ONLY = Cause(
    'first_refusal_only',
    'One refused publisher is logged, and another one is not.',
    'Log in every call of the callback for incompatible_qos, without a flag and once=.',
)
ONE_LINE = Cause(
    'several_errors',
    'One refused publisher gives more than one ERROR line.',
    'Put all there is to say into one line.',
)
LAZY = {'weak': 'a', 'weak again': 'another'}
"""Publishers that offer too little, each in a phase of its name."""
EXERCISE = 'Exercise 2: a listener that notices silence'


def warnings_before_silence(run: Run) -> list[Event]:
    """Return the WARN lines of the time in which no deadline is missed."""
    until = ('mark', 'silence')
    events = takewhile(lambda one: (one['event'], one.get('name')) != until, run.recording.events)
    before = Recording(run.recording.header, tuple(events))
    return own_logs(replace(run, recording=before), NODE, WARN)


def missed_deadlines(run: Run) -> int:
    """Return how many deadlines, as the subscription requests them, are missed in the silence."""
    asked = [end['qos']['deadline_ns'] for end in _ends(run) if end['qos']['deadline_ns']]
    return int(SILENCE_S * SECOND // min(asked)) if asked else 0


def asks_for_no_more_than_is_offered(run: Run) -> None:
    """It subscribes to distance, so that it hears a best-effort sensor."""
    require_qos(
        require_endpoint(run, 'subscription', '/distance', TYPE),
        reliability='BEST_EFFORT',
        durability='VOLATILE',
        liveliness='AUTOMATIC',
    )


def requests_the_deadline(run: Run) -> None:
    """It requests a deadline of 0.3 s."""
    ends = require_endpoint(run, 'subscription', '/distance', TYPE)
    require_qos(ends, deadline_ns=DEADLINE_NS)


def logs_each_distance(run: Run) -> None:
    """Each distance gives one INFO line that contains the number."""
    lines = own_logs(run, NODE, INFO)
    for index, distance in enumerate(run.facts['distances']):
        found = [line for line in lines if distance in numbers_in(str(line['text']))]
        # A later line may show it again, as the nearest distance so far.
        at_once = [line for line in found if line['after_input'] == index]
        if len(found) != run.facts['distances'].count(distance) and len(at_once) != 1:
            shown = f'the number of distance {index + 1}' if run.secret else f'{distance:g}'
            raise Failed(
                expected=f'one INFO line with {shown}',
                observed=f'{len(found) or "no"} such line{"" if len(found) == 1 else "s"}',
                why=TWICE
                if len(found) > run.facts['distances'].count(distance)
                else why_silent(run) or (None if found else _why_not_shown(run, index)),
            )


def _why_not_shown(run: Run, index: int) -> Cause | None:
    if why := _why_unheard(run):
        return why
    then = [line for line in own_logs(run, NODE) if line['after_input'] == index]
    other = next((str(line['text']) for line in then if line['level'] == INFO), '')
    if other:
        return Cause(
            'number_not_shown',
            f"The INFO line is '{quoted(run, other)}': the number is not in it, or it is rounded.",
            "Log the number as it came: self.get_logger().info(f'{message.data} m').",
        )
    distance = run.facts['distances'][index]
    # A deadline may be missed after any distance: that WARN line does not come instead.
    return why_not_logged(run, then, INFO, lambda text: distance in numbers_in(text)) or Cause(
        'not_logged',
        'A distance is sent to your node, and no INFO line follows it.',
        'Is hear() called? Log the number in it: self.get_logger().info(...), before any return.',
    )


def _why_unheard(run: Run) -> Cause | None:
    if why := why_silent(run):
        return why
    ends = run.recording.endpoints('subscription', '/distance')
    if not any(end['type'] == TYPE for end in ends):
        return why_no_endpoint(run, 'subscription', '/distance', TYPE)
    offered = run.recording.of('offered', publisher='sensor')
    if offered and offered[0]['refused']:
        policy = offered[0]['refused'][0]
        return Cause(
            'refused',
            f'Your subscription refuses the sensor: the policy {policy} asks for too much.',
            REQUEST.get(policy, 'Request no more than the sensor offers.'),
        )
    return None


def warns_of_silence(run: Run) -> None:
    """A missed deadline gives a WARN line, and nothing else does."""
    early = warnings_before_silence(run)
    if early:
        raise Failed(
            expected='no WARN line before the sensor has fallen silent',
            observed=repr(shortened(str(early[0]['text']), 80)),
            why=_why_default(early) or NOT_A_MISS,
        )
    silence = own_logs(run.during('silence'), NODE)
    found, due = sum(line['level'] == WARN for line in silence), missed_deadlines(run)
    if found == due > 0:
        return
    raise Failed(
        expected=f'one WARN line for each deadline missed in {SILENCE_S:g} s of silence',
        observed=f'{count_of(found)} WARN line{"" if found == 1 else "s"}',
        why=_why_other_count(run, found, due) if found else _why_no_warning(run, silence),
    )


def _why_other_count(run: Run, found: int, due: int) -> Cause:
    if found < due:
        return _why_unheard(run) or WARNS_ONCE
    return WARNS_TWICE if due else NOT_A_MISS


def _why_default(lines: Sequence[Event]) -> Cause | None:
    """Explain a WARN line that rclpy itself has written."""
    if not any(str(line['text']).startswith(BY_RCLPY) for line in lines):
        return None
    return Cause(
        'default_callback',
        'The WARN line about the refused publisher is from rclpy: your subscription has no '
        'callback of its own for incompatible_qos.',
        'Give incompatible_qos a callback that logs an error, and pass the callbacks on: '
        'create_subscription(..., event_callbacks=events).',
    )


def _why_no_warning(run: Run, silence: Sequence[Event]) -> Cause | None:
    if why := _why_unheard(run):
        return why
    asked = [end['qos']['deadline_ns'] for end in _ends(run)]
    if None in asked:
        return Cause(
            'no_deadline',
            'Your subscription requests no deadline, so none can be missed.',
            'Give its profile deadline=Duration(seconds=0.3).',
        )
    if asked and not missed_deadlines(run):
        return Cause(
            'long_deadline',
            f'Your subscription requests a deadline of {min(asked) / SECOND:g} s, and the '
            'silence is too short to miss it.',
            'Give its profile deadline=Duration(seconds=0.3).',
        )
    return why_not_logged(run, silence, WARN) or Cause(
        'no_deadline_callback',
        'A deadline is missed, and nothing is logged: its event has no callback, or the callback '
        'logs nothing.',
        'SubscriptionEventCallbacks(deadline=self.miss, ...), and a warning in miss().',
    )


def _ends(run: Run) -> list[Event]:
    ends = run.recording.endpoints('subscription', '/distance')
    return [end for end in ends if end['type'] == TYPE]


def names_the_policy(run: Run) -> None:
    """A publisher that offers too little gives one ERROR line with the name of the policy."""
    for lazy in LAZY:
        _require_refusal(run, lazy)


def _require_refusal(run: Run, publisher: str) -> None:
    """Fail unless one publisher that offers too little gives one ERROR line."""
    lazy = run.recording.of('offered', publisher=publisher)
    if lazy and lazy[0]['matched']:
        raise Failed(
            expected='a publisher without a deadline is refused',
            observed='your subscription takes it',
            why=Cause(
                'nothing_refused',
                'Your subscription requests no deadline, so no publisher offers too little.',
                'Give its profile deadline=Duration(seconds=0.3).',
            ),
        )
    lines = own_logs(run.during(publisher), NODE)
    errors = [str(line['text']) for line in lines if line['level'] == ERROR]
    if len(errors) != 1:
        raise Failed(
            expected=f'1 ERROR line after {LAZY[publisher]} publisher that promises no deadline',
            observed=f'{len(errors) or "no"} ERROR lines',
            why=ONE_LINE if errors else _why_no_error(run, lines),
        )
    policies = lazy[0]['refused'] if lazy else ['DEADLINE']
    if not any(policy in errors[0].upper() for policy in policies):
        raise Failed(
            expected=f'the name {" or ".join(policies)} in the ERROR line',
            observed=repr(shortened(errors[0], 80)),
            why=Cause(
                'policy_not_named',
                'The line does not say which policy failed.',
                'qos_policy_name_from_kind(event.last_policy_kind) is its name.',
            ),
        )


def _why_no_error(run: Run, lines: Sequence[Event]) -> Cause | None:
    if why := why_silent(run) or _why_default(lines):
        return why
    if not _ends(run):
        return why_no_endpoint(run, 'subscription', '/distance', TYPE)
    first = own_logs(run.during(next(iter(LAZY))), NODE, ERROR)
    if first:
        return why_left_out(run, ERROR, first) or FIRST_ONLY
    return why_not_logged(run, lines, ERROR) or Cause(
        'no_incompatible_callback',
        'A publisher is refused, and nothing is logged: the event has no callback, or the '
        'callback logs nothing.',
        'SubscriptionEventCallbacks(incompatible_qos=self.refuse, ...), and an error in refuse().',
    )


def build(distances: Sequence[float]) -> Exam:
    """
    Return the exam with some distances.

    :param distances: numbers with decimals [m]; the first one is not sent again
    """
    lazy = [
        step
        for name in LAZY
        for step in (
            Mark(name),
            Offer(name, '/distance', TYPE, Qos('BEST_EFFORT')),
            Advance(1.0),
            Leave(name),
        )
    ]
    exam = Exam(
        'sensor_watch',
        title='A listener that notices silence',
        assignment='05_quality_of_service',
        part=2,
        scenario=Scenario(
            file='sensor_watch.py',
            steps=(
                *lazy,
                # It promises enough, sends nothing and leaves: no deadline is missed.
                Mark('guest'),
                Offer('guest', '/distance', TYPE, Qos('BEST_EFFORT', deadline_s=0.3)),
                Leave('guest'),
                Advance(0.5),
                Mark('speaking'),
                Offer('sensor', '/distance', TYPE, Qos('BEST_EFFORT', deadline_s=0.3)),
                Feed(
                    'sensor',
                    [{'data': distance} for distance in distances],
                    optional=True,
                    every_s=EVERY_S,
                    rest_s=0.0,
                ),
                Mark('silence'),
                Advance(SILENCE_S - EVERY_S),
                Mark('over'),
            ),
        ),
        read='Part 5: Promises over time',
        facts={'distances': list(distances)},
    )
    exam.check(points=1, read=EXERCISE)(node(NODE, only_named=True))
    for points, judge, read in (
        (2, asks_for_no_more_than_is_offered, 'Part 3: Offer and request'),
        (2, requests_the_deadline, ''),
        (2, logs_each_distance, EXERCISE),
        (3, warns_of_silence, ''),
        (2, names_the_policy, 'Part 3: Offer and request'),
    ):
        exam.check(points=points, needs=['starts_its_node'], read=read)(judge)
    return exam


exam = build([1.25, 3.75, 2.25])

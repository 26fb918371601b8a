"""
Lesson 05, part 5: a subscription that detects silence.

Specification from the lesson: node ``sensor_watch``; a subscription to ``std_msgs/msg/Float64`` on
``distance`` that matches a best-effort sensor and requests a deadline of 0.3 s; one INFO line with
the number for each distance, one WARN line for each missed deadline, one ERROR line that names the
policy if a publisher offers too little.

First, two publishers without a deadline appear, one after the other.  Then a compatible one sends
some distances on time and falls silent.  The number of missed deadlines is known: the first is one
period after the last distance, and the others follow once per period.  In the hidden exam, the
sensor then returns with faster messages, and falls silent for longer.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import takewhile
import math
import re

from autograder.exam.exam import Cause, Exam, Failed, Run, Scenario
from autograder.exam.slips import leaving_out
from autograder.exam.specification import each, Specification
from autograder.exam.steps import Advance, Feed, Leave, Mark, Offer, Qos, Step
from autograder.exam.words import Causes
from autograder.judging.causes.ended import why_no_endpoint, why_silent
from autograder.judging.causes.missing_logs import (
    lines_of_code,
    why_left_out,
    why_not_logged,
)
from autograder.judging.causes.redaction import redacted
from autograder.judging.checks import lines, own_logs
from autograder.judging.claims import node, requests
from autograder.judging.numbers import near, numbers_in, rounded
from autograder.judging.rhythm import GRAIN_S
from autograder.judging.rows import rows
from autograder.recording import ERROR, Event, INFO, Recording, SECOND, WARN
from autograder.results import shortened

TYPE = 'std_msgs/msg/Float64'
NODE = '/sensor_watch'
TOPIC = '/distance'
DEADLINE_NS = 300_000_000
EVERY_S = {'silence': 0.2, 'long silence': 0.02}  # between the distances before it [s]
GRAIN = 0.005  # the number may be rounded to 0.01 [m]
SILENCES_S = {'silence': 1.45, 'long silence': 31.05}
"""Times after the last distance, each with time to log the last missed deadline [s]."""
BY_RCLPY = 'New publisher discovered on topic'
"""Start of the line that rclpy's default callback logs for an incompatible publisher."""
WHY = Causes(__file__)
LOGGED = each(lambda distance: (distance,))
SLIPS = (
    *leaving_out(LOGGED, do='Log', numbers=True)[1:],
    rounded(lambda change: each(lambda distance: (change(distance),))),
    WHY.slip('skips_infinity', each(lambda one: (one,) if math.isfinite(one) else ())),
)
LAZY = {'weak': 'a', 'weak again': 'another'}
"""Publishers that offer too little, with an article for feedback; each has its own phase."""
EXERCISE = 'Exercise 2: a listener that notices silence'


def needless_warnings(run: Run) -> list[Event]:
    """Return the WARN lines before and between the silences, when no deadline is missed."""
    until = ('mark', 'silence')
    events = takewhile(lambda one: (one['event'], one.get('name')) != until, run.recording.events)
    before = Recording(run.recording.header, tuple(events))
    parts = replace(run, recording=before), run.during('speaking again')
    return [line for part in parts for line in own_logs(part, NODE, WARN)]


def deadlines_ns(run: Run) -> list[int | None]:
    """Return the deadline that each subscription requests [ns], None for no deadline."""
    ends = run.recording.endpoints('subscription', TOPIC)
    return [end['qos']['deadline_ns'] for end in ends if end['type'] == TYPE]


def missed_deadlines(run: Run, silence_s: float) -> int:
    """Return how many deadlines are missed during a silence, given the requested deadline."""
    asked = [one for one in deadlines_ns(run) if one]
    return int(silence_s * SECOND // min(asked)) if asked else 0


def _alike(some: Sequence[float], others: Sequence[float]) -> bool:
    """Return whether numbers are equal, apart from rounding to 0.01."""
    alike = (near([one], [other], GRAIN) for one, other in zip(some, others))
    return len(some) == len(others) and all(alike)


def _shows(text: str, distance: float) -> bool:
    """Return whether a text has the number, rounded to 0.01 or finer; thousands may be marked."""
    if math.isinf(distance):  # '0000inf' and 'infm' show it; 'info' and 'infrared' do not
        return bool(re.search('inf(?![or])', text, re.IGNORECASE))
    readings = (numbers_in(text.replace(mark, '')) for mark in ('', *",._' "))
    return any(near([distance], numbers, GRAIN) for numbers in readings)


def _shown_in(text: str, distance: float) -> float:
    """Return the distance if a text shows it, or else the first number in the text, or NaN."""
    return distance if _shows(text, distance) else next(iter(numbers_in(text)), math.nan)


def logs_each_distance(run: Run) -> None:
    """It logs each distance in one INFO line that contains the number."""
    distances = run.asked('distances').inputs
    logged = own_logs(run, NODE, INFO)
    for index, distance in enumerate(distances):
        found = [line for line in logged if _shows(str(line['text']), distance)]
        # A later line may repeat the number, for example as the shortest distance so far.
        at_once = [line for line in found if line['after_input'] == index]
        due = distances.count(distance)
        if len(found) != due and len(at_once) != 1:
            shown = f'the number of distance {index + 1}' if run.secret else f'{distance:g}'
            raise Failed(
                expected=f'one INFO line with {shown}, each time it arrives',
                observed=f'{lines(len(found), INFO)} with {shown}',
                why=WHY['logged_twice']
                if len(found) > due
                else _why_not_shown(run, index, bool(found)),
            )


def _why_not_shown(run: Run, index: int, later: bool) -> Cause | None:
    """Explain a distance without its own line; ``later``: another line shows the number."""
    asked = run.asked('distances')
    came = [
        tuple(_shown_in(str(line['text']), one) for line in row or ())
        for one, row in zip(asked.inputs, rows(run, 'distances', own_logs(run, NODE, INFO)))
    ]
    left_out = why_left_out(run, INFO, run.recording.logs(level=INFO))
    if why := why_silent(run) or left_out or asked.cause(came, index):
        return why
    if later or (why := _why_unheard(run)):
        return why
    then = [line for line in own_logs(run, NODE) if line['after_input'] == index]
    other = next((str(line['text']) for line in then if line['level'] == INFO), '')
    if other:
        return WHY.of('number_not_shown', about=[other], said=redacted(run, other))
    distance = asked.inputs[index]
    # A missed deadline may cause a WARN line after any distance; it does not replace the INFO
    # line.
    return (
        why_not_logged(run, then, INFO, lambda text: _shows(text, distance)) or WHY['not_logged']
    )


def _why_unheard(run: Run) -> Cause | None:
    if why := why_silent(run):
        return why
    if not deadlines_ns(run):
        return why_no_endpoint(run, 'subscription', TOPIC, TYPE)
    offered = run.recording.of('offered', publisher='sensor')
    if offered and offered[0]['refused']:
        return WHY.of('refused', policy=offered[0]['refused'][0])
    return None


def warns_of_silence(run: Run) -> None:
    """Each missed deadline causes a WARN line, and nothing else does."""
    early = needless_warnings(run)
    if early:
        raise Failed(
            expected='no WARN line while no deadline is missed',
            observed=repr(shortened(str(early[0]['text']), 80)),
            why=_why_default(early) or _why_early(run, early),
            shown_by=early,
        )
    for phase, silence_s in run.facts['silences_s'].items():
        silence = own_logs(run.during(phase), NODE)
        found = sum(line['level'] == WARN for line in silence)
        due = missed_deadlines(run, silence_s)
        length = f'a {phase}' if run.secret else f'{silence_s:g} s of silence'
        if found != due or not due:
            raise Failed(
                expected=f'one WARN line for each deadline missed in {length}',
                observed=lines(found, WARN),
                why=_why_other_count(run, silence, due),
            )


def _why_early(run: Run, early: Sequence[Event]) -> Cause:
    """Explain WARN lines without a missed deadline."""
    begun = [one['clock_ns'] for one in run.recording.of('offered')]
    alone = all(abs(line['clock_ns'] - one) > GRAIN_S * SECOND for line in early for one in begun)
    same = lines_of_code(early) <= lines_of_code(own_logs(run.during('silence'), NODE, WARN))
    first = early[0]['after_input'] is None
    return WHY['own_watchdog'] if first and alone and same else WHY['warns_of_something_else']


def _why_default(lines: Sequence[Event]) -> Cause | None:
    """Explain a WARN line from rclpy's default callback."""
    by_rclpy = any(str(line['text']).startswith(BY_RCLPY) for line in lines)
    return WHY['default_callback'] if by_rclpy else None


def _why_other_count(run: Run, silence: Sequence[Event], due: int) -> Cause | None:
    """Explain too many or too few WARN lines during the silence."""
    found = sum(line['level'] == WARN for line in silence)
    if found >= max(due, 1):
        return WHY['warned_twice'] if due else WHY['warns_of_something_else']
    if why := _why_unheard(run):
        return why
    others = [line for line in silence if line['level'] != WARN]
    if found + len(others) == due and (why := why_not_logged(run, others, WARN)):
        return why
    if logged := own_logs(run, NODE, WARN):  # in silences: another check reports others
        return why_left_out(run, WARN, logged) or WHY['first_miss_only']
    if not due or None in deadlines_ns(run):
        return WHY['no_deadline']
    return why_not_logged(run, silence, WARN) or WHY['no_deadline_callback']


def names_the_policy(run: Run) -> None:
    """For each publisher that offers too little, it logs one ERROR line that names the policy."""
    for publisher in LAZY:
        lazy = run.recording.of('offered', publisher=publisher)
        if lazy and lazy[0]['matched']:
            raise WHY.failed('nothing_refused')
        found = own_logs(run.during(publisher), NODE)
        errors = [str(line['text']) for line in found if line['level'] == ERROR]
        if len(errors) != 1:
            raise Failed(
                expected=f'1 ERROR line after {LAZY[publisher]} publisher that promises no '
                'deadline',
                observed=f'{len(errors) or "no"} ERROR lines',
                why=WHY['several_errors'] if errors else _why_no_error(run, found),
            )
        policies = lazy[0]['refused'] if lazy else ['DEADLINE']
        if not any(policy in errors[0].upper() for policy in policies):
            said = shortened(errors[0], 80)
            raise WHY.failed('policy_not_named', policies=' or '.join(policies), said=said)


def _why_no_error(run: Run, found: Sequence[Event]) -> Cause | None:
    if why := why_silent(run) or _why_default(found):
        return why
    if not deadlines_ns(run):
        return why_no_endpoint(run, 'subscription', TOPIC, TYPE)
    if first := own_logs(run.during(next(iter(LAZY))), NODE, ERROR):
        return why_left_out(run, ERROR, first) or WHY['first_refusal_only']
    return why_not_logged(run, found, ERROR) or WHY['no_incompatible_callback']


def _spoken(distances: Sequence[float], silence: str) -> list[Step]:
    """Return the steps that send distances on time, and then nothing."""
    sent, every_s = [{'data': distance} for distance in distances], EVERY_S[silence]
    return [
        Feed('sensor', sent, optional=True, every_s=every_s, rest_s=0.0),
        *(Mark(silence), Advance(SILENCES_S[silence] - every_s)),
    ]


def build(distances: Sequence[float], later: Sequence[float] = ()) -> Exam:
    """
    Return the exam for some distances.

    :param distances: numbers with decimals [m]; the first one occurs only once
    :param later: distances after the first silence, followed by a long one; by default, neither
    """
    weak, strong = Qos('BEST_EFFORT'), Qos('BEST_EFFORT', deadline_s=0.3)
    lazy = [
        step
        for name in LAZY
        for step in (Mark(name), Offer(name, TOPIC, TYPE, weak), Advance(1.0), Leave(name))
    ]
    again = [Mark('speaking again'), *_spoken(later, 'long silence')] if later else []
    exam = Exam(
        'sensor_watch',
        title='A listener that notices silence',
        assignment='05_quality_of_service',
        part=2,
        scenario=Scenario(
            file='sensor_watch.py',
            steps=(
                *lazy,
                # This publisher is compatible, sends nothing and leaves, so no deadline is missed.
                *(Mark('guest'), Offer('guest', TOPIC, TYPE, strong), Leave('guest')),
                *(Advance(0.5), Mark('speaking'), Offer('sensor', TOPIC, TYPE, strong)),
                *(*_spoken(distances, 'silence'), *again, Mark('over')),
            ),
        ),
        read='Part 5: Promises over time',
        facts={'silences_s': dict([*SILENCES_S.items()][: 2 if later else 1])},
        asks={'distances': Specification([*distances, *later], LOGGED, SLIPS, like=_alike)},
    )
    needs, part_3 = ['starts_its_node'], 'Part 3: Offer and request'
    exam.check(points=1, read=EXERCISE)(node(NODE, only_named=True))
    exam.check(points=2, needs=needs, read=part_3)(
        requests(
            TOPIC,
            TYPE,
            'asks_for_no_more_than_is_offered',
            'It subscribes to distance so that it can receive from a best-effort sensor.',
            reliability='BEST_EFFORT',
            durability='VOLATILE',
            liveliness='AUTOMATIC',
        )
    )
    sentence = 'It requests a deadline of 0.3 s.'
    exam.check(points=2, needs=needs)(
        requests(TOPIC, TYPE, 'requests_the_deadline', sentence, deadline_ns=DEADLINE_NS)
    )
    exam.check(points=2, needs=needs, read=EXERCISE)(logs_each_distance)
    exam.check(points=3, needs=needs)(warns_of_silence)
    exam.check(points=2, needs=needs, read=part_3)(names_the_policy)
    return exam


exam = build([1.25, 3.75, 2.25])

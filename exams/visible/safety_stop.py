"""
Lesson 05, part 6: a node that stops a robot when the commands of its driver cease.

Specification from the lesson: node ``safety_stop``; it publishes each ``geometry_msgs/msg/Twist``
from ``cmd_vel_raw`` at once on ``cmd_vel``, with ``linear.x`` limited to -0.5 to 0.5 and
``angular.z`` unchanged; 0.5 s to 0.6 s after the last command, even one of zeros, it publishes one
``Twist`` with zeros, then nothing until the next command; nothing before the first command.
"""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
import math
from typing import Any, NamedTuple

from autograder.exam.exam import Exam, Run, Scenario
from autograder.exam.slips import Change, changing, Limit, limiting_slips, SKIPS_EQUAL, within
from autograder.exam.specification import Rule, Slip, Specification
from autograder.exam.steps import Advance, BURST, Feed, Leave
from autograder.exam.words import Causes
from autograder.judging.checks import field_of, require_messages
from autograder.judging.claims import node, passes
from autograder.judging.rhythm import GRAIN_S
from autograder.judging.rows import (
    published,
    require_all_sent,
    require_one_for_one,
    require_values,
)
from autograder.recording import SECOND

SOURCE, TARGET, TWIST = '/cmd_vel_raw', '/cmd_vel', 'geometry_msgs/msg/Twist'
FIELDS = 'linear.x', 'angular.z'
LIMIT, SILENCE_S, LATE_S = 0.5, 0.5, 0.1
STOP = (0.0, 0.0)
QUIET_S = 0.9  # at the start, without a command, and at the end, without a driver
SHORT_S, MIDDLE_S, LONG_S = (0.31, 0.43), 0.83, 1.66  # from one command to the next
Pair = tuple[float, float]

WHY = Causes(__file__, LATE_S=LATE_S, SILENCE_S=SILENCE_S, LATEST_S=SILENCE_S + LATE_S)


class Command(NamedTuple):
    """One input, and the time to the next one [s]."""

    speed: float
    turn: float
    lasts_s: float


def right_pair(one: Command) -> Pair:
    """Return the speed and the turn that a correct node publishes for a command."""
    return within(one.speed, LIMIT), one.turn


def guarding(
    pair: Callable[[Command], Pair | None] = right_pair,
    stops: Callable[[Command, int], Sequence[Pair]] = lambda one, silence: [STOP],
    after_s: float = SILENCE_S,
    for_good: Sequence[Pair] | None = None,
) -> Rule:
    """
    Return the rule of a safety stop; with the default values, the correct one.

    :param pair: returns the speed and turn to publish for a command, None for nothing
    :param stops: returns what to publish during a silence, given the last command and the number
        of silences so far
    :param after_s: length of a pause that counts as a silence [s]
    :param for_good: published for each command after the first silence; None for no change
    """

    def rule(inputs: Sequence[Command]) -> list[tuple[Pair, ...]]:
        found, silences = [], 0
        for one in inputs:
            passed = pair(one)
            row = [passed] if passed else []
            if silences and for_good is not None:
                row = list(for_good)
            elif one.lasts_s > after_s:
                silences += 1
                row += stops(one, silences)
            found.append(tuple(row))
        return found

    return rule


def limiting(cut: Limit) -> Rule:
    """Return the rule of a safety stop that limits the speed with the given function."""

    def pair(one: Command) -> Pair | None:
        speed = cut(one.speed, LIMIT)
        return None if speed is None else (speed, one.turn)

    return guarding(pair)


def turning(change: Change) -> Rule:
    """Return the rule of a safety stop that changes the turn."""
    return guarding(lambda one: (within(one.speed, LIMIT), change(one.turn)))


def ignoring_fast(inputs: Sequence[Command]) -> list[tuple[Pair, ...]]:
    """Return what a node publishes that treats commands above the limit as a silence."""
    found, silence_s = [], math.inf  # since the last other command
    for one in inputs:
        fast = abs(one.speed) > LIMIT
        before_s = silence_s if fast else 0.0
        silence_s = before_s + one.lasts_s
        stop = [STOP] * (before_s <= SILENCE_S < silence_s)
        found.append((*([] if fast else [right_pair(one)]), *stop))
    return found


def skipping(instead: Sequence[Pair]) -> Rule:
    """Return the rule of a safety stop that skips a command that equals the previous one."""

    def rule(inputs: Sequence[Command]) -> list[tuple[Pair, ...]]:
        again = [False, *(one[:2] == two[:2] for one, two in pairwise(inputs))]
        return [tuple(instead) if equal else row for equal, row in zip(again, guarding()(inputs))]

    return rule


def losing(lost: Callable[[Command, bool], bool], at_first: bool = True) -> Rule:
    """
    Return the rule of a safety stop that does not pass on some commands.

    :param lost: returns whether a command is lost, given whether a stop precedes it
    :param at_first: whether the node begins as after a stop
    """

    def rule(inputs: Sequence[Command]) -> list[tuple[Pair, ...]]:
        stopped = [at_first, *(one.lasts_s > SILENCE_S for one in inputs)]
        skip = map(lost, inputs, stopped)
        return [row[1:] if out else row for out, row in zip(skip, guarding()(inputs))]

    return rule


SLIPS = (
    Slip.of(SKIPS_EQUAL, skipping(()), skipping([STOP])),
    WHY.slip(
        'skips_zeros',
        losing(lambda one, after: one[:2] == STOP),
        losing(lambda one, after: one[:2] == STOP and after),
    ),
    WHY.slip(
        'first_after_stop',
        *(losing(lambda one, after: after, at_first) for at_first in (False, True)),
    ),
    *limiting_slips(limiting, 'command.linear.x', '0.5'),
    WHY.slip('drops_fast', ignoring_fast),
    WHY.slip(
        'speed_scaled',
        limiting(lambda speed, most: speed * most),
        limiting(lambda speed, most: within(speed * most, most)),
    ),
    WHY.slip('other_limit', limiting(lambda speed, most: within(speed, 2 * most))),
    WHY.slip(
        'stops_fast', guarding(lambda one: STOP if abs(one.speed) > LIMIT else right_pair(one))
    ),
    WHY.slip(
        'turn_limited',
        *(turning(partial(within, most=one)) for one in (LIMIT, 1.0, 2.0)),
        guarding(
            lambda one: (right_pair(one)[0], one.turn * right_pair(one)[0] / (one.speed or 1.0))
        ),
    ),
    WHY.slip('turn_lost', turning(lambda turn: 0.0)),
    *changing(lambda change: limiting(lambda speed, most: change(within(speed, most))), turning),
    WHY.slip('no_stop', guarding(stops=lambda one, silence: [])),
    WHY.slip(
        'half_a_stop',
        guarding(stops=lambda one, silence: [(0.0, one.turn)]),
        guarding(stops=lambda one, silence: [(within(one.speed, LIMIT), 0.0)]),
    ),
    WHY.slip('repeats_last', guarding(stops=lambda one, silence: [right_pair(one)])),
    WHY.slip(
        'no_stop_after_zeros',
        guarding(stops=lambda one, silence: [] if one[:2] == STOP else [STOP]),
        guarding(stops=lambda one, silence: [] if one.speed == 0.0 else [STOP]),
    ),
    WHY.slip('stops_turning', guarding(lambda one: right_pair(one) if one.speed else STOP)),
    WHY.slip('stops_once', guarding(stops=lambda one, silence: [STOP] if silence == 1 else [])),
    WHY.slip('stops_for_good', guarding(for_good=()), guarding(for_good=(STOP,))),
    WHY.slip('early_stop', guarding(after_s=0.25)),
    WHY.slip('late_stop', guarding(after_s=1.0)),
    WHY.slip(
        'repeats_stop', guarding(stops=lambda one, silence: [STOP] * int(one.lasts_s / SILENCE_S))
    ),
)


def _came(run: Run) -> tuple[Specification, list[tuple[Any, ...] | None]]:
    return run.facts['commands'], published(run, 'commands', TARGET, *FIELDS)


def places(asked: Specification, silent: bool, fast: bool = False) -> list[int]:
    """
    Return the indices of the commands before a silence, or of other fast or slow commands.

    :param silent: whether to return the commands before a silence, and the burst
    :param fast: whether the other commands are those above the speed limit
    """
    singles = asked.inputs[: len(asked.inputs) - asked.burst]
    if silent:
        long = [place for place, one in enumerate(singles) if one.lasts_s > SILENCE_S]
        return [*long, len(singles)]
    return [
        place
        for place, one in enumerate(singles)
        if one.lasts_s < SILENCE_S and (abs(one.speed) > LIMIT) == fast
    ]


def passes_commands_on(run: Run) -> None:
    """It passes each command on once, with its turn, and publishes nothing before the first."""
    asked, came = _came(run)
    require_one_for_one(run, 'commands', TARGET, came, ())
    plain = places(asked, silent=False)
    for place in plain:
        if STOP in (came[place] or ())[1:] and asked.inputs[place][:2] != STOP:
            raise WHY.failed('early_stop', asked.cause(came, place, plain))
    require_one_for_one(run, 'commands', TARGET, came, plain)
    require_values(run, asked, came, plain, fields=FIELDS)


def limits_the_speed(run: Run) -> None:
    """It limits the speed to the range -0.5 to 0.5, but does not limit the turn."""
    asked, came = _came(run)
    require_values(run, asked, came, places(asked, silent=False, fast=True), fields=FIELDS)


def stops_in_silence(run: Run) -> None:
    """During each silence longer than 0.5 s, it publishes exactly one Twist with zeros."""
    asked, came = _came(run)
    silent = places(asked, silent=True)
    for place in silent:
        stops = (came[place] or ()).count(STOP)
        if stops > asked.answers[place].count(STOP):
            why = asked.cause(came, place, silent)
            raise WHY.failed('repeats_stop', why, stops=stops, number=place + 1)
    require_values(run, asked, came, silent, fields=FIELDS)
    require_all_sent(run, came)


def keeps_its_times(run: Run) -> None:
    """It passes a command on at once, and stops 0.5 s to 0.6 s after the last command."""
    sent = [one['clock_ns'] for one in run.recording.of('input')]
    stops_s, singles = [], len(run.asked('commands').inputs) - BURST
    for message in require_messages(run, topic=TARGET):
        # A different check reports messages before all commands; several commands take a while.
        if message['after_input'] is None or message['after_input'] >= singles:
            continue
        late_s = (message['clock_ns'] - sent[message['after_input']]) / SECOND
        values = tuple(field_of(message, one) for one in FIELDS)
        if values != STOP and late_s > GRAIN_S:
            raise WHY.failed('passed_late', late_s=late_s)
        if values == STOP and late_s > GRAIN_S:
            stops_s.append(late_s)
    least_s, most_s = SILENCE_S - GRAIN_S, SILENCE_S + LATE_S + GRAIN_S
    for late_s in stops_s:
        if not least_s <= late_s <= most_s:
            # A timer that each command resets is equally late in each silence.
            rarely = min(stops_s) >= least_s and max(stops_s) - min(stops_s) > GRAIN_S
            raise WHY.failed('looks_rarely' if rarely else 'other_moment', late_s=late_s)


def build(commands: Sequence[Command]) -> Exam:
    """Return the exam for some commands, the last :data:`BURST` of them sent at once."""
    data = [{'linear': {'x': one.speed}, 'angular': {'z': one.turn}} for one in commands]
    singles = [
        Feed(SOURCE, [sent], every_s=one.lasts_s, rest_s=0.0)
        for sent, one in zip(data[:-BURST], commands)
    ]
    burst = Feed(SOURCE, data[-BURST:], burst=True, every_s=LONG_S, rest_s=0.0)
    exam = Exam(
        'safety_stop',
        title='A safety stop',
        assignment='05_quality_of_service',
        part=3,
        scenario=Scenario(
            file='safety_stop.py',
            watch={TARGET: TWIST},
            feed={SOURCE: TWIST},
            steps=(Advance(QUIET_S), *singles, burst, Leave(SOURCE), Advance(QUIET_S)),
        ),
        read='Exercise 3: a safety stop',
        asks={'commands': Specification(commands, guarding(), SLIPS, BURST)},
    )
    exam.check(points=1)(node('/safety_stop'))
    exam.check(points=1)(passes((SOURCE, TWIST), (TARGET, TWIST)))
    exam.check(points=2, needs=['reads_and_writes'])(passes_commands_on)
    exam.check(points=2, needs=['reads_and_writes'])(limits_the_speed)
    exam.check(points=3, needs=['reads_and_writes'])(stops_in_silence)
    exam.check(points=1, needs=['passes_commands_on', 'stops_in_silence'])(keeps_its_times)
    return exam


def drive(speeds: Sequence[float], turns: Sequence[float]) -> list[Command]:
    """
    Return commands with four silences; one precedes a command of zeros, and one follows another.

    The first command is sent twice, and the last ones form a burst.  Before a silence, speed and
    turn are small, so that a wrong limit does not affect the checks of silences.

    :param speeds: ten numbers and those of the burst; only the third, fourth and eighth are
        outside the limits, and the sixth may be 0.0
    :param turns: as many different numbers other than 0.0; the fifth, the seventh and those from
        the tenth on are at most 0.5
    """
    short, long = SHORT_S
    pauses = (short, long, short, long, LONG_S, short, MIDDLE_S, long, short, LONG_S)
    lasts = (*pauses, *(0.0,) * (BURST - 1), LONG_S)
    commands = [Command(*one) for one in zip(speeds, turns, lasts, strict=True)]
    zeros = [Command(*STOP, lasts_s) for lasts_s in (short, LONG_S)]
    return [commands[0], *commands[:5], zeros[0], commands[5], zeros[1], *commands[6:]]


exam = build(
    drive(
        [0.3, -0.4, 0.9, -0.8, 0.2, 0.45, 0.3, 1.5, 0.5, 0.35]
        + [0.05 * place for place in range(1, BURST + 1)],
        [0.2, -0.1, 0.7, 0.3, 0.45, -0.6, 0.4, 1.2, 0.1, -0.3]
        + [0.25 - 0.04 * place for place in range(BURST)],
    )
)

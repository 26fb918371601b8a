"""
Lesson 07, part 2: the temperature publisher.

The specification, as the lesson gives it: node ``temperature_publisher``; one
``temp_monitor_pkg/msg/Temperature`` a second on ``temperature_topic``; unit ``Celsius``; sensor id
``temp_sensor_01``; the stamp is the node's clock; readings vary and stay between -40 and 125 °C
(the range of common digital sensors, such as the DS18B20's -55 to 125 °C); quality of service
reliable and volatile, which is what depth 10 gives.
"""

from __future__ import annotations

import math

from autograder.judging.causes import why_no_endpoint, why_no_message, why_silent
from autograder.judging.checks import (
    none_of,
    OWN_LOOP,
    PACED_BY_SPIN_ONCE,
    refuse_own_clock,
    require_node,
    SECOND,
)
from autograder.judging.clock_steps import in_parts
from autograder.judging.code_places import seed_in_callback
from autograder.judging.exam import Cause, Exam, Failed, Run
from autograder.judging.learners_code import FieldUse, use_of_field
from autograder.judging.own_time import (
    is_flood,
    is_regular,
    keeps_its_timer,
    least_messages,
    names_another_clock,
)
from autograder.judging.stalled import why_it_sleeps
from autograder.runs.recording import Event
from autograder.runs.scenario import Advance, Scenario

NODE = '/temperature_publisher'
TOPIC = '/temperature_topic'
TYPE = 'temp_monitor_pkg/msg/Temperature'
SENSOR = 'temp_sensor_01'
COLDEST_C, HOTTEST_C = -40.0, 125.0
BEFORE_THE_LIMIT = 10
"""Readings in the time that a run may take, if each waits as long as the probe waits for it."""
OTHER_CLOCK = Cause(
    'other_clock',
    "Your messages do not come in the rhythm of the node's own clock.",
    'Use self.create_timer(1.0, ...), and leave use_sim_time as the command line sets it.',
)
EXERCISE = 'Exercise 2: the publisher node'


def readings(run: Run) -> list[Event]:
    """
    Return the readings that count, in order.

    Time begins when the program has shown that it listens, or is watched because it does not.
    What it sends before, in ``__init__``, may or may not be heard.
    """
    return [
        event
        for event in run.recording.messages(TOPIC)
        if 'data' in event and event['clock_ns'] is not None
    ]


def enough_readings(run: Run) -> list[Event]:
    """
    Return the readings if they are enough to judge what *every* reading is like.

    :raises Failed: if fewer than half of what is due has come; of a program that was ended for its
        slowness, what surely comes on any machine
    """
    found = readings(run)
    due = int(run.facts['simulated_s']) // 2
    if run.recording.in_wall_time:
        due = least_messages(run.recording, 1.0)
    if run.recording.end_reason == 'wall_time_limit':
        due = min(due, BEFORE_THE_LIMIT)
    if len(found) < due:
        raise Failed(
            expected=f'{run.facts["simulated_s"]} readings, of which this looks at every one',
            observed=f'only {len(found)}',
            why=why_silent(run),
        )
    return found


def starts_its_node(run: Run) -> None:
    """Your program starts a node called temperature_publisher."""
    require_node(run, NODE)


def publishes_readings(run: Run) -> None:
    """It publishes Temperature messages on temperature_topic."""
    expected = f'messages of type {TYPE} on {TOPIC}'
    ends = run.recording.endpoints('publisher', TOPIC)
    if not any(end['type'] == TYPE for end in ends):
        raise Failed(
            expected=expected,
            observed='no such publisher',
            why=why_no_endpoint(run, 'publisher', TOPIC, TYPE),
        )
    if not readings(run):
        raise Failed(
            expected=expected,
            observed=none_of(run, 'the publisher, but no message'),
            why=why_no_message(run),
        )


def publishes_once_per_second(run: Run) -> None:
    """It publishes exactly once per second, measured on the ROS clock."""
    seconds = int(run.facts['simulated_s'])
    if run.recording.in_wall_time:
        return _once_per_second_in_wall_time(run)
    found = [event['clock_ns'] for event in readings(run)]
    wrong = _first_wrong_second(found, seconds)
    if wrong is None:
        return None
    expected = f'{seconds} messages in {seconds} s of simulated time, one in every second'
    if not _keeps_the_clock(run, found) and not why_silent(run):
        raise Failed(
            expected=expected,
            observed='messages in another rhythm',
            why=why_it_sleeps(run) or OTHER_CLOCK,
        )
    why = _why_wrong_rhythm(run, found, seconds)
    many = 'far more' if is_flood(len(found), seconds) else len(found)
    observed = f'{many} messages; first difference in second {wrong}'
    if why is not None and why.cause_id == 'paced_by_spin_once':  # how many, is luck
        observed = 'a message whenever anything happens'
    raise Failed(
        expected=expected,
        observed=observed,
        why=why,
        at=_moment_of(found, wrong),
        every_s=1.0,
    )


def _keeps_the_clock(run: Run, clocks_ns: list[int]) -> bool:
    """Tell whether the node's clock paces the messages, so that their number is no luck."""
    if not names_another_clock(run.files):
        return True
    step_s = _ticks(run)[1] / SECOND
    return keeps_its_timer(run.files, [clock / SECOND for clock in clocks_ns], step_s)


def _why_wrong_rhythm(run: Run, clocks_ns: list[int], seconds: int) -> Cause | None:
    """Explain messages that follow the node's clock, at the wrong moments."""
    if why := why_silent(run):
        return why
    code = '\n'.join(run.files.values())
    if 'spin_once(' in code and 'create_timer' not in code:
        return PACED_BY_SPIN_ONCE
    if len(clocks_ns) > seconds and len(set(clocks_ns)) < len(clocks_ns):
        return Cause(
            'several_at_once',
            'Several messages come at the same moment.',
            'Publish once in the callback of the timer, and make one timer only.',
        )
    rate = len(clocks_ns) / seconds
    if abs(rate - 1.0) > 0.01:
        # A timer that is shorter than a clock step fires once a step.
        often = 'far more than once' if is_flood(rate, 1.0) else f'about {rate:.3g} times'
        return Cause(
            'wrong_rate',
            f'Your node publishes {often} a second.',
            'The first argument of create_timer() is the period in seconds: 1.0.',
        )
    return None


def _first_wrong_second(clocks_ns: list[int], seconds: int) -> int | None:
    """
    Return the first second without exactly one message, from 1, or None.

    The timer fires on the first clock step at or after each whole second: half a second later at
    most, see :mod:`autograder.judging.clock_steps`.
    """
    nearest = _seconds_of(clocks_ns)
    for second in range(1, seconds + 1):
        if nearest.count(second) != 1:
            return second
    return 0 if any(not 1 <= second <= seconds for second in nearest) else None


def _seconds_of(clocks_ns: list[int]) -> list[int]:
    """Return the whole second that each message is nearest to, after it."""
    return [round(clock / SECOND - 0.25) for clock in clocks_ns]


def _moment_of(clocks_ns: list[int], second: int) -> int:
    """Return when a wrong second shows [ns]: at its second message, or when its first was due."""
    own = [clock for clock, near in zip(clocks_ns, _seconds_of(clocks_ns)) if near == second]
    return own[1] if len(own) > 1 else second * SECOND


def _once_per_second_in_wall_time(run: Run) -> None:
    # Code with its own loop keeps real time.
    refuse_own_clock(run, 'one message in every second of the ROS clock')
    times = [event['wall_s'] for event in readings(run)]
    if is_regular(run.recording, times, 1.0):
        return
    why = why_silent(run) if len(times) < 2 else None
    raise Failed(
        expected='one message a second',
        observed='another rhythm in the seconds of real time in which it was watched',
        why=why or OWN_LOOP,
    )


def names_the_unit(run: Run) -> None:
    """Every reading has the unit Celsius."""
    _all_equal(run, 'unit', 'Celsius')


def names_the_sensor(run: Run) -> None:
    """Every reading has the sensor id temp_sensor_01."""
    _all_equal(run, 'sensor_id', SENSOR)


def _all_equal(run: Run, field: str, wanted: str) -> None:
    others = {event['data'][field] for event in enough_readings(run)} - {wanted}
    if others:
        shown = ', '.join(repr(text[:40]) for text in sorted(others)[:3])
        near = any(text.strip().lower() == wanted.lower() for text in others)
        slip = 'Upper and lower case and spaces count.' if near else f'Another text is in {field}.'
        raise Failed(
            expected=f"{field} '{wanted}' in every message",
            observed=f'{field} {shown}',
            why=Cause('wrong_text', slip, f"Set msg.{field} = '{wanted}' before you publish."),
        )


def stamps_follow_the_clock(run: Run) -> None:
    """The timestamp of every reading is the node's own clock at that moment."""
    ticks = _ticks(run)
    for event in enough_readings(run):
        if event['clock_ns'] is None:
            continue  # sent before the clock started, by a loop of its own
        stamp = event['data']['timestamp']
        seconds = stamp['sec'] + stamp['nanosec'] / SECOND
        clock = event['clock_ns'] / SECOND
        stamp_ns = stamp['sec'] * SECOND + stamp['nanosec']
        if not _is_a_tick(run, ticks, stamp_ns, event['clock_ns']):
            raise Failed(
                expected=_wanted_stamp(run, seconds, clock),
                observed=_describe_stamp(run, seconds, clock),
                why=(
                    OWN_LOOP
                    if run.recording.in_wall_time and not run.recording.goes_on_alone
                    else _stamp_cause(run, seconds, clock, stamp)
                ),
            )


def _is_a_tick(run: Run, ticks: tuple[int, int], stamp_ns: int, clock_ns: int) -> bool:
    """
    Tell whether a stamp is what the node's clock showed when the reading was taken.

    The clock shows nothing between two ticks, so the stamp is a tick to the nanosecond: the last
    one, or the one before if the message came just after the next.

    :param ticks: from :func:`_ticks`
    """
    if run.recording.in_wall_time:
        return bool(0 <= clock_ns - stamp_ns <= 0.3 * SECOND)
    first_ns, step_ns = ticks
    if stamp_ns == 0:  # what the clock showed before its first tick
        return clock_ns <= first_ns
    on_grid = (stamp_ns - first_ns) % step_ns == 0
    # As old as a step of the exam: a timer may take a reading that another one publishes.
    oldest_ns = max(step_ns, round(run.facts['minute'].step_s * SECOND))
    return on_grid and 0 <= clock_ns - stamp_ns <= oldest_ns


def _ticks(run: Run) -> tuple[int, int]:
    """Return the first tick of the clock in this run, and the step to the next [ns]."""
    ticks = in_parts(run.facts['minute'], run.recording.divided).to_json()
    return int(ticks['first_ns']), int(ticks['step_ns'])


def _wanted_stamp(run: Run, seconds: float, clock: float) -> str:
    # Which reading is the first wrong one is chance where a program keeps its own time.
    if run.recording.in_wall_time or run.secret or seconds > 1e9:
        return 'a stamp of the simulated time of that reading'
    return f'a stamp near {clock:.1f} s, the simulated time of that reading'


def _describe_stamp(run: Run, seconds: float, clock: float) -> str:
    # Wall-clock values differ from run to run, so they are described and not shown.
    if seconds > 1e9:
        return "a stamp of this computer's own time of day"
    # The fraction of an older stamp is the moment at which our clock began.
    if run.secret and seconds % 1:
        return f'a stamp of {"an earlier" if seconds < clock else "a later"} moment'
    return f'a stamp of {seconds:.9g} s'


def _stamp_cause(run: Run, seconds: float, clock: float, stamp: dict[str, int]) -> Cause | None:
    right = 'Set msg.timestamp = self.get_clock().now().to_msg() in the callback.'
    if seconds == 0:
        return _why_zero(use_of_field(run.files, 'timestamp'), right)
    if seconds > 1e9:
        return Cause('wall_clock', 'The stamp comes from the system time.', right)
    if stamp['nanosec'] == 0 and stamp['sec'] == int(clock):
        return Cause('whole_seconds', 'The fraction of the second is lost.', right)
    return Cause('stale_stamp', 'The stamp is not taken at the moment of the reading.', right)


def _why_zero(code: FieldUse, right: str) -> Cause:
    """Explain a stamp of 0 by what the code does with the field."""
    if not code.given and code.local:
        return Cause(
            'missing_stamp',
            'The timestamp of the message is never set: timestamp alone is a variable of its own.',
            right,
        )
    if not code.given:
        return Cause('missing_stamp', 'The timestamp is never set.', right)
    if code.empty:
        return Cause('empty_time', 'An empty Time is 0: Time() asks no clock.', right)
    return Cause(
        'stale_stamp',
        'The stamp is 0: a time taken before the clock ran, as in __init__, or never set.',
        right,
    )


def readings_are_plausible(run: Run) -> None:
    """The readings are plausible temperatures, and they vary."""
    values = [float(event['data']['temperature_value']) for event in enough_readings(run)]
    # A formula that counts runs away with a flood: what it gives for those that were due, counts.
    due = int(run.facts['simulated_s'])
    first = values[:due] if is_flood(len(values), due) else values
    odd = [value for value in first if not COLDEST_C <= value <= HOTTEST_C]
    if odd:
        shown = f'{odd[0]:.4g}' if math.isfinite(odd[0]) else str(odd[0])
        raise Failed(
            expected=f'values from {COLDEST_C:g} to {HOTTEST_C:g} °C',
            observed=f'a reading of {shown} °C',
            why=Cause('implausible', 'No common sensor reads that.', 'Check your formula.'),
        )
    if len(set(values)) == 1:
        raise Failed(
            expected='readings that change from one to the next, as a real sensor has',
            observed=f'{values[0]:.4g} °C in all {len(values)} readings',
            why=_why_constant(run),
        )


def _why_constant(run: Run) -> Cause:
    """Explain a reading that is the same each time, by where the code seeds its random numbers."""
    if seed := seed_in_callback(run.files):
        return Cause(
            'seeded_each_time',
            f'{seed[:60]}() begins the random numbers anew with the same seed, so the first one '
            'of them comes each time.',
            'Seed once, in __init__() or above the class, and only draw in the callback.',
        )
    return Cause(
        'constant',
        'The value never changes.',
        'Compute it anew in the callback, not once in __init__(), and from something that changes '
        'from call to call, such as self.elapsed.',
    )


def offers_reliable_qos(run: Run) -> None:
    """Its quality of service is reliable and volatile, as depth 10 gives."""
    for end in run.recording.endpoints('publisher', TOPIC):
        qos = end['qos']
        if qos['reliability'] != 'RELIABLE':
            raise Failed(
                expected='reliability RELIABLE',
                observed=f'reliability {qos["reliability"]}',
                why=Cause(
                    'qos_reliability',
                    'A subscription that asks for reliable delivery is not connected to it.',
                    'Pass 10, or a QoSProfile with ReliabilityPolicy.RELIABLE.',
                ),
            )
        if qos['durability'] != 'VOLATILE':
            raise Failed(
                expected='durability VOLATILE',
                observed=f'durability {qos["durability"]}',
                why=Cause(
                    'qos_durability',
                    'Late subscribers would get old readings as if they were new.',
                    'Pass 10, or leave out the durability.',
                ),
            )


def build(seconds: int, phase_s: float) -> Exam:
    """
    Return the exam over some simulated time.

    :param seconds: simulated seconds, >= 5
    :param phase_s: first clock value, 0 < phase_s < 0.25 [s]
    """
    # Half a second more than whole, so that the last tick is due and no further one is.
    minute = Advance(seconds + 0.5, phase_s=phase_s)
    exam = Exam(
        'temperature_publisher',
        title='The temperature publisher',
        assignment='07_temperature_monitor',
        part=2,
        cells=('temperature_publisher',),
        requires=('temp_publisher.py',),
        scenario=Scenario(
            file='temp_publisher.py',
            watch={TOPIC: TYPE},
            steps=(minute,),
        ),
        read='Part 2: The publisher',
        facts={'simulated_s': seconds, 'minute': minute},
    )
    exam.check(points=2, read=EXERCISE)(starts_its_node)
    exam.check(points=2)(publishes_readings)
    for points, judge, read in (
        (3, publishes_once_per_second, 'lesson 02, When a timer ticks'),
        (1, names_the_unit, EXERCISE),
        (1, names_the_sensor, EXERCISE),
        (3, stamps_follow_the_clock, 'lesson 04, Part 4: Time'),
        (2, readings_are_plausible, ''),
        (1, offers_reliable_qos, 'lesson 05, Part 1: A profile'),
    ):
        exam.check(points=points, needs=['publishes_readings'], read=read)(judge)
    return exam


exam = build(seconds=10, phase_s=0.1)

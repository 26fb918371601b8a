"""
Lesson 07, part 2: the temperature publisher.

Specification from the lesson: node ``temperature_publisher``; one
``temp_monitor_pkg/msg/Temperature`` per second on ``temperature_topic``; unit ``Celsius``; sensor
id ``temp_sensor_01``; stamps from the node's clock; readings vary and stay between -40 and 125 °C
(the range of common digital sensors; a DS18B20 measures -55 to 125 °C); quality of service
reliable and volatile, which is the default with depth 10.

The exam tests the ROS clock: the program runs with ``use_sim_time``, and ROS time runs at a
different rate from system time.  So the rhythm and the stamps reveal a wrong clock.  The second
start has no ROS clock, so that a long time passes quickly.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
import math

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import RosClock, Scenario
from autograder.exam.steps import Advance, Mark, unheard
from autograder.exam.words import Causes
from autograder.judging.causes.ended import why_it_sleeps, why_silent
from autograder.judging.checks import counted, require_field, require_messages
from autograder.judging.claims import node, offers
from autograder.judging.rhythm import (
    GRAIN_S,
    is_far_too_many,
    why_disturbed,
    why_other_rhythm,
    why_paced,
    with_unheard,
)
from autograder.judging.stamps import require_stamps
from autograder.recording import Event, SECOND

NODE = '/temperature_publisher'
TOPIC = '/temperature_topic'
TYPE = 'temp_monitor_pkg/msg/Temperature'
SENSOR = 'temp_sensor_01'
COLDEST_C, HOTTEST_C = -40.0, 125.0
UNHEARD_S = 1.2  # at the start, without a subscription [s]
UNHEARD = 1 / 7  # share of the second half without a subscription
STEP_S = 0.1  # step of the ROS clock [s]; ten ticks of a 0.1 s timer take exactly one second
BEGINS_S = 1.0 + STEP_S  # limit for the first message, after the node is seen [s of ROS time]
EXERCISE = 'Exercise 2: the publisher node'

WHY = Causes(__file__, COLDEST_C=COLDEST_C, HOTTEST_C=HOTTEST_C)


def readings(run: Run) -> list[Event]:
    """Return the readings, in order."""
    return [event for event in run.recording.messages(TOPIC) if 'data' in event]


def enough_readings(run: Run) -> list[Event]:
    """Return the readings; fail if less than a quarter of those expected arrived."""
    found, due = readings(run), int(run.facts['seconds'])
    if len(found) < due // 4:
        raise Failed(
            expected=f'at least {due // 4} readings, because this check needs every reading',
            observed=f'only {counted(len(found), "reading")}',
            why=why_silent(run),
        )
    return found


def publishes_readings(run: Run) -> None:
    """It publishes Temperature messages on temperature_topic."""
    require_messages(run, readings(run), 1, f'messages of type {TYPE} on {TOPIC}', topic=TOPIC)


def publishes_once_per_second(run: Run) -> None:
    """It publishes once per second of the ROS clock, even while nothing subscribes."""
    seconds = int(run.facts['seconds'])
    minute = run.recording.phase('minute')
    found = with_unheard(run, minute.messages(TOPIC))
    right, wrong_ns = _seconds_in_rhythm(run, [event['clock_ns'] for event in found])
    if wrong_ns is None:
        return
    many = 'far more' if is_far_too_many(len(found), seconds) else len(found)
    raise Failed(
        expected=f'{seconds} messages in {seconds} s of ROS time, one in every second',
        observed=f'{many} messages; first difference in second {right + 1}',
        why=_why_wrong_rhythm(run, found),
        at=wrong_ns,
        every_s=1.0 / run.facts['clock'].rate,
    )


def _begin_ns(run: Run) -> int:
    """Return the virtual time at which the judged phase begins [ns]."""
    marks = run.recording.of('mark', name='minute')
    return int(marks[0]['clock_ns']) if marks else 0


def _seconds_in_rhythm(run: Run, found: list[int]) -> tuple[int, int | None]:
    """
    Return how many messages keep the rhythm, and the time of the first deviation [ns].

    The time is None without a deviation.  ROS time advances in steps, so a message may be one step
    early or late.

    :param found: virtual times of the messages [ns]
    """
    clock: RosClock = run.facts['clock']
    step_ns = round(clock.step_s * SECOND)
    end_ns = _begin_ns(run) + round(run.facts['seconds'] / clock.rate * SECOND)
    seen = run.recording.of('seen')
    due_ns = clock.at(seen[0]['clock_ns'] if seen else _begin_ns(run))
    if found and clock.at(found[0]) <= due_ns + BEGINS_S * SECOND:
        due_ns = clock.at(found[0])
    for number, moment_ns in enumerate(found):
        if abs(clock.at(moment_ns) - due_ns) > step_ns:
            return number, moment_ns
        due_ns += SECOND
    return len(found), end_ns if due_ns + step_ns < clock.at(end_ns) else None


def _why_wrong_rhythm(run: Run, found: Sequence[Event]) -> Cause | None:
    """Explain a wrong rhythm; a period of one second of virtual time means a different clock."""
    if why := why_silent(run):
        return why
    gaps = [later['clock_ns'] - earlier['clock_ns'] for earlier, later in pairwise(found)]
    if gaps and all(abs(gap / SECOND - 1.0) <= GRAIN_S for gap in gaps):
        return WHY['other_clock']
    clock: RosClock = run.facts['clock']
    if why := why_paced(run) or why_disturbed(run, found, 1.0 / clock.rate, True, 'message'):
        return why
    if 0 not in gaps and (sleeps := why_it_sleeps(run)):
        return sleeps
    # Start at the first message, so that a late start does not look like an early end.
    late_ns = found[0]['clock_ns'] - _begin_ns(run) if found else 0
    during_s = run.facts['seconds'] - late_ns / SECOND * clock.rate
    return why_other_rhythm(run, found, 1.0, during_s, rate=clock.rate, grain_s=clock.step_s)


def names_the_unit(run: Run) -> None:
    """Every reading has the unit Celsius."""
    require_field(run, enough_readings(run), 'unit', 'Celsius')


def names_the_sensor(run: Run) -> None:
    """Every reading has the sensor id temp_sensor_01."""
    require_field(run, enough_readings(run), 'sensor_id', SENSOR)


def stamps_follow_the_clock(run: Run) -> None:
    """The timestamp of every reading is the time of the node's own clock at that moment."""
    clock: RosClock = run.facts['clock']
    # A thread may read the clock just before the step that wakes it.
    step_ns = round(clock.step_s / clock.rate * SECOND)
    due = [(one, one['clock_ns'] - step_ns) for one in enough_readings(run)]
    require_stamps(run, (pair for pair in due if not _before_the_clock(run, pair[0])), clock)


def _before_the_clock(run: Run, reading: Event) -> bool:
    """Return whether a reading precedes the first ``/clock`` message and has the stamp 0."""
    stamp = reading['data']['timestamp']
    return reading['clock_ns'] < _begin_ns(run) and stamp['sec'] == stamp['nanosec'] == 0


def readings_are_plausible(run: Run) -> None:
    """The readings are plausible temperatures, and they vary."""
    values = [float(event['data']['temperature_value']) for event in enough_readings(run)]
    # If a node floods the topic, a value that grows with each message leaves the range: judge only
    # as many readings as expected.
    due = int(run.facts['warming_s'])
    first = values[:due] if is_far_too_many(len(values), due) else values
    odd = [value for value in first if not COLDEST_C <= value <= HOTTEST_C]
    for value in odd[:1]:
        raise WHY.failed('implausible' if math.isfinite(value) else 'not_finite', value=value)
    # Other checks report a node that ends during the first start, which is shorter.
    ended = run.recording.end_reason == 'student_exited'
    if ended and len(values) >= run.facts['seconds']:
        raise Failed(
            expected=f'{due} readings',
            observed=counted(len(values), 'reading'),
            why=why_silent(run),
        )
    if len(set(values)) == 1:
        raise WHY.failed('constant', value=values[0], count=len(values))


def build(seconds: int, begins_s: float, rate: float, warming_s: float) -> Exam:
    """
    Return the exam for a given duration.

    ROS time begins near 0, as in a simulation that starts with the program.

    :param seconds: ROS seconds, >= 5
    :param begins_s: first ROS time, > 0 and < STEP_S, so that no step falls on a whole second [s]
    :param rate: ROS seconds per second of system time, <= 0.85 or >= 1.15
    :param warming_s: duration of the second start, in which the simulated motor warms up [s]
    """
    clock, half_s = RosClock(begins_s, rate, STEP_S), seconds / rate / 2
    long = Scenario(file='temp_publisher.py', watch={TOPIC: TYPE}, steps=(Advance(warming_s),))
    exam = Exam(
        'temperature_publisher',
        title='The temperature publisher',
        assignment='07_temperature_monitor',
        part=2,
        scenario=replace(
            long,
            steps=(
                Mark('minute'),
                *unheard(TOPIC, UNHEARD_S),
                Advance(half_s - UNHEARD_S),
                # Long enough for a node that gives up after five readings without a subscription.
                *unheard(TOPIC, half_s * UNHEARD),
                Advance(half_s * (1 - UNHEARD)),
                Mark('over'),
            ),
            ros_clock=clock,
            again=long,
        ),
        read='Part 2: The publisher',
        facts={'seconds': seconds, 'clock': clock, 'warming_s': warming_s},
    )
    exam.check(points=2, read=EXERCISE)(node(NODE))
    exam.check(points=2)(publishes_readings)
    needs, part_2 = ['publishes_readings'], 'lesson 02, When a timer ticks'
    exam.check(points=3, needs=needs, read=part_2)(publishes_once_per_second)
    exam.check(points=1, needs=needs, read=EXERCISE)(names_the_unit)
    exam.check(points=1, needs=needs, read=EXERCISE)(names_the_sensor)
    exam.check(points=3, needs=needs, read='lesson 04, Part 4: Time')(stamps_follow_the_clock)
    exam.check(points=2, needs=needs, again=True)(readings_are_plausible)
    exam.check(points=1, needs=needs, read='lesson 05, Part 1: A profile')(
        offers(
            TOPIC,
            TYPE,
            'offers_reliable_qos',
            'Its quality of service is reliable and volatile, the default with depth 10.',
            reliability='RELIABLE',
            durability='VOLATILE',
        )
    )
    return exam


exam = build(seconds=10, begins_s=0.07, rate=1.25, warming_s=10.0)

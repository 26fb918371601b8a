"""
Lesson 07, part 3: the temperature subscriber.

The specification, as the lesson gives it: node ``temperature_subscriber`` listens on
``temperature_topic``; logs every reading in Celsius or Fahrenheit in one INFO line with its value
and none in an ERROR; logs exactly one WARN for each strictly above 30.0 °C; converts Fahrenheit;
answers any other unit with one ERROR and no warning; does not warn for NaN; uses its own logger.
"""

from __future__ import annotations

from collections.abc import Sequence
import math

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Feed, Scenario
from autograder.exams.reading_errors import (
    LOGGED_TWICE,
    NEEDLESS_ERROR,
    ONE_LINE,
    refuses_fahrenheit,
    why_burst_is_cut,
    why_conversion,
    why_fahrenheit_is_refused,
    why_nan,
    why_refused,
)
from autograder.exams.readings import (
    cool_groups,
    each_shown_twice,
    is_right,
    Reading,
    Sent,
    sent,
    share_of,
    shown_in,
    THRESHOLD_C,
)
from autograder.judging.causes.ended import why_silent
from autograder.judging.causes.missing_logs import (
    LEVELS,
    why_dropped,
    why_elsewhere,
    why_other_logger,
    why_printed,
)
from autograder.judging.causes.not_answering import nobody_answers
from autograder.judging.checks import require_endpoint, require_node, require_partner
from autograder.recording import ERROR, INFO, WARN

NODE = '/temperature_subscriber'
TOPIC = '/temperature_topic'
TYPE = 'temp_monitor_pkg/msg/Temperature'
REPEATED = Cause(
    'repeated_warning',
    'The same reading is warned about more than once.',
    'One call of self.get_logger().warning(...) in the callback, one subscription, and no timer '
    'or thread for it.',
)
NOT_LOGGED = Cause(
    'not_logged',
    'A reading is sent to your node, and no INFO line follows it.',
    'Call self.get_logger().info(...) first in the callback: before any if and any return.',
)
EXERCISE = 'Exercise 3: the subscriber node'


def starts_its_node(run: Run) -> None:
    """Your program starts a node called temperature_subscriber."""
    require_node(run, NODE)


def subscribes_to_readings(run: Run) -> None:
    """It subscribes to Temperature messages on temperature_topic and receives them."""
    ends = require_endpoint(run, 'subscription', TOPIC, TYPE)
    require_partner(ends)
    if run.recording.of('not_connected') or not run.recording.of('input'):
        asked = 'a deadline' if ends[0]['qos']['deadline_ns'] else 'a quality of service'
        why = why_silent(run) or Cause(
            'qos_incompatible',
            f'Your subscription asks for {asked} that the publisher does not promise.',
            'Pass the depth 10 as quality of service.',
        )
        raise Failed(
            expected=f'a subscription on {TOPIC} of type {TYPE}',
            observed='a subscription that gets nothing',
            why=why,
        )


def logs_every_reading(run: Run) -> None:
    """It logs every reading in one INFO line with its value, through the node's logger."""
    groups = sent(run)
    proper = [
        (reading, group) for group in groups for reading in group.readings if not reading.odd
    ]
    missing = [pair for pair in proper if not shown_in(pair[0], pair[1].logs, INFO)]
    if not missing and groups:
        if not each_shown_twice(groups):
            return
        raise Failed(
            expected='one INFO line with the value for each reading',
            observed='more than one such line for each of them',
            why=LOGGED_TWICE,
        )
    reading, group = missing[0] if missing else (None, None)
    found = len(proper) - len(missing)
    raise Failed(
        expected=f'{len(proper)} readings sent, each in one INFO line with its value',
        observed=f'{found} of them' + (f'; missing: {reading.kind}' if reading else ''),
        why=_why_not_logged(run, reading, group),
        share=share_of(run, found, len(proper)),
    )


def _why_not_logged(run: Run, reading: Reading | None, group: Sent | None) -> Cause | None:
    everything: Sequence[Reading] = (*run.facts['singles'], *run.facts['burst'])
    due = [reading] if reading else [one for one in everything if not one.odd]
    # With an INFO line after it, the line is not elsewhere: it lacks the value, or a burst is cut.
    why = (
        why_silent(run)
        if group is not None and group.count(INFO)
        else why_elsewhere(
            run, INFO, lambda text: any(shown_in(one, [{'text': text}], None) for one in due)
        )
    )
    if why or (group is not None and not group.sent):
        return why
    if group is not None and len(group.readings) > 1:
        return why_burst_is_cut(run)
    if reading is not None and group is not None:
        if refuses_fahrenheit(run, group):
            return why_fahrenheit_is_refused(run, group)
        if not group.count(INFO) and (refused := why_refused(run, [group])):
            return refused
        levels = [entry['level'] for entry in group.logs if shown_in(reading, [entry], None)]
        if levels:
            return Cause(
                'wrong_level',
                f'That reading is logged at level {LEVELS.get(levels[0], levels[0])} only.',
                'Log every reading with self.get_logger().info(...), the warm ones too.',
            )
        if any(entry['level'] == INFO for entry in group.logs):
            return Cause(
                'no_value',
                'There is an INFO line, but the value of the reading is not in it.',
                "Put msg.temperature_value into the text: f'{msg.temperature_value:.2f}'.",
            )
    return why_dropped(run, INFO) or NOT_LOGGED


def warns_when_too_hot(run: Run) -> None:
    """It logs exactly one WARN for each reading above 30 °C."""
    short, long = None, None
    groups = [group for group in sent(run) if any(one.hot for one in group.readings)]
    groups = [group for group in groups if all(one.unit == 'Celsius' for one in group.readings)]
    for group in groups:
        due, found = sum(one.hot for one in group.readings), group.count(WARN)
        short = short or (group if found < due else None)
        long = long or (group if found > due else None)
    worst = short or long
    if worst is None and groups:
        return
    if worst is None:
        raise Failed(
            expected='a warning for each reading above 30 °C',
            observed='the run ended before one was sent',
            why=why_silent(run),
        )
    due, found = sum(one.hot for one in worst.readings), worst.count(WARN)
    right = [group for group in groups if group.count(WARN) == sum(g.hot for g in group.readings)]
    raise Failed(
        expected=f'{_lines(due, "WARN")} after {_what(worst)}',
        observed=_lines(found, 'WARN') if worst.sent else 'the run ended before it was sent',
        share=share_of(run, len(right), len(groups)),
        why=_why_no_warning(run, worst, found > due),
    )


def _why_no_warning(run: Run, group: Sent, too_many: bool) -> Cause | None:
    why = why_silent(run)
    if why:
        return why
    if too_many and group.count(WARN) <= len(group.readings):
        return _why_false_alarm(run, group)
    shown = all(shown_in(one, group.logs, INFO) for one in group.readings)
    if not too_many and len(group.readings) > 1 and not shown:
        return why_burst_is_cut(run)
    if too_many:
        return REPEATED
    levels = {entry['level'] for entry in group.logs} - {INFO, WARN}
    if ERROR in levels and (refused := why_refused(run, cool_groups(run))):
        return refused
    if levels:
        return Cause(
            'wrong_level',
            f'A line at level {LEVELS.get(min(levels), min(levels))} comes instead.',
            'Use self.get_logger().warning(...).',
        )
    if run.recording.logs(level=WARN):
        return Cause(
            'missed_warning',
            'Other readings are warned about, this one is not.',
            'Compare each reading by itself: value > 30.0, without int(), round(), once= and '
            'without memory.',
        )
    logged = ''.join(entry['text'] for entry in run.recording.logs()).upper()
    printed = why_printed(run, WARN, lambda text: 'WARN' in text.upper())
    return (
        why_other_logger(run, WARN)
        or (printed if 'WARN' not in logged else None)
        or _never_warns(run)
    )


def stays_quiet_otherwise(run: Run) -> None:
    """It logs no warning for any other reading: 30.0 °C exactly is not above 30 °C."""
    groups = cool_groups(run)
    for group in groups:
        if group.count(WARN):
            raise Failed(
                expected=f'no WARN line after {_what(group)}',
                observed=_lines(group.count(WARN), 'WARN'),
                why=_why_false_alarm(run, group),
            )
    handled = [group for group in groups if group.logs]
    if len(handled) < len(groups):
        raise Failed(
            expected='INFO lines for cool readings and no warning',
            observed=f'{len(handled)} of {len(groups)} cool readings were handled: silence alone '
            'proves nothing',
            why=_why_not_logged(run, None, None),
            share=share_of(run, len(handled), len(groups)),
        )
    _can_warn(run)


def _can_warn(run: Run) -> None:
    """Fail unless some warning was logged: a node that never warns is not careful."""
    if not run.recording.logs(level=WARN):
        raise Failed(
            expected='warnings for hot readings and none for this',
            observed='no warning at all',
            why=why_silent(run) or _never_warns(run),
        )


def _never_warns(run: Run) -> Cause:
    return (
        why_refused(run, cool_groups(run))
        or why_dropped(run, WARN)
        or Cause(
            'no_warning',
            'No warning is ever logged.',
            'In the callback: if the value is above 30.0, call self.get_logger().warning(...).',
        )
    )


def _goes_on_warning(run: Run) -> bool:
    """Tell whether warnings go on in the end, when no reading is left to warn about."""
    last = sent(run)[-1]
    return last.count(WARN) > len(last.readings)


def _at_limit(group: Sent) -> bool:
    return any(one.value == THRESHOLD_C for one in group.readings)


def _why_false_alarm(run: Run, group: Sent) -> Cause | None:
    if _goes_on_warning(run):
        return REPEATED
    if _at_limit(group):
        return Cause(
            'warns_at_threshold',
            'The comparison includes 30.0 itself.',
            'Above means strictly greater: value > 30.0, not >=.',
        )
    return Cause(
        'false_alarm',
        'A reading that is not above 30 °C is warned about.',
        'Compare the value of this message with 30.0, without abs() and without memory.',
    )


def converts_fahrenheit(run: Run) -> None:
    """It understands readings in Fahrenheit: 86 °F is 30 °C."""
    groups = [
        group for group in sent(run) if any(one.unit == 'Fahrenheit' for one in group.readings)
    ]
    for group in groups:
        due, found = sum(one.hot for one in group.readings), group.count(WARN)
        if due != found:
            raise Failed(
                expected=f'{_lines(due, "WARN")} after {_what(group)}',
                observed=_lines(found, 'WARN'),
                why=_why_not_converted(run, group, found > due),
            )
    _was_listening(run, groups)


def _why_not_converted(run: Run, group: Sent, too_many: bool) -> Cause | None:
    if not too_many and refuses_fahrenheit(run, group):
        return why_silent(run) or why_fahrenheit_is_refused(run, group)
    # Without a conversion the usual Fahrenheit numbers are all above 30: too many warnings.
    if not too_many or group.count(WARN) > len(group.readings):
        converted = None if too_many else why_silent(run) or why_conversion(run, group)
        return converted or _why_no_warning(run, group, too_many)
    if alarms := [one for one in cool_groups(run) if one.count(WARN) and not _at_limit(one)]:
        return why_silent(run) or _why_false_alarm(run, alarms[0])
    return why_silent(run) or Cause(
        'ignores_unit',
        'The number is compared without conversion, or the conversion gives another number.',
        'Look at msg.unit first: celsius = (value - 32) / 1.8 for Fahrenheit.',
    )


def reports_an_unknown_unit(run: Run) -> None:
    """An unknown unit gives one ERROR line, a known unit none; no warning, and it goes on."""
    groups = [group for group in sent(run) if group.readings[0].celsius is None]
    for group in groups:
        if group.count(WARN) or group.count(ERROR) != 1:
            raise Failed(
                expected='1 ERROR line and no WARN line after a reading in an unknown unit',
                observed=f'{_lines(group.count(ERROR), "ERROR")}, '
                f'{_lines(group.count(WARN), "WARN")}',
                why=_why_unknown_unit(run, group),
            )
    right = [group for group in sent(run) if is_right(group)]
    # A node that takes a unit for an unknown one is told so where its warnings are missing.
    known = {one.unit for group in right for one in group.readings if one.hot}
    for group in right:
        if group.count(ERROR) and group.readings[0].unit in known:
            raise Failed(
                expected=f'no ERROR line after {_what(group)}',
                observed=_lines(group.count(ERROR), 'ERROR'),
                why=NEEDLESS_ERROR,
            )
    _was_listening(run, groups)


def _why_unknown_unit(run: Run, group: Sent) -> Cause | None:
    if group.count(ERROR) and not group.count(WARN):
        return ONE_LINE
    if _goes_on_warning(run):
        return REPEATED
    return (why_silent(run) if run.recording.logs() else why_elsewhere(run, ERROR)) or Cause(
        'unknown_unit',
        'A number without a known unit cannot be compared with 30 °C.',
        'For any unit that you do not know: self.get_logger().error(...), return.',
    )


def does_not_warn_about_nan(run: Run) -> None:
    """A reading that is not a number (NaN) brings no warning, and the node goes on."""
    groups = [group for group in sent(run) if math.isnan(group.readings[0].value)]
    for group in groups:
        if group.count(WARN):
            raise Failed(
                expected='no WARN line after NaN',
                observed=_lines(group.count(WARN), 'WARN'),
                why=REPEATED if _goes_on_warning(run) else why_nan(run),
            )
    _was_listening(run, groups)
    _can_warn(run)


def _was_listening(run: Run, groups: Sequence[Sent]) -> None:
    """Fail unless the odd reading was sent and a later, proper one was still handled."""
    everything = sent(run)
    goes_on = bool(everything[-1].logs) and not nobody_answers(run)
    if groups and everything[-1] not in groups and goes_on:
        return
    raise Failed(
        expected='a node that goes on after every reading',
        observed='no sign of life afterwards',
        why=_why_not_logged(run, None, None),
    )


def _what(group: Sent) -> str:
    if len(group.readings) > 1:
        return f'a burst of {len(group.readings)} readings'
    return group.readings[0].kind


def _lines(count: int, level: str) -> str:
    return f'{count or "no"} {level} line{"" if count == 1 else "s"}'


def build(singles: Sequence[Reading], burst: Sequence[Reading] = ()) -> Exam:
    """
    Return the exam for some readings.

    :param singles: sent one by one; the first and the last are cool and proper
    :param burst: sent at once at the end, Celsius only; at most five, so that the sensor-data
        profile's depth is enough
    """
    messages = [reading.message(number) for number, reading in enumerate((*singles, *burst))]
    steps = [Feed(TOPIC, messages[: len(singles)])]
    if burst:
        steps.append(Feed(TOPIC, messages[len(singles) :], burst=True))
    exam = Exam(
        'temperature_subscriber',
        title='The temperature subscriber',
        assignment='07_temperature_monitor',
        part=3,
        cells=('temperature_subscriber',),
        requires=('temp_subscriber.py',),
        scenario=Scenario(file='temp_subscriber.py', feed={TOPIC: TYPE}, steps=tuple(steps)),
        read='Part 3: The subscriber',
        facts={'singles': tuple(singles), 'burst': tuple(burst)},
    )
    exam.check(points=1, read=EXERCISE)(starts_its_node)
    exam.check(points=1)(subscribes_to_readings)
    for points, judge, read in (
        (3, logs_every_reading, EXERCISE),
        (3, warns_when_too_hot, ''),
        (3, stays_quiet_otherwise, ''),
        (2, converts_fahrenheit, ''),
        (1, reports_an_unknown_unit, EXERCISE),
        (1, does_not_warn_about_nan, ''),
    ):
        exam.check(points=points, needs=['subscribes_to_readings'], read=read)(judge)
    return exam


exam = build(
    [
        Reading(21.5, 'a reading of 21.5 °C'),
        Reading(99.0, 'a reading of 99.0 °C'),
        Reading(30.0, 'a reading of exactly 30.0 °C'),
        Reading(30.5, 'a reading of 30.5 °C'),
        Reading(-12.25, 'a reading of -12.25 °C'),
        Reading(70.0, 'a reading of 70.0 °F', 'Fahrenheit'),
        Reading(95.0, 'a reading of 95.0 °F', 'Fahrenheit'),
        Reading(300.0, 'a reading of 300 in the unknown unit Kelvinn', 'Kelvinn'),
        Reading(math.nan, 'a reading that is not a number'),
        Reading(24.75, 'a reading of 24.75 °C'),
    ]
)

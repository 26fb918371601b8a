"""
Lesson 07, part 3: the temperature subscriber.

Specification from the lesson: node ``temperature_subscriber`` subscribes to ``temperature_topic``;
logs each reading in Celsius or Fahrenheit in one INFO line with its value, and no ERROR line; logs
exactly one WARN for each reading strictly above 30.0 °C; converts Fahrenheit; logs one ERROR line
and no warning for any other unit; does not warn for NaN; uses its own logger.
"""

from collections.abc import Sequence
from dataclasses import replace
import math

from autograder.exam.exam import Cause, Exam, Failed, Run, Scenario
from autograder.exam.slips import NO_WARNING, REPEATED, SKIPS_EQUAL
from autograder.exam.specification import Specification
from autograder.exam.steps import feeds
from autograder.judging.causes.ended import (
    close_name,
    no_node_answered,
    while_running,
    why_silent,
)
from autograder.judging.causes.missing_logs import (
    lines_of_code,
    why_elsewhere,
    why_error_logged,
    why_exception_logged,
    why_left_out,
    why_not_logged,
)
from autograder.judging.checks import lines
from autograder.judging.claims import hears, node
from autograder.judging.log_rows import (
    Followed,
    followed,
    require_warnings,
    share,
    warn_lines,
    warnings_after,
)
from autograder.judging.numbers import shown
from autograder.recording import ERROR, Event, INFO, WARN
from autograder.submission.code.source_code import Code
from exams.readings import Reading, sensor_of, slips, warns, WHY

NODE = '/temperature_subscriber'
TOPIC = '/temperature_topic'
TYPE = 'temp_monitor_pkg/msg/Temperature'
EXERCISE = 'Exercise 3: the subscriber node'


def sent(run: Run, *kinds: str) -> list[Followed]:
    """
    Return single readings and the burst, sent or not, each with the log lines that follow.

    :param kinds: groups of readings, see :attr:`Reading.group`; by default all
    """
    found = followed(run, 'warnings', NODE)
    return [one for one in found if not kinds or one.inputs[0].group in kinds]


def logs_every_reading(run: Run) -> None:
    """It logs every reading in one INFO line with its value, through the node's logger."""
    groups = sent(run)
    proper = [(one, group) for group in groups for one in group.inputs if not one.odd]
    missing = [place for place, (one, group) in enumerate(proper) if not group.showing(one)]
    if missing:
        reading, group = proper[missing[0]]
        found = len(proper) - len(missing)
        row = next(place for place, one in enumerate(groups) if one is group)
        ended = ', which was not sent, because the run had ended' * (group.row is None)
        raise Failed(
            expected=f'one INFO line with its value for each of {len(proper)} finite readings in '
            '°C or °F',
            observed=f'INFO lines for {found} of {len(proper)} readings; missing: '
            f'{reading.kind}{ended}',
            why=_why_not_logged(
                while_running(run, run.asked('warnings'), row), proper, missing[0]
            ),
            place=row,
            shown_by=[line for line in group.logs if line['level'] == INFO],
            share=share(run, [one.row for one in groups], found, len(proper)),
        )
    # An occasional line, such as a new maximum or a conversion, may repeat the value of a reading.
    # A warning at the wrong level would be a second INFO line for a hot reading.
    plain = [one for one in sent(run, 'cool') if len(one.inputs) == 1]
    if plain and all(one.showing(one.inputs[0]) > 1 for one in plain):
        raise WHY.failed('logged_twice')


def _why_not_logged(
    run: Run, proper: Sequence[tuple[Reading, Followed]], place: int
) -> Cause | None:
    reading, group = proper[place]
    # If INFO lines follow all cool readings, do not search elsewhere: they lack the value, or the
    # node handled only part of a burst.
    often = all(one.count(INFO) for each, one in proper if not each.hot)
    elsewhere = None if often else why_elsewhere(run, INFO, reading.is_in)
    left_out = why_left_out(run, INFO, run.recording.logs(level=INFO))
    if why := why_silent(run) or left_out or elsewhere:
        return why
    if group.row is None:
        return None
    if len(group.inputs) > 1:
        return WHY['burst_is_cut']
    if group.count(INFO):
        came = [None if one.row is None else one.numbers(INFO) for _, one in proper]
        return run.asked('shown').cause(came, place) or WHY['no_value']
    warnings = [line for line in group.logs if line['level'] == WARN]
    if reading.hot and warnings:
        return replace(WHY['only_warned'], line=warnings[0].get('line'))
    before = sent(run)[: sent(run).index(group)][-1:]
    if any(one.showing(reading) and one.inputs == group.inputs for one in before):
        return SKIPS_EQUAL
    return (
        _why_unit_refused(run, group)
        or _why_other_sensor(run)
        or why_not_logged(run, group.row, INFO, reading.is_in)
        or _why_other_error(run, [group])
        or WHY['not_logged']
    )


def _why_other_sensor(run: Run) -> Cause | None:
    """Explain INFO lines that follow only the readings of some sensors."""
    shown: dict[bool, set[str]] = {True: set(), False: set()}
    pairs = ((one, group) for group in sent(run) for one in group.inputs)
    for number, (one, group) in enumerate(pairs):
        if group.row is not None and not one.odd:
            shown[group.showing(one) > 0].add(sensor_of(number))
    some = all(shown.values()) and shown[True].isdisjoint(shown[False])
    return WHY['other_sensor'] if some else None


def warns_when_too_hot(run: Run) -> None:
    """It logs exactly one WARN for each reading above 30 °C."""
    _require_warnings(run, 'hot', shared=True)


def stays_quiet_otherwise(run: Run) -> None:
    """It logs no warning for any other reading: 30.0 °C exactly is not above 30 °C."""
    _require_warnings(run, 'cool')
    groups, cool = sent(run), sent(run, 'cool')
    handled = [group for group in cool if group.logs]
    if len(handled) < len(cool):
        raise Failed(
            expected='INFO lines for cool readings and no warning',
            observed=f'only {len(handled)} of {len(cool)} cool readings have INFO lines, which '
            'show that your node received the reading',
            why=_why_deaf(run),
            share=share(run, [one.row for one in groups], len(handled), len(cool)),
        )
    _can_warn(run)


def converts_fahrenheit(run: Run) -> None:
    """It understands readings in Fahrenheit: 86 °F is 30 °C."""
    _require_warnings(run, 'Fahrenheit')
    _goes_on(run)


def does_not_warn_about_nan(run: Run) -> None:
    """It logs no warning for NaN (not a number), and keeps running."""
    _require_warnings(run, 'nan')
    _goes_on(run)
    _can_warn(run)


def _require_warnings(run: Run, kind: str, shared: bool = False) -> None:
    """Fail unless each reading of a group is followed by the expected number of warnings."""
    groups, asked = sent(run), run.asked('warnings')
    kinds = [group.inputs[0].group for group in groups]
    require_warnings(
        run,
        asked,
        [group.row for group in groups],
        [place for place, one in enumerate(kinds) if one == kind],
        [place for place, one in enumerate(kinds) if one in ('hot', 'cool')],
        lambda place: _why_no_warning(while_running(run, asked, place), groups[place]),
        shared,
    )


def _why_no_warning(run: Run, group: Followed) -> Cause | None:
    """Explain an expected warning that is missing or has a different form."""
    if why := _why_unit_refused(run, group):
        return why
    if len(group.inputs) > 1 and not all(map(group.showing, group.inputs)):
        return WHY['burst_is_cut']
    others = [line for line in group.logs if line['level'] not in (INFO, WARN)]
    if others or not run.recording.logs(level=WARN):
        return _why_none(run, others)
    return None


def _why_none(run: Run, instead: Sequence[Event] = ()) -> Cause | None:
    """Explain why no warning is logged, after one reading or at all."""
    return _why_other_error(run, sent(run, 'cool')) or why_not_logged(run, instead, WARN)


def _why_other_error(run: Run, groups: Sequence[Followed]) -> Cause | None:
    """Explain an ERROR line after a proper reading; return None if only its level is wrong."""
    found = [(group, line) for group in groups for line in group.logs if line['level'] == ERROR]
    if not found or (why := why_exception_logged(run, [found[0][1]])):
        return why if found else None
    text, reading = str(found[0][1]['text']), found[0][0].inputs[0]
    if reading.is_in(text) and 'unit' not in text.lower():
        return None
    of_unit = any(word in text.lower() for word in ('unit', reading.unit.lower()))
    return WHY['unit_text'] if of_unit else why_error_logged(run, text)


def _why_unit_refused(run: Run, group: Followed) -> Cause | None:
    """Explain an ERROR line for a reading in Fahrenheit if readings in Celsius cause none."""
    # A program that warns at the wrong level logs ERROR lines for warm readings in Celsius too.
    refused = group.inputs[0].unit == 'Fahrenheit' and group.count(ERROR)
    if not refused or any(one.count(ERROR) for one in sent(run, 'hot', 'cool')):
        return None
    if why := why_exception_logged(run, group.logs):
        return why
    written = close_name('Fahrenheit', Code(run.files).texts)
    if written in ('', 'Fahrenheit'):
        return WHY['fahrenheit_refused']
    hint = f"Your code has '{written}'; the unit is spelled 'Fahrenheit'."
    return replace(WHY['fahrenheit_refused'], try_this=hint)


def _can_warn(run: Run) -> None:
    """Fail unless the node logged at least one warning."""
    if not run.recording.logs(level=WARN):
        raise Failed(
            expected='warnings for hot readings, and only for these',
            observed='no warning at all',
            why=why_silent(run) or _why_none(run) or NO_WARNING,
        )


def reports_an_unknown_unit(run: Run) -> None:
    """For an unknown unit, it logs one ERROR, no WARN, and continues; otherwise no ERROR."""
    groups = sent(run)
    for group in sent(run, 'unknown'):
        if group.count(WARN) or group.count(ERROR) != 1:
            raise Failed(
                expected='1 ERROR line and no WARN line after a reading in an unknown unit',
                observed=f'{lines(group.count(ERROR), ERROR)}, {lines(group.count(WARN), WARN)}',
                why=_why_unknown_unit(run, group),
            )
    # If a node treats a known unit as unknown, the check of its warnings reports it.
    right = [group for group in groups if _is_right(group)]
    known = {one.unit for group in right for one in group.inputs if one.hot}
    for group in right:
        if group.count(ERROR) and group.inputs[0].unit in known:
            said = lines(group.count(ERROR), ERROR)
            raise WHY.failed('needless_error', kind=group.inputs[0].kind, lines=said)
    _goes_on(run)


def _is_right(group: Followed) -> bool:
    """Return whether the readings are proper, and their INFO and WARN lines as expected."""
    shown = all(not one.odd and group.showing(one) for one in group.inputs)
    return shown and group.count(WARN) == sum(one.hot for one in group.inputs)


def _why_unknown_unit(run: Run, group: Followed) -> Cause | None:
    if group.count(ERROR) and not group.count(WARN):
        return WHY['several_errors']
    groups, asked = sent(run), run.asked('warnings')
    if groups[-1].count(WARN) > len(groups[-1].inputs):
        return REPEATED
    then = while_running(run, asked, groups.index(group), not group.count(WARN))
    if why := why_silent(then) if run.recording.logs() else why_elsewhere(run, ERROR):
        return why
    if group.count(WARN):
        slip = asked.cause(warnings_after([one.row for one in groups]), groups.index(group))
        # Every unit that is unknown brings a warning, as after a hot reading, but from another
        # line of code: it is meant as the ERROR line.
        if (slip is None or slip.cause_id == 'keeps_last') and _warns_of_units(run):
            return why_not_logged(run, warn_lines([group.row]), ERROR)
        return slip or WHY['unknown_unit']
    before = [
        one for one in groups[: groups.index(group)] if one.inputs[0].unit == group.inputs[0].unit
    ]
    if any(one.count(ERROR) for one in before):
        return WHY['error_once']
    return why_left_out(run, ERROR, run.recording.logs(level=ERROR)) or WHY['no_error']


def _warns_of_units(run: Run) -> bool:
    """Return whether a line of code that logs no other warning warns of each unknown unit."""
    unknown, known = sent(run, 'unknown'), sent(run, 'hot', 'Fahrenheit')
    own, others = (lines_of_code(warn_lines(one.row for one in some)) for some in (unknown, known))
    each = all(one.count(WARN) and not one.count(ERROR) for one in unknown)
    return bool(own) and own.isdisjoint(others) and each


def _goes_on(run: Run) -> None:
    """Fail unless the node still logs the last reading and answers requests."""
    last = sent(run)[-1]
    if not last.logs or no_node_answered(run):
        raise Failed(
            expected='a node that keeps running after every reading',
            observed='no log line or no answer after the last reading',
            why=_why_deaf(run),
        )


def _why_deaf(run: Run) -> Cause | None:
    """Explain why a node does not log the readings that it receives."""
    proper = [one for one in run.asked('warnings').inputs if not one.odd]
    why = why_not_logged(run, [], INFO, lambda text: any(one.is_in(text) for one in proper))
    return _why_other_sensor(run) or why or WHY['not_logged']


def build(readings: Sequence[Reading], burst: int = 0) -> Exam:
    """
    Return the exam that sends the given readings.

    :param readings: the first and the last single reading are cool and proper
    :param burst: number of readings at the end that are sent at once: in Celsius, the first one
        hot
    """
    messages = [reading.message(number) for number, reading in enumerate(readings)]
    exam = Exam(
        'temperature_subscriber',
        title='The temperature subscriber',
        assignment='07_temperature_monitor',
        part=3,
        scenario=Scenario(
            file='temp_subscriber.py',
            feed={TOPIC: TYPE},
            steps=feeds(TOPIC, messages, burst),
        ),
        read='Part 3: The subscriber',
        asks={
            'warnings': Specification(readings, warns(), slips(burst), burst),
            'shown': shown([one for one in readings if not one.odd], lambda one: one.numbers),
        },
    )
    needs = ['subscribes_to_readings']
    exam.check(points=1, read=EXERCISE)(node(NODE))
    exam.check(points=1)(hears(TOPIC, TYPE, 'subscribes_to_readings'))
    exam.check(points=3, needs=needs, read=EXERCISE)(logs_every_reading)
    exam.check(points=3, needs=needs)(warns_when_too_hot)
    exam.check(points=3, needs=needs)(stays_quiet_otherwise)
    exam.check(points=2, needs=needs)(converts_fahrenheit)
    exam.check(points=1, needs=needs, read=EXERCISE)(reports_an_unknown_unit)
    exam.check(points=1, needs=needs)(does_not_warn_about_nan)
    return exam


exam = build(
    [
        Reading(21.5, 'a reading of 21.5 °C'),
        Reading(99.0, 'a reading of 99.0 °C'),
        Reading(30.5, 'a reading of 30.5 °C'),
        Reading(30.0, 'a reading of exactly 30.0 °C'),
        Reading(-42.25, 'a reading of -42.25 °C'),
        Reading(70.0, 'a reading of 70.0 °F', 'Fahrenheit'),
        Reading(95.0, 'a reading of 95.0 °F', 'Fahrenheit'),
        Reading(300.0, 'a reading of 300 in the unknown unit Kelvinn', 'Kelvinn'),
        Reading(math.nan, 'a reading that is not a number'),
        Reading(24.75, 'a reading of 24.75 °C'),
    ]
)

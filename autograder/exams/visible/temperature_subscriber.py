"""
Lesson 07, part 3: the temperature subscriber.

The specification, as the lesson gives it: node ``temperature_subscriber`` listens on
``temperature_topic``; logs every reading in Celsius or Fahrenheit in one INFO line with its value
and none in an ERROR; logs exactly one WARN for each strictly above 30.0 °C; converts Fahrenheit;
answers any other unit with one ERROR and no warning; does not warn for NaN; uses its own logger.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
import math
import operator

from autograder.exam.exam import Cause, Exam, Failed, Run
from autograder.exam.scenario import Feed, Scenario
from autograder.exam.slips import above_limit, Compare, NO_WARNING, of_nan, REPEATED, with_memory
from autograder.exam.specification import each, Rule, Slip, Specification
from autograder.exams.reading_errors import (
    BURST_IS_CUT,
    LOGGED_TWICE,
    NEEDLESS_ERROR,
    NO_ERROR,
    NO_VALUE,
    NOT_LOGGED,
    ONE_LINE,
    refuses_fahrenheit,
    UNKNOWN_UNIT,
    why_fahrenheit_is_refused,
    why_refused,
)
from autograder.exams.readings import (
    cool_groups,
    each_shown_twice,
    followed,
    is_right,
    Reading,
    Sent,
    sent,
    shown_in,
    THRESHOLD_C,
)
from autograder.judging.causes.ended import why_silent
from autograder.judging.causes.missing_logs import (
    LEVELS,
    why_dropped,
    why_elsewhere,
    why_left_out,
    why_other_logger,
    why_printed,
)
from autograder.judging.causes.not_answering import nobody_answers
from autograder.judging.claims import hears, node
from autograder.judging.rows import require_warnings, share
from autograder.recording import ERROR, INFO, WARN

NODE = '/temperature_subscriber'
TOPIC = '/temperature_topic'
TYPE = 'temp_monitor_pkg/msg/Temperature'
EXERCISE = 'Exercise 3: the subscriber node'


def warns(
    hot: Compare = operator.gt,
    celsius: Callable[[Reading], float | None] = lambda one: one.celsius,
) -> Rule:
    """Return how many warnings a monitor with these parts gives; by default those that are due."""

    def warnings(reading: Reading) -> int:
        value = celsius(reading)
        return int(value is not None and hot(value, THRESHOLD_C))

    return each(warnings)


def by_first_letter(reading: Reading) -> float | None:
    """Convert a reading by the first letter of its unit."""
    units = {unit[0]: unit for unit in ('Celsius', 'Fahrenheit')}
    return replace(reading, unit=units.get(reading.unit[:1], '')).celsius


def _whole_unit(unit: str) -> str:
    return next((one for one in ('Celsius', 'Fahrenheit') if unit in one), unit)


SLIPS = (
    *above_limit(warns, '30.0'),
    of_nan(warns, '30.0'),
    *(
        Slip(
            'ignores_unit',
            'The number is compared without conversion, or the conversion gives another number.',
            'Look at msg.unit first: celsius = (value - 32) / 1.8 for Fahrenheit.',
            warns(celsius=celsius),
        )
        for celsius in (
            lambda one: None if one.celsius is None else one.value,
            lambda one: one.value,
        )
    ),
    Slip(
        'wrong_conversion',
        'Warm readings in Celsius are warned about, a warm one in Fahrenheit is not: it is not '
        'compared, or its conversion gives too small a number.',
        'celsius = (value - 32) / 1.8, with / and not //. Try yours: 86 °F must give 30, and '
        '86.9 °F 30.5.',
        warns(celsius=lambda one: one.value if one.unit == 'Celsius' else None),
    ),
    Slip(
        'first_letter',
        'A unit that only begins like Celsius or Fahrenheit is taken for it.',
        "Compare the whole word: msg.unit == 'Celsius'.",
        warns(celsius=by_first_letter),
    ),
    Slip(
        'part_of_a_unit',
        'A unit that is empty, or only a part of the word, is taken for a known one.',
        "Compare it with ==, and not with in and a text: msg.unit == 'Celsius'.",
        warns(celsius=lambda one: replace(one, unit=_whole_unit(one.unit)).celsius),
    ),
    Slip(
        'any_case',
        'A unit in other letters, such as celsius, is taken for a known one.',
        "Compare it as it came, without lower() and upper(): msg.unit == 'Celsius'.",
        warns(celsius=lambda one: replace(one, unit=one.unit.capitalize()).celsius),
    ),
    Slip.of(
        UNKNOWN_UNIT,
        warns(celsius=lambda one: one.value if one.celsius is None else one.celsius),
    ),
    *with_memory(warns()),
    Slip.of(NO_WARNING, each(lambda one: 0)),
)


def logs_every_reading(run: Run) -> None:
    """It logs every reading in one INFO line with its value, through the node's logger."""
    groups = sent(run)
    proper = [
        (reading, group) for group in groups for reading in group.readings if not reading.odd
    ]
    missing = [pair for pair in proper if not shown_in(pair[0], pair[1].logs, INFO)]
    if not missing:
        if each_shown_twice(groups):
            raise Failed(
                expected='one INFO line with the value for each reading',
                observed='more than one such line for each of them',
                why=LOGGED_TWICE,
            )
        return
    found = len(proper) - len(missing)
    raise Failed(
        expected=f'{len(proper)} readings sent, each in one INFO line with its value',
        observed=f'{found} of them; missing: {missing[0][0].kind}',
        why=_why_not_logged(run, *missing[0]),
        share=share(run, followed(run), found, len(proper)),
    )


def _why_not_logged(run: Run, reading: Reading, group: Sent) -> Cause | None:
    # With an INFO line after it, the line is not elsewhere: it lacks the value, or a burst is cut.
    if why := why_silent(run) if group.count(INFO) else _why_all_elsewhere(run, [reading]):
        return why
    if not group.sent:
        return None
    if len(group.readings) > 1:
        return BURST_IS_CUT
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
    return NO_VALUE if group.count(INFO) else why_dropped(run, INFO) or NOT_LOGGED


def _why_all_elsewhere(run: Run, readings: Sequence[Reading]) -> Cause | None:
    """Explain INFO lines of readings that come on standard output only, or not at all."""
    return why_elsewhere(
        run, INFO, lambda text: any(shown_in(one, [{'text': text}], None) for one in readings)
    )


def warns_when_too_hot(run: Run) -> None:
    """It logs exactly one WARN for each reading above 30 °C."""
    _require_warnings(run, lambda group: group.all_in('Celsius') and group.due > 0, shared=True)


def stays_quiet_otherwise(run: Run) -> None:
    """It logs no warning for any other reading: 30.0 °C exactly is not above 30 °C."""
    groups = cool_groups(run)
    _require_warnings(run, groups.__contains__)
    handled = [group for group in groups if group.logs]
    if len(handled) < len(groups):
        raise Failed(
            expected='INFO lines for cool readings and no warning',
            observed=f'{len(handled)} of {len(groups)} cool readings were handled: silence alone '
            'proves nothing',
            why=_why_deaf(run),
            share=share(run, followed(run), len(handled), len(groups)),
        )
    _can_warn(run)


def converts_fahrenheit(run: Run) -> None:
    """It understands readings in Fahrenheit: 86 °F is 30 °C."""
    _require_warnings(run, lambda group: group.all_in('Fahrenheit'))
    _goes_on(run, lambda group: group.all_in('Fahrenheit'))


def _require_warnings(run: Run, picked: Callable[[Sent], bool], shared: bool = False) -> None:
    """
    Fail unless readings have as many warnings as they should have.

    :param picked: tells which readings the check is about
    :param shared: whether what is right earns a part of the points
    """
    groups = sent(run)
    places = [place for place, group in enumerate(groups) if picked(group)]
    celsius = [place for place, group in enumerate(groups) if group.all_in('Celsius')]
    require_warnings(
        run,
        run.facts['warnings'],
        followed(run),
        places,
        celsius,
        lambda place: _why_no_warning(run, groups[place]),
        shared,
    )


def _why_no_warning(run: Run, group: Sent) -> Cause | None:
    """Explain a warning that is due and that comes in another form, or nowhere at all."""
    if refuses_fahrenheit(run, group):
        return why_fahrenheit_is_refused(run, group)
    if len(group.readings) > 1 and not all(
        shown_in(one, group.logs, INFO) for one in group.readings
    ):
        return BURST_IS_CUT
    levels = {entry['level'] for entry in group.logs} - {INFO, WARN}
    if ERROR in levels and (refused := why_refused(run, cool_groups(run))):
        return refused
    if levels:
        return Cause(
            'wrong_level',
            f'A line at level {LEVELS.get(min(levels), min(levels))} comes instead.',
            'Use self.get_logger().warning(...).',
        )
    return None if run.recording.logs(level=WARN) else _why_never(run)


def _why_never(run: Run) -> Cause | None:
    """Explain that no warning is logged at all."""
    logged = ''.join(entry['text'] for entry in run.recording.logs()).upper()
    printed = why_printed(run, WARN, lambda text: 'WARN' in text.upper())
    return (
        why_other_logger(run, WARN)
        or (printed if 'WARN' not in logged else None)
        or why_refused(run, cool_groups(run))
        or why_dropped(run, WARN)
    )


def _can_warn(run: Run) -> None:
    """Fail unless some warning was logged: a node that never warns is not careful."""
    if not run.recording.logs(level=WARN):
        raise Failed(
            expected='warnings for hot readings and none for this',
            observed='no warning at all',
            why=why_silent(run) or _why_never(run) or NO_WARNING,
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
                expected=f'no ERROR line after {group.readings[0].kind}',
                observed=_lines(group.count(ERROR), 'ERROR'),
                why=NEEDLESS_ERROR,
            )
    _goes_on(run, groups.__contains__)


def _why_unknown_unit(run: Run, group: Sent) -> Cause | None:
    if group.count(ERROR) and not group.count(WARN):
        return ONE_LINE
    if sent(run)[-1].count(WARN) > len(sent(run)[-1].readings):
        return REPEATED
    asked: Specification = run.facts['warnings']
    groups = sent(run)
    came = [one.count(WARN) if one.sent else None for one in groups]
    if why := why_silent(run) if run.recording.logs() else why_elsewhere(run, ERROR):
        return why
    if group.count(WARN):
        return asked.cause(came, groups.index(group)) or UNKNOWN_UNIT
    return why_left_out(run, ERROR, run.recording.logs(level=ERROR)) or NO_ERROR


def does_not_warn_about_nan(run: Run) -> None:
    """A reading that is not a number (NaN) brings no warning, and the node goes on."""
    _require_warnings(run, _is_nan)
    _goes_on(run, _is_nan)
    _can_warn(run)


def _is_nan(group: Sent) -> bool:
    return math.isnan(group.readings[0].value)


def _goes_on(run: Run, picked: Callable[[Sent], bool]) -> None:
    """Fail unless the odd reading was sent and a later, proper one was still handled."""
    last = sent(run)[-1]
    if last.logs and not nobody_answers(run) and not picked(last):
        return
    raise Failed(
        expected='a node that goes on after every reading',
        observed='no sign of life afterwards',
        why=_why_deaf(run),
    )


def _why_deaf(run: Run) -> Cause | None:
    """Explain a node that does not log what it is sent."""
    everything = [one for group in sent(run) for one in group.readings if not one.odd]
    return _why_all_elsewhere(run, everything) or why_dropped(run, INFO) or NOT_LOGGED


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
        scenario=Scenario(file='temp_subscriber.py', feed={TOPIC: TYPE}, steps=tuple(steps)),
        read='Part 3: The subscriber',
        facts={'singles': tuple(singles), 'burst': tuple(burst)},
        asks={'warnings': Specification((*singles, *burst), warns(), SLIPS, len(burst))},
    )
    exam.check(points=1, read=EXERCISE)(node(NODE))
    exam.check(points=1)(
        hears(
            TOPIC,
            TYPE,
            'subscribes_to_readings',
        )
    )
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

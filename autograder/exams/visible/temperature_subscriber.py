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
from autograder.exams.readings import each_shown_twice, Reading, Sent, sent, THRESHOLD_C
from autograder.judging.causes.ended import close_name, why_silent
from autograder.judging.causes.logged_errors import why_error_logged, why_exception_logged
from autograder.judging.causes.missing_logs import (
    why_dropped,
    why_elsewhere,
    why_left_out,
    why_not_logged,
    why_other_logger,
    why_printed,
)
from autograder.judging.causes.not_answering import nobody_answers
from autograder.judging.checks import lines
from autograder.judging.claims import hears, node
from autograder.judging.rows import require_warnings, share, warnings_after
from autograder.recording import ERROR, INFO, WARN
from autograder.submission.code.learners_code import texts_in

NODE = '/temperature_subscriber'
TOPIC = '/temperature_topic'
TYPE = 'temp_monitor_pkg/msg/Temperature'
EXERCISE = 'Exercise 3: the subscriber node'


NO_UNIT = Cause(
    'unit_text',
    'Readings in Celsius are answered with an ERROR, as if nobody knew their unit.',
    "Compare with the whole words, letter by letter: msg.unit == 'Celsius', 'Fahrenheit'.",
)
ONE_LINE = Cause(
    'several_errors',
    'One reading in an unknown unit gives more than one ERROR line.',
    'Put all there is to say into one line, call self.get_logger().error(...) in one place, and '
    'subscribe once.',
)
NEEDLESS_ERROR = Cause(
    'needless_error',
    'A reading in a known unit is logged and judged as it should be, and gives an ERROR line too.',
    'ERROR is for a unit that you do not know: take that self.get_logger().error(...) out.',
)
LOGGED_TWICE = Cause(
    'logged_twice',
    'Each reading is in more than one INFO line with its value.',
    'Call self.get_logger().info(...) with the value once in the callback, and subscribe once.',
)
NOT_LOGGED = Cause(
    'not_logged',
    'A reading is sent to your node, and no INFO line follows it.',
    'Call self.get_logger().info(...) first in the callback: before any if and any return.',
)
NO_VALUE = Cause(
    'no_value',
    'There is an INFO line, but the value of the reading is not in it, or only without its '
    'decimals.',
    "Put msg.temperature_value into the text: f'{msg.temperature_value:.2f}'.",
)
NO_ERROR = Cause(
    'no_error',
    'A reading in an unknown unit gives no ERROR line.',
    'For any unit that you do not know: self.get_logger().error(...), return.',
)
UNKNOWN_UNIT = Cause(
    'unknown_unit',
    f'A number without a known unit cannot be compared with {THRESHOLD_C:g} °C.',
    'For any unit that you do not know: self.get_logger().error(...), return.',
)
BURST_IS_CUT = Cause(
    'burst_is_cut',
    'Readings that come one by one are answered, and of those that come at once only some.',
    'Is the depth of your subscription 10? If it is, your callback keeps only the newest: log and '
    'compare in the callback itself.',
)
FAHRENHEIT_REFUSED = Cause(
    'fahrenheit_refused',
    'Readings in Fahrenheit are answered with an ERROR, as if their unit were unknown.',
    "Add a branch for the whole word, letter by letter: if msg.unit == 'Fahrenheit', celsius = "
    '(value - 32) / 1.8.',
)


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
    *above_limit(warns, str(THRESHOLD_C)),
    of_nan(warns, str(THRESHOLD_C)),
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
    proper = [(one, group) for group in groups for one in group.readings if not one.odd]
    missing = [(reading, group) for reading, group in proper if not group.showing(reading)]
    found = len(proper) - len(missing)
    if missing:
        raise Failed(
            expected=f'{len(proper)} readings sent, each in one INFO line with its value',
            observed=f'{found} of them; missing: {missing[0][0].kind}',
            why=_why_not_logged(run, *missing[0]),
            share=share(run, [one.row for one in groups], found, len(proper)),
        )
    if each_shown_twice(groups):
        raise Failed(
            expected='one INFO line with the value for each reading',
            observed='more than one such line for each of them',
            why=LOGGED_TWICE,
        )


def _why_not_logged(run: Run, reading: Reading, group: Sent) -> Cause | None:
    # With an INFO line after it, the line is not elsewhere: it lacks the value, or a burst is cut.
    elsewhere = None if group.count(INFO) else why_elsewhere(run, INFO, reading.is_in)
    left_out = why_left_out(run, INFO, run.recording.logs(level=INFO))
    if why := why_silent(run) or left_out or elsewhere:
        return why
    if group.row is None:
        return None
    if len(group.readings) > 1:
        return BURST_IS_CUT
    if group.count(INFO):
        return NO_VALUE
    return (
        _why_unit_refused(run, group)
        or why_not_logged(run, group.row, INFO, reading.is_in)
        or _why_other_error(run, [group])
        or NOT_LOGGED
    )


def warns_when_too_hot(run: Run) -> None:
    """It logs exactly one WARN for each reading above 30 °C."""
    _require_warnings(run, lambda group: group.all_in('Celsius') and group.due > 0, shared=True)


def _is_cool(group: Sent) -> bool:
    """Return whether all are proper readings in Celsius that deserve no warning."""
    return group.all_in('Celsius') and not group.due


def stays_quiet_otherwise(run: Run) -> None:
    """It logs no warning for any other reading: 30.0 °C exactly is not above 30 °C."""
    _require_warnings(run, _is_cool)
    groups = sent(run)
    cool = [group for group in groups if _is_cool(group)]
    handled = [group for group in cool if group.logs]
    if len(handled) < len(cool):
        raise Failed(
            expected='INFO lines for cool readings and no warning',
            observed=f'{len(handled)} of {len(cool)} cool readings were handled: silence alone '
            'proves nothing',
            why=_why_deaf(run),
            share=share(run, [one.row for one in groups], len(handled), len(cool)),
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
    require_warnings(
        run,
        run.facts['warnings'],
        [group.row for group in groups],
        [place for place, group in enumerate(groups) if picked(group)],
        [place for place, group in enumerate(groups) if group.all_in('Celsius')],
        lambda place: _why_no_warning(run, groups[place]),
        shared,
    )


def _why_no_warning(run: Run, group: Sent) -> Cause | None:
    """Explain a warning that is due and that comes in another form, or nowhere at all."""
    if why := _why_unit_refused(run, group):
        return why
    if len(group.readings) > 1 and not all(map(group.showing, group.readings)):
        return BURST_IS_CUT
    others = [line for line in group.logs if line['level'] not in (INFO, WARN)]
    cool = [one for one in sent(run) if _is_cool(one)]
    if group.count(ERROR) and (why := _why_other_error(run, cool)):
        return why
    if others:
        return why_not_logged(run, others, WARN)
    return None if run.recording.logs(level=WARN) else _why_never(run)


def _why_never(run: Run) -> Cause | None:
    """Explain that no warning is logged at all."""
    logged = ''.join(entry['text'] for entry in run.recording.logs()).upper()
    printed = why_printed(run, WARN, lambda text: 'WARN' in text.upper())
    return (
        why_other_logger(run, WARN)
        or (printed if 'WARN' not in logged else None)
        or _why_other_error(run, [one for one in sent(run) if _is_cool(one)])
        or why_dropped(run, WARN)
    )


def _why_other_error(run: Run, groups: Sequence[Sent]) -> Cause | None:
    """
    Explain the ERROR line that answers a proper reading, None if it only has the wrong level.

    :param groups: of readings that deserve no ERROR
    """
    found = [(group, line) for group in groups for line in group.logs if line['level'] == ERROR]
    if not found or (why := why_exception_logged(run, [found[0][1]])):
        return why if found else None
    text, reading = str(found[0][1]['text']), found[0][0].readings[0]
    if 'unit' in text.lower():
        return NO_UNIT
    if reading.is_in(text):
        return None
    return NO_UNIT if reading.unit.lower() in text.lower() else why_error_logged(run, text)


def _why_unit_refused(run: Run, group: Sent) -> Cause | None:
    """Explain an ERROR line that answers a reading in Fahrenheit, where Celsius is understood."""
    # A program that warns at the wrong level has ERROR lines for warm readings in Celsius too.
    celsius = [one for one in sent(run) if one.readings[0].unit == 'Celsius']
    refused = group.readings[0].unit == 'Fahrenheit' and group.count(ERROR)
    if not refused or any(one.count(ERROR) for one in celsius):
        return None
    if why := why_exception_logged(run, group.logs):
        return why
    written = close_name('Fahrenheit', texts_in(run.files))
    if written in ('', 'Fahrenheit'):
        return FAHRENHEIT_REFUSED
    hint = f"Your code has '{written}'; the unit is 'Fahrenheit', letter by letter."
    return replace(FAHRENHEIT_REFUSED, try_this=hint)


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
    groups = sent(run)
    unknown = [group for group in groups if group.readings[0].celsius is None]
    for group in unknown:
        if group.count(WARN) or group.count(ERROR) != 1:
            raise Failed(
                expected='1 ERROR line and no WARN line after a reading in an unknown unit',
                observed=f'{lines(group.count(ERROR), ERROR)}, {lines(group.count(WARN), WARN)}',
                why=_why_unknown_unit(run, group),
            )
    # A node that takes a unit for an unknown one is told so where its warnings are missing.
    known = {one.unit for group in groups if group.right for one in group.readings if one.hot}
    for group in groups:
        if group.right and group.count(ERROR) and group.readings[0].unit in known:
            raise Failed(
                expected=f'no ERROR line after {group.readings[0].kind}',
                observed=lines(group.count(ERROR), ERROR),
                why=NEEDLESS_ERROR,
            )
    _goes_on(run, unknown.__contains__)


def _why_unknown_unit(run: Run, group: Sent) -> Cause | None:
    if group.count(ERROR) and not group.count(WARN):
        return ONE_LINE
    groups = sent(run)
    if groups[-1].count(WARN) > len(groups[-1].readings):
        return REPEATED
    if why := why_silent(run) if run.recording.logs() else why_elsewhere(run, ERROR):
        return why
    if group.count(WARN):
        came = warnings_after([one.row for one in groups])
        return run.facts['warnings'].cause(came, groups.index(group)) or UNKNOWN_UNIT
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
    if not last.logs or nobody_answers(run) or picked(last):
        raise Failed(
            expected='a node that goes on after every reading',
            observed='no sign of life afterwards',
            why=_why_deaf(run),
        )


def _why_deaf(run: Run) -> Cause | None:
    """Explain a node that does not log what it is sent."""
    proper = [one for group in sent(run) for one in group.readings if not one.odd]
    return (
        why_elsewhere(run, INFO, lambda text: any(one.is_in(text) for one in proper))
        or why_dropped(run, INFO)
        or NOT_LOGGED
    )


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

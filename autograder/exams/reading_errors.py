"""
Why a temperature monitor answers a reading with a line of the wrong level, with none or with two.

A monitor may not know the unit, or its code may have a mistake that an ``except`` turns into an
ERROR.  Only the text tells the two apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
import re

from autograder.exam.exam import Cause, Run
from autograder.exams.readings import Reading, Sent, sent, shown_in
from autograder.judging.causes.ended import close_name
from autograder.judging.causes.exceptions import exception_cause
from autograder.judging.causes.tracebacks import PUBLIC, Traceback
from autograder.recording import ERROR, Event
from autograder.submission.code.learners_code import texts_in

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
    'A number without a known unit cannot be compared with 30 °C.',
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
MOST_QUOTED = 120
_ATTRIBUTE = re.compile(r"'\w{1,40}' object has no attribute '\w{1,60}'")
_PYTHON = re.compile(
    r'has no attribute|is not defined|object is not|not supported between|unsupported operand|'
    r'positional argument|keyword argument|could not convert|can only concatenate|'
    r'not all arguments|not associated with a value|out of range|must be real|'
    r'[Dd]ivision by zero|format code|format string|'
    r'\b(?:Type|Name|Attribute|Key|Index|Assertion|UnboundLocal|ZeroDivision)Error\b'
)
"""What Python says of a mistake in code; ValueError is what the exercise itself raises."""


def why_refused(run: Run, groups: Sequence[Sent]) -> Cause | None:
    """
    Explain the ERROR line that answers a proper reading, None if it only has the wrong level.

    :param groups: of readings that deserve no ERROR
    """
    found = [
        (reading, entry)
        for group in groups
        for reading in group.readings
        for entry in group.logs
        if entry['level'] == ERROR
    ]
    if not found:
        return None
    reading, entry = found[0]
    text = str(entry['text'])
    attribute = _ATTRIBUTE.search(text)
    if attribute and quoted(run, attribute[0]) == attribute[0]:
        return exception_cause(Traceback(f'AttributeError: {attribute[0]}', '', None))
    if not _PYTHON.search(text):
        if 'unit' in text.lower():
            return NO_UNIT
        if shown_in(reading, [entry], None):
            return None
        if reading.unit.lower() in text.lower():
            return NO_UNIT
    return _logged(run, text)


def _logged(run: Run, text: str) -> Cause:
    return Cause(
        'logged_error',
        f"Your node logs this error: '{quoted(run, text)}'.",
        'If an except logs it, take try and except out for a moment: the traceback names the '
        'line. If not, which condition leads this reading to that line?',
    )


def quoted(run: Run, text: str) -> str:
    """Return what a node has logged, without the numbers and names that a hidden exam has sent."""
    text = ' '.join(text.split())
    if run.secret:
        sent: Sequence[Reading] = (*run.facts['singles'], *run.facts['burst'])
        for unit in {one.unit for one in sent} - {*PUBLIC, ''}:
            text = re.sub(re.escape(unit), '…', text, flags=re.IGNORECASE)
        text = re.sub(r'\d+(?:[.,]\d+)?', '…', text)
    return text if len(text) <= MOST_QUOTED else f'{text[:MOST_QUOTED]}…'


def refuses_fahrenheit(run: Run, group: Sent) -> bool:
    """Tell whether a reading in Fahrenheit is answered with an ERROR, and none in Celsius is."""
    if group.readings[0].unit != 'Fahrenheit' or not group.count(ERROR):
        return False
    # A program that warns at the wrong level has ERROR lines for warm readings in Celsius too.
    celsius = [one for one in sent(run) if one.readings[0].unit == 'Celsius']
    return not any(one.count(ERROR) for one in celsius)


def why_fahrenheit_is_refused(run: Run, group: Sent) -> Cause | None:
    """
    Explain an ERROR line that answers a reading in Fahrenheit, where Celsius is understood.

    :param group: of the reading
    """
    errors: list[Event] = [entry for entry in group.logs if entry['level'] == ERROR]
    if any(_PYTHON.search(str(entry['text'])) for entry in errors):
        return why_refused(run, [group])
    written = close_name('Fahrenheit', texts_in(run.files))
    if written in ('', 'Fahrenheit'):
        return FAHRENHEIT_REFUSED
    hint = f"Your code has '{written}'; the unit is 'Fahrenheit', letter by letter."
    return replace(FAHRENHEIT_REFUSED, try_this=hint)

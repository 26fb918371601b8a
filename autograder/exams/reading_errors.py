"""
Why a temperature monitor answers a reading with a line of the wrong level, with none or with two.

A monitor may not know the unit, or its code may have a mistake that an ``except`` turns into an
ERROR.  Only the text tells the two apart.
"""

from __future__ import annotations

from collections.abc import Sequence
import re

from autograder.exam.exam import Cause, Run
from autograder.exams.readings import Reading, Sent, sent, shown_in
from autograder.judging.causes.ended import close_name
from autograder.judging.causes.exceptions import exception_cause
from autograder.judging.causes.tracebacks import PUBLIC, Traceback
from autograder.recording import ERROR, Event, INFO, WARN
from autograder.submission.code.learners_code import calls, subscription_depths, texts_in

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
QUEUE_DEPTH = Cause(
    'queue_depth',
    'Readings that come at once are lost: the queue of your subscription is too short.',
    'Pass the depth 10 as quality of service.',
)
LONG_ENOUGH = 5
"""The depth at which nothing of a burst is lost; the sensor-data profile has it."""
MOST_QUOTED = 120
SHORT_NAMES = ('F', 'f', '°F', 'degF')
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
    code = '\n'.join(run.files.values())
    return Cause(
        'logged_error',
        f"Your node logs this error: '{quoted(run, text)}'.",
        'An except that only logs it hides the place: take try and except out for a moment, and '
        'the traceback names the line.'
        if 'except' in code
        else 'Find the line that logs it: which condition leads this reading there?',
    )


def quoted(run: Run, text: str) -> str:
    """Return what a node has logged, without the numbers and names that a hidden exam has sent."""
    text = ' '.join(text.split())
    if run.secret:
        sent: Sequence[Reading] = (*run.facts['singles'], *run.facts['burst'])
        for unit in {one.unit for one in sent} - set(PUBLIC):
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
    texts = {text for text in texts_in(run.files) if len(text) <= len('Fahrenheit') * 2}
    slip = close_name('Fahrenheit', texts) or next(
        (one for one in SHORT_NAMES if one in texts), ''
    )
    if 'Fahrenheit' in texts:
        hint = 'Which condition leads it to the line with error()? Put msg.unit into its text.'
    elif slip:
        hint = f"Your code has '{slip}'; the unit is 'Fahrenheit', letter by letter."
    else:
        hint = "Add a branch: if msg.unit == 'Fahrenheit', celsius = (value - 32) / 1.8."
    return Cause(
        'fahrenheit_refused',
        'Readings in Fahrenheit are answered with an ERROR, as if their unit were unknown.',
        hint,
    )


def why_conversion(run: Run, group: Sent) -> Cause | None:
    """
    Explain a warm reading in Fahrenheit without a warning, if all in Celsius are judged rightly.

    Then it is not the comparison that is wrong.

    :param group: of the reading, which has nothing but INFO lines
    """
    singles = [(one, *one.readings) for one in sent(run) if len(one.readings) == 1]
    right = all(
        one.count(WARN) == reading.hot
        for one, reading in singles
        if reading.unit == 'Celsius' and not reading.odd
    )
    if not (right and run.recording.logs(level=WARN)) or len(group.logs) > group.count(INFO):
        return None
    return Cause(
        'wrong_conversion',
        'Warm readings in Celsius are warned about, a warm one in Fahrenheit is not: it is not '
        'compared, or its conversion gives too small a number.',
        'celsius = (value - 32) / 1.8. Try yours: 86 °F must give 30, and 212 °F 100.',
    )


def why_nan(run: Run) -> Cause:
    """Explain a warning that comes for a reading that is not a number."""
    if calls(run.files, 'isnan') or calls(run.files, 'isfinite'):
        return Cause(
            'warns_of_nan',
            'A WARN line comes for NaN: WARN is for readings above 30 °C only.',
            'Use self.get_logger().info(...) there, as for every reading, or log nothing.',
        )
    return Cause(
        'nan',
        'NaN is not above 30, nor below: every comparison with it is false.',
        'Ask value > 30.0, not not (value <= 30.0); or test math.isnan(value).',
    )


def why_burst_is_cut(run: Run) -> Cause:
    """
    Explain readings that are answered one by one, and not all of them where they come at once.

    The queue is blamed only where the code says that it is too short.
    """
    depths = subscription_depths(run.files)
    if depths and all(depth is not None and depth < LONG_ENOUGH for depth in depths):
        return QUEUE_DEPTH
    known = depths and None not in depths
    return Cause(
        'burst_is_cut',
        'Readings that come one by one are answered, and of those that come at once only some.',
        f'{"" if known else "Is the depth of your subscription 10? "}'
        f'{"Perhaps" if known else "Or"} your callback keeps only the newest: log and compare in '
        'the callback itself.',
    )

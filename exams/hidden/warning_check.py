"""Hidden exam of lesson 11: secret runs of nodes with every slip, in a secret order."""

from dataclasses import replace

from autograder.exam.inputs import generator
from exams.hidden.temperature_subscriber import cool, edges, fahrenheit, hot, odd
from exams.readings import Reading
from exams.visible.warning_check import build, LAGS, made_run, MadeRun, NAN, WORDS

_draw = generator('warning_check', 'runs')


def _readings(letters: str) -> list[Reading]:
    """
    Return new readings in Celsius, one per letter.

    :param letters: ``h`` is above the limit, ``H`` repeats the previous reading, ``c`` is below
        the limit
    """
    found: list[Reading] = []
    for letter in letters:
        again = found[-1:] if letter == 'H' else []
        found += again or [hot(_draw) if letter == 'h' else cool(_draw)]
    return found


def _far() -> Reading:
    return Reading(round(_draw.uniform(200.0, 900.0), 1), 'a reading far above the limit')


AT_THE_LIMIT = Reading(86.0, 'a reading in Fahrenheit', 'Fahrenheit')
PLAIN, ROW, EDGES = 'readings in Celsius', 'warm readings in a row', 'readings next to the limit'
UNITS, ODD, BROKEN = 'readings in Fahrenheit', 'unknown units', 'a reading that is NaN'
MAKERS = {
    PLAIN: lambda: _readings('chchc'),
    ROW: lambda: _readings('chHhc'),
    EDGES: lambda: [*edges(_draw), *_readings('hc')],
    'no reading above the limit': lambda: _readings('cccc'),
    'warm readings only': lambda: _readings('hhhh'),
    'a warm reading at the end': lambda: _readings('cch'),
    'as many warm as cool readings': lambda: _readings('chhc'),
    'a reading far above the limit': lambda: [*_readings('c'), _far(), *_readings('hc')],
    UNITS: lambda: [*_readings('c'), *fahrenheit(_draw), AT_THE_LIMIT, *_readings('hc')],
    ODD: lambda: [*odd(_draw)[:-1], *_readings('hc')],
    BROKEN: lambda: [*_readings('h'), NAN, *_readings('hc')],
}
"""Functions that draw readings, by a description of these readings."""
SHOWN_BY = {
    PLAIN: ('no_warning', 'warns_ever_after', 'repeated_warning', 'one_late'),
    ROW: ('warns_once', 'warns_of_changes'),
    EDGES: ('warns_at_threshold', 'sign_ignored', 'cut_off'),
    'a warm reading at the end': ('repeated_warning',),
    'as many warm as cool readings': ('comparison_reversed',),
    'a reading far above the limit': ('upper_bound',),
    UNITS: ('ignores_unit', 'wrong_conversion'),
    ODD: ('unknown_unit', 'first_letter', 'part_of_a_unit', 'any_case'),
    BROKEN: ('nan',),
}
"""Names of a monitor's slips, by the readings that reveal them."""


def _run(kind: str, name: str, number: int) -> MadeRun:
    readings = MAKERS[kind]()
    steps_s = _draw.choices((0.5, 1.0, 1.5, 2.5), k=len(readings))
    return made_run(kind, readings, name, number % len(WORDS), steps_s)


_wanted = [(kind, '') for kind in MAKERS]
_wanted += [(kind, name) for kind, names in SHOWN_BY.items() for name in names]
_runs = [_run(kind, name, number) for number, (kind, name) in enumerate(_wanted)]
_runs += [replace(_run(PLAIN, '', 0), slip=LAGS, lag_s=0.2), _run(ODD, '', 3)]
_draw.shuffle(_runs)
# A check that never resets its state fails only after a wrong run, so begin with a correct one.
_right = next(place for place, run in enumerate(_runs) if run.slip is None)
_runs.insert(0, _runs.pop(_right))
exam = build(_runs)

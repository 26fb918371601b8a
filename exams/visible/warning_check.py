"""
Lesson 11: a check that accepts the runs of correct temperature monitors and refuses others.

The learner writes ``accepts(run)``, where ``run`` has the type that ``simulate()`` returns.  The
grader calls it with runs that it generates from the specification of the monitor in lesson 07 or
from one of its slips.  So the exam treats the check like any other program: its inputs are runs,
and the correct answer is True for a correct monitor and False for one with a slip.  A check can
have slips too: it compares too little, or it computes the expected warnings with one of the
monitor's mistakes.

No monitor runs: its specification, or a slip, determines what it logs after each reading.
"""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate
import json
import math
import operator

from autograder.errors import ExamInvalid
from autograder.exam.exam import Cause, Exam, Failed, Feed, Run, Scenario
from autograder.exam.specification import each, Rule, Slip, Specification
from autograder.exam.words import Causes
from autograder.judging.causes.ended import why_silent
from autograder.judging.causes.exceptions import exception_cause
from autograder.judging.causes.text_table import acts_by_cause
from autograder.judging.causes.tracebacks import traceback_of
from autograder.judging.claims import claim
from autograder.judging.rows import published
from autograder.simulated import LogRecord, Simulation, TopicRecord
from exams.readings import Reading, slips, warns

FILE = 'warning_check.py'
NO_ACCEPTS = "has no attribute 'accepts'"
RUNS, ANSWERS, TYPE = '/runs', '/answers', 'std_msgs/msg/String'
EXERCISE = 'Exercise 1: the check'
MONITOR, READINGS = 'temperature_subscriber', '/temperature_topic'
WORDS = (
    ('{:.2f} {} from temp_sensor_01', 'Too warm: {:.2f} {}'),
    ('Received temperature: {:.1f} {}', 'TEMPERATURE WARNING: {:.1f} {}'),
    ('Lectura de {:.3f} {}', 'Demasiado caliente'),
    ('', 'hot!'),
)
"""Log texts of different monitors at INFO and at WARN; the last one logs only WARN lines."""
NAN = Reading(math.nan, 'a reading that is not a number')

DUE = warns()
"""The rule of a correct monitor."""
OF_A_MONITOR = slips()
WHY = Causes(__file__)
LATE = WHY.slip('one_late', lambda readings: [0, *DUE(readings)[:-1]])
LAGS = WHY.slip('warns_later', DUE)
MISSES = ('no_warning', 'warns_once', 'warns_of_changes', 'upper_bound', 'cut_off')
UNITS = (
    *('ignores_unit', 'wrong_conversion', 'unknown_unit'),
    *('first_letter', 'part_of_a_unit', 'any_case'),
)
WRONG = (
    *('warns_at_threshold', 'comparison_reversed', 'sign_ignored', 'warns_ever_after'),
    *('repeated_warning', 'one_late', 'warns_later', 'nan'),
)
"""Names of slips that leave out a warning, misread a unit, or give a wrong warning."""
OWN = (
    *('warns_at_threshold', 'comparison_reversed', 'sign_ignored', 'upper_bound', 'cut_off'),
    *('nan', *UNITS),
)
"""Names of slips that a check itself may contain when it computes the expected warnings."""

BY_READING = 'For each reading, compare the warnings at its time with the expected ones.'
UNHELPFUL = ('exception', 'assertion')
"""Causes whose text is about a node that ended with an exception."""
OTHER_FIXES = {'unknown_unit': 'Expect no warning for a unit other than Celsius and Fahrenheit.'}


@dataclass(frozen=True)
class MadeRun:
    """
    The log of a correct monitor, or of one with a slip, for some readings.

    :param kind: description of the readings that feedback may show
    :param readings: in the order in which they are sent
    :param answers: number of WARN lines after each reading
    :param slip: the monitor's mistake, None for a correct monitor
    :param steps_s: time before each reading [s]
    :param words: index of the monitor's log texts in :data:`WORDS`
    :param lag_s: time from a reading to its WARN lines [s]
    """

    kind: str
    readings: Sequence[Reading]
    answers: Sequence[int]
    slip: Slip | None
    steps_s: Sequence[float]
    words: int
    lag_s: float = 0.0

    @property
    def simulation(self) -> Simulation:
        """Return the run in the form that ``simulate()`` returns."""
        times = [sum(self.steps_s[: place + 1]) for place in range(len(self.readings))]
        seconds = times[-1] + 1.0
        data = tuple(one.message(number) for number, one in enumerate(self.readings))
        kind = 'temp_monitor_pkg/msg/Temperature'
        sent = TopicRecord(f'{READINGS} (input)', kind, tuple(times), data, seconds)
        logs = [
            LogRecord(time + self.lag_s * (level == 'WARN'), level, MONITOR, text)
            for time, reading, count in zip(times, self.readings, self.answers)
            for level, text in self._lines(reading, count)
        ]
        return Simulation('monitor.py', {}, {}, {READINGS: sent}, tuple(logs), 'complete', seconds)

    def _lines(self, reading: Reading, count: int) -> list[tuple[str, str]]:
        info, warning = (one.format(reading.value, reading.unit) for one in WORDS[self.words])
        refused = info and reading.celsius is None and not count
        lines = [('INFO', info)] if info else []
        lines += [('ERROR', f'Unknown unit {reading.unit!r}')] if refused else []
        return lines + [('WARN', warning)] * count


def made_run(
    kind: str,
    readings: Sequence[Reading],
    name: str = '',
    words: int = 0,
    steps_s: Sequence[float] = (),
) -> MadeRun:
    """
    Return the run of a monitor.

    :param name: the monitor's slip, empty for a correct monitor; the other parameters are fields
        of :class:`MadeRun`
    :param steps_s: by default 1 s
    :raises ExamInvalid: if the readings do not reveal the slip
    """
    due = list(DUE(readings))
    slip, answers = of_monitor(name, readings) if name else (None, due)
    return MadeRun(kind, readings, answers, slip, steps_s or [1.0] * len(readings), words)


def of_monitor(name: str, readings: Sequence[Reading]) -> tuple[Slip, list[int]]:
    """Return the first slip with a given name that the readings reveal, and its answers."""
    due = list(DUE(readings))
    for slip in (*OF_A_MONITOR, LATE):
        for rule in slip.rules if slip.cause_id == name else ():
            if (answers := list(rule(readings))) != due:
                return slip, answers
    raise ExamInvalid(f'The readings {readings} do not reveal a slip {name}.')


def _of_a_node(slip: Slip) -> str:
    """Return what a slip says to the author of a node, as a sentence about this node."""
    return slip.text.replace('Your node', 'It').replace('your node', 'it')


def celsius(*values: float) -> list[Reading]:
    """Return readings in Celsius."""
    return [Reading(value, 'a reading in Celsius') for value in values]


def fahrenheit(*values: float) -> list[Reading]:
    """Return readings in Fahrenheit."""
    return [Reading(value, 'a reading in Fahrenheit', 'Fahrenheit') for value in values]


def compares(like: Callable[[int, int], bool] = operator.eq, due: Rule = DUE) -> Rule:
    """Return the rule of a check that compares actual and expected warnings per reading."""
    return each(lambda run: not run.lag_s and all(map(like, run.answers, due(run.readings))))


def compares_first(run: MadeRun) -> bool:
    """Return the answer of a check that compares only as many warnings as are due."""
    warned, due = (
        [place for place, count in enumerate(counts) for _ in range(count)]
        for counts in (run.answers, DUE(run.readings))
    )
    return not run.lag_s and all(map(operator.eq, warned, due))


SLIPS = (
    WHY.slip('accepts_all', each(lambda run: True)),
    WHY.slip('refuses_all', each(lambda run: False)),
    WHY.slip(
        'keeps_lists',
        lambda runs: list(accumulate((run.slip is None for run in runs), operator.and_)),
    ),
    WHY.slip('counts_only', each(lambda run: sum(run.answers) == sum(DUE(run.readings)))),
    WHY.slip('any_warning', each(lambda run: any(run.answers) == any(DUE(run.readings)))),
    WHY.slip('no_needless', compares(operator.ge)),
    WHY.slip('no_missing', compares(operator.le)),
    WHY.slip('tolerant', each(lambda run: list(run.answers) == list(DUE(run.readings)))),
    WHY.slip('ends_early', each(compares_first)),
    WHY.slip('repeats', compares(lambda count, due: bool(count) == bool(due))),
    *(
        Slip(
            f'check_{slip.cause_id}',
            f'Your check expects the warnings of a node with this mistake: {_of_a_node(slip)}',
            OTHER_FIXES.get(slip.cause_id, slip.try_this),
            *(compares(due=rule) for rule in slip.rules),
            act=slip.act or acts_by_cause().get(slip.cause_id, ''),
        )
        for slip in OF_A_MONITOR
        if slip.cause_id in OWN
    ),
)


def answers_of(run: Run) -> list[bool | str]:
    """Return the answer to each run; answers other than True and False as a string."""
    rows = published(run, 'answers', ANSWERS)
    truth: dict[str, bool | str] = {'True': True, 'False': False, '': 'no answer'}
    # Any other text might contain parts of a hidden run.
    words = [
        [one if str(one).isidentifier() else 'other text' for one in row or ()] for row in rows
    ]
    return [truth.get(one, one) for one in map(', '.join, words)]


def returns_true_or_false(run: Run) -> None:
    """Your file has a function accepts(run), which returns True or False."""
    came = answers_of(run)
    if not any(isinstance(one, bool) for one in came):
        raise Failed(
            expected='True or False for a run',
            observed=f'{came[0]} for {_name(run, 0)}',
            why=_why_no_answer(run, str(came[0])),
        )


def _why_no_answer(run: Run, text: str) -> Cause | None:
    trace = traceback_of(run)
    if text == 'exception' and trace:
        why = exception_cause(trace)
        helpful = why.cause_id not in UNHELPFUL
        return why if helpful else replace(WHY['raises'], line=trace.place)
    if NO_ACCEPTS in str(run.recording.process.get('stderr', '')):
        return WHY['no_accepts']
    if text == 'no answer':
        return why_silent(run)
    return WHY['no_return'] if text == 'NoneType' else WHY['no_boolean']


def _name(run: Run, place: int) -> str:
    """Return a description of a run; its number is shown only if learners can look at the run."""
    made: MadeRun = run.facts['answers'].inputs[place]
    return f'a run with {made.kind}' if run.secret else f'run {place + 1}, with {made.kind}'


def _require(run: Run, places: Collection[int], due: bool) -> None:
    """
    Fail unless the runs get the right answer, and most other runs get the opposite answer.

    Runs of correct nodes give all points or none; each run of a wrong node gives a part of them.

    :param places: indices of the runs
    :param due: the right answer for these runs
    """
    asked, came = run.facts['answers'], answers_of(run)
    wrong = asked.wrong(came, places)
    others = [place for place, one in enumerate(asked.answers) if one != due]
    known = len(others) - len(asked.wrong(came, others))
    one_sided = 2 * known < len(others)
    if wrong:
        right = len(places) - len(wrong)
        raise Failed(
            expected=f'{due} for {len(places)} runs of {"correct" if due else "wrong"} nodes',
            observed=f'{due} for {right} of {len(places)} runs; not for {_name(run, wrong[0])}',
            why=_why(run, asked, came, wrong[0]),
            share=0.0 if due or one_sided else round(right / len(places), 2),
        )
    if one_sided:
        kind, count = 'wrong' if due else 'correct', len(others)
        raise WHY.failed('one_sided', due=due, other=not due, kind=kind, right=known, count=count)


def _why(run: Run, asked: Specification, came: Sequence[bool | str], place: int) -> Cause | None:
    """Explain what the node of a run does and, if known, why the check misjudges it."""
    answer = came[place]
    if isinstance(answer, str):
        return _why_no_answer(run, answer)
    slip: Slip | None = asked.inputs[place].slip
    own = asked.cause(came, place)
    if slip is None:
        return own or WHY['refuses_right']
    does = f'The node of this run is wrong. {_of_a_node(slip)}'
    if own is None:
        return Cause(f'accepts_{slip.cause_id}', does, BY_READING)
    more = '' if own.cause_id == f'check_{slip.cause_id}' else f' {does}'
    return Cause(own.cause_id, f'{own.text}{more}', own.try_this, act=own.act)


def build(runs: Sequence[MadeRun]) -> Exam:
    """Return the exam for some runs, in the order in which they are sent."""
    messages = [{'data': json.dumps(one.simulation.to_json())} for one in runs]
    exam = Exam(
        'warning_check',
        title='A check of recorded runs',
        assignment='11_testing',
        part=1,
        scenario=Scenario(
            program='check',
            file=FILE,
            watch={ANSWERS: TYPE},
            feed={RUNS: TYPE},
            steps=(Feed(RUNS, messages),),
        ),
        read=EXERCISE,
        facts={'runs': [one.simulation for one in runs]},
        asks={'answers': Specification(runs, each(lambda run: run.slip is None), SLIPS)},
    )
    right = [place for place, one in enumerate(runs) if one.slip is None]
    named = {place: one.slip.cause_id for place, one in enumerate(runs) if one.slip}
    if unknown := sorted({*named.values()} - {*MISSES, *UNITS, *WRONG}):
        raise ExamInvalid(
            f'warning_check: no check refuses a run with the slip {unknown[0]}.',
            'Try: add its name to MISSES, UNITS or WRONG',
        )
    missing, units, other = (
        [place for place, name in named.items() if name in names]
        for names in (MISSES, UNITS, WRONG)
    )
    exam.check(points=1)(returns_true_or_false)
    for points, name, places, sentence in (
        (4, 'accepts_right_nodes', right, 'It accepts each run of a correct node.'),
        (2, 'refuses_missing_warnings', missing, 'It refuses a run that lacks a warning.'),
        (3, 'refuses_other_warnings', other, 'It refuses a run with a wrong warning.'),
        (2, 'refuses_wrong_units', units, 'It refuses a run whose node misreads a unit.'),
    ):
        judged = claim(name, sentence, partial(_require, places=places, due=places is right))
        exam.check(points=points, needs=['returns_true_or_false'])(judged)
    return exam


_UNKNOWN = Reading(300.0, 'a reading in the unit Kelvin', 'Kelvin')
exam = build(
    [
        made_run('readings in Celsius', celsius(21.5, 31.0, 25.0, 30.2, 22.0)),
        made_run(
            'readings at the limit', celsius(28.0, 30.0, 32.0, 30.0, 29.0), 'warns_at_threshold'
        ),
        made_run(
            'warm readings in a row', celsius(25.0, 31.0, 33.0, 36.0, 28.0), 'warns_of_changes', 1
        ),
        made_run('no reading above 30 °C', celsius(12.0, 30.0, 29.9, -35.0, 18.0), words=1),
        made_run('readings in Celsius', celsius(22.0, 34.0, 26.0, 32.0, 27.0), 'one_late'),
        made_run(
            'readings in Fahrenheit', fahrenheit(70.0, 95.0, 86.0, 88.0) + celsius(31.0), words=2
        ),
        made_run('readings in Fahrenheit', fahrenheit(70.0, 50.0, 95.0, 20.0), 'ignores_unit', 3),
        made_run(
            'an unknown unit and NaN', [*celsius(35.0), _UNKNOWN, NAN, *celsius(31.0)], words=2
        ),
        made_run('a reading that is NaN', [*celsius(35.0), NAN, *celsius(24.0)], 'nan'),
        made_run(
            'a reading in an unknown unit', [_UNKNOWN, *celsius(20.0, 32.0)], 'unknown_unit', 1
        ),
        made_run('readings in Celsius', celsius(24.0, 38.0, 41.0, 26.0), 'no_warning', 2),
        made_run('readings in Celsius', celsius(24.0, 33.0, 26.0), 'repeated_warning', 3),
    ]
)

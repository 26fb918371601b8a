"""
Build recorded runs of correct and wrong temperature monitors from the specification of lesson 07.

No program runs: the specification, or a slip, determines what a monitor logs after each reading.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
import math

from autograder.errors import ExamInvalid
from autograder.exam.specification import Rule, Slip
from autograder.exams.readings import Reading
from autograder.simulated import LogRecord, Simulation, TopicRecord

NODE = 'temperature_subscriber'
TOPIC = '/temperature_topic'
TYPE = 'temp_monitor_pkg/msg/Temperature'
WORDS = (
    ('{:.2f} {} from temp_sensor_01', 'Too warm: {:.2f} {}'),
    ('Received temperature: {:.1f} {}', 'TEMPERATURE WARNING: {:.1f} {}'),
    ('Lectura de {:.3f} {}', 'Demasiado caliente'),
    ('', 'hot!'),
)
"""Log texts of different monitors at INFO and at WARN; the last one logs only WARN lines."""


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
        sent = TopicRecord(f'{TOPIC} (input)', TYPE, tuple(times), data, seconds)
        logs = [
            LogRecord(time + self.lag_s * (level == 'WARN'), level, NODE, text)
            for time, reading, count in zip(times, self.readings, self.answers)
            for level, text in self._lines(reading, count)
        ]
        return Simulation('monitor.py', {}, {}, {TOPIC: sent}, tuple(logs), 'complete', seconds)

    def _lines(self, reading: Reading, count: int) -> list[tuple[str, str]]:
        info, warning = (one.format(reading.value, reading.unit) for one in WORDS[self.words])
        refused = info and reading.celsius is None and not count
        lines = [('INFO', info)] if info else []
        lines += [('ERROR', f'Unknown unit {reading.unit!r}')] if refused else []
        return lines + [('WARN', warning)] * count


def made_run(
    kind: str,
    readings: Sequence[Reading],
    due: Rule,
    slip: Slip | None = None,
    words: int = 0,
    steps_s: Sequence[float] = (),
) -> MadeRun:
    """
    Return the run of a monitor.

    :param due: rule of a correct monitor; for the other parameters see :class:`MadeRun`
    :param steps_s: by default 1 s
    :raises ExamInvalid: if the readings do not reveal the mistake
    """
    right = list(due(readings))
    forms = [list(rule(readings)) for rule in slip.rules] if slip else [right]
    answers = next((one for one in forms if not slip or one != right), None)
    if slip and answers is None:
        raise ExamInvalid(f'The run with {kind} does not show the slip {slip.cause_id}.')
    return MadeRun(kind, readings, answers or right, slip, steps_s or [1.0] * len(readings), words)


def celsius(*values: float) -> list[Reading]:
    """Return readings in Celsius."""
    return [Reading(value, 'a reading in Celsius') for value in values]


def fahrenheit(*values: float) -> list[Reading]:
    """Return readings in Fahrenheit."""
    return [Reading(value, 'a reading in Fahrenheit', 'Fahrenheit') for value in values]


NAN = Reading(math.nan, 'a reading that is not a number')

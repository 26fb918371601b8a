"""
Readings that an exam sends to a temperature monitor, and the log lines that followed each.

Data and pairing only; what is right and why it is not is in the exam ``temperature_subscriber``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Any

from autograder.exam.exam import Run
from autograder.judging.numbers import shows
from autograder.judging.rows import Row, rows
from autograder.recording import Event, INFO, WARN

THRESHOLD_C = 30.0


@dataclass(frozen=True)
class Reading:
    """
    One message that the probe sends.

    :param kind: what it tries, in words that may be shown; never the value of a hidden one
    """

    value: float
    kind: str
    unit: str = 'Celsius'

    @property
    def celsius(self) -> float | None:
        """Return the value in degrees Celsius, None for a unit nobody has heard of."""
        if self.unit == 'Celsius':
            return self.value
        return (self.value - 32.0) / 1.8 if self.unit == 'Fahrenheit' else None

    @property
    def hot(self) -> bool:
        """Tell whether a warning is due: strictly above the threshold."""
        return self.celsius is not None and self.celsius > THRESHOLD_C

    @property
    def odd(self) -> bool:
        """Tell whether it is no proper temperature."""
        return self.celsius is None or math.isnan(self.celsius)

    def message(self, number: int) -> dict[str, Any]:
        """Return the fields that are sent."""
        value: float | str = str(self.value) if math.isnan(self.value) else self.value
        stamp = {'sec': 100 + number, 'nanosec': 250_000_000}
        return {
            'temperature_value': value,
            'unit': self.unit,
            'timestamp': stamp,
            'sensor_id': 'temp_sensor_01',
        }


@dataclass(frozen=True)
class Sent:
    """
    Readings that go together, and the log lines that followed them.

    :param sent: False if the run ended before; then nothing followed
    """

    readings: tuple[Reading, ...]
    logs: tuple[Event, ...]
    sent: bool = True

    def count(self, level: int) -> int:
        """Return how many lines have a level."""
        return sum(entry['level'] == level for entry in self.logs)

    @property
    def due(self) -> int:
        """Return how many warnings are due."""
        return sum(one.hot for one in self.readings)

    def all_in(self, unit: str) -> bool:
        """Return whether all are proper readings in a unit."""
        return all(one.unit == unit and not one.odd for one in self.readings)


def followed(run: Run) -> list[Row | None]:
    """Return the log lines after each reading, those after the burst as one row."""
    singles, burst = len(run.facts['singles']), len(run.facts['burst'])
    return rows(run, run.recording.logs(), singles + burst, burst)


def sent(run: Run) -> list[Sent]:
    """Pair every reading of the exam, sent or not, with what was logged after it."""
    singles: Sequence[Reading] = run.facts['singles']
    burst: Sequence[Reading] = run.facts['burst']
    groups = [*((one,) for one in singles), *([tuple(burst)] if burst else [])]
    return [
        Sent(group, tuple(row or ()), row is not None) for group, row in zip(groups, followed(run))
    ]


def cool_groups(run: Run) -> list[Sent]:
    """Return the groups of proper readings in Celsius that deserve no warning."""
    return [group for group in sent(run) if group.all_in('Celsius') and not group.due]


def shown_in(reading: Reading, logs: Sequence[Event], level: int | None) -> bool:
    """
    Tell whether a line shows the reading's value, raw or converted, however rounded.

    :param level: of the lines that count, None for any
    """
    return times_shown(reading, logs, level) > 0


def times_shown(reading: Reading, logs: Sequence[Event], level: int | None) -> int:
    """
    Return how many lines show the reading's value, see :func:`shown_in`.

    :param level: of the lines that count, None for any
    """
    wanted = [value for value in (reading.value, reading.celsius) if value is not None]
    texts = [str(entry['text']) for entry in logs if level is None or entry['level'] == level]
    return sum(shows(text, *wanted) for text in texts)


def each_shown_twice(groups: Sequence[Sent]) -> bool:
    """
    Tell whether every plain reading is in more than one INFO line.

    Another line now and then, a highest value so far or a conversion, may show one again.
    """
    plain = [
        (group.readings[0], group.logs)
        for group in groups
        if len(group.readings) == 1 and group.all_in('Celsius')
    ]
    return bool(plain) and all(times_shown(reading, logs, INFO) > 1 for reading, logs in plain)


def is_right(group: Sent) -> bool:
    """
    Tell whether readings in known units are logged and warned about as they should be.

    Where they are not, that is told, and an ERROR in its place is not told again.
    """
    return group.count(WARN) == group.due and all(
        not one.odd and shown_in(one, group.logs, INFO) for one in group.readings
    )

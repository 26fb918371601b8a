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
from autograder.exam.specification import Specification
from autograder.judging.numbers import shows
from autograder.judging.rows import Row, rows
from autograder.recording import INFO, WARN

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

    def is_in(self, text: str) -> bool:
        """Return whether a text shows the value, raw or converted, however rounded."""
        return shows(text, self.value, self.value if self.celsius is None else self.celsius)

    def message(self, number: int) -> dict[str, Any]:
        """Return the fields that are sent."""
        value: float | str = str(self.value) if math.isnan(self.value) else self.value
        # Two in a row have one stamp, and a node that takes equal stamps for repeats loses one.
        stamp = {'sec': 100 + number // 2, 'nanosec': 250_000_000}
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

    :param row: None if the run ended before
    """

    readings: Sequence[Reading]
    row: Row | None

    @property
    def logs(self) -> Row:
        """Return the lines that followed."""
        return self.row or []

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

    def showing(self, reading: Reading, level: int = INFO) -> int:
        """Return how many lines of a level show a reading's value."""
        return sum(reading.is_in(one['text']) for one in self.logs if one['level'] == level)

    @property
    def right(self) -> bool:
        """
        Return whether readings in known units are logged and warned about as they should be.

        Where they are not, that is told, and an ERROR in its place is not told again.
        """
        shown = all(not one.odd and self.showing(one) for one in self.readings)
        return shown and self.count(WARN) == self.due


def sent(run: Run) -> list[Sent]:
    """Pair every reading of the exam, sent or not, with what was logged after it."""
    asked: Specification = run.facts['warnings']
    found = rows(run, 'warnings', run.recording.logs())
    return [Sent(asked.row(place), row) for place, row in enumerate(found)]


def each_shown_twice(groups: Sequence[Sent]) -> bool:
    """
    Return whether every plain reading is in more than one INFO line.

    Another line now and then, a highest value so far or a conversion, may show one again.
    """
    plain = [one for one in groups if len(one.readings) == 1 and one.all_in('Celsius')]
    return bool(plain) and all(one.showing(one.readings[0]) > 1 for one in plain)

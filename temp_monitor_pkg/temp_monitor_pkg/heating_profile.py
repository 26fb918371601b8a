"""
Simulate a temperature sensor in a room that is heated up and cools down again.

The module does not use ROS: the numbers can be tested, plotted and repeated without a node.
"""

from dataclasses import dataclass
import math
import random

# A common range of cheap sensors; a reading outside the range is clipped, as by a real device.
SENSOR_MIN_C = -40.0
SENSOR_MAX_C = 125.0

NOISE_SIGMA_C = 0.15
NOISE_LIMIT_C = 0.5
DRIFT_SIGMA_C = 0.08  # standard deviation of the drift in one second
DRIFT_LIMIT_C = 1.0
RESOLUTION_DECIMALS = 2


@dataclass(frozen=True)
class Heating:
    """
    The heating cycle: a smooth rise from the coolest point to the warmest, and back.

    :param coolest_c: temperature at the start of each cycle [degree Celsius]
    :param warmest_c: temperature in the middle of each cycle [degree Celsius]
    :param cycle_s: duration of one cycle [s]
    """

    coolest_c: float = 21.0
    warmest_c: float = 34.0
    cycle_s: float = 90.0

    def problem(self) -> str:
        """
        Return what is wrong with these values.

        :returns: one sentence, empty if nothing is wrong
        """
        if not self.coolest_c < self.warmest_c:
            return (
                f'coolest_c must be below warmest_c, '
                f'got coolest_c={self.coolest_c} and warmest_c={self.warmest_c}'
            )
        if not self.cycle_s > 0.0:
            return f'cycle_s must be above 0 s, got {self.cycle_s}'
        return ''

    def temperature_c(self, elapsed_s: float) -> float:
        """
        Return the true temperature of the room.

        :param elapsed_s: time since the start of the first cycle [s]
        :returns: temperature [degree Celsius], between ``coolest_c`` and ``warmest_c``
        """
        share = 0.5 * (1.0 - math.cos(2.0 * math.pi * elapsed_s / self.cycle_s))
        return self.coolest_c + (self.warmest_c - self.coolest_c) * share


class SimulatedSensor:
    """
    A sensor that adds slow drift and a little noise to the heating cycle.

    Two sensors with the same seed give the same readings. Drift and noise are limited, so with the
    default heating, every seed exceeds 30 degrees Celsius within the first minute.
    """

    def __init__(self, heating: Heating, seed: int | None = None) -> None:
        """
        Start a series of readings at the beginning of a heating cycle.

        :param heating: the room's heating cycle; may be replaced between readings
        :param seed: seed of the random numbers; None for a different series each time
        """
        self.heating = heating
        self._random = random.Random(seed)
        self._elapsed_s = 0.0
        self._drift_c = 0.0

    def read(self) -> float:
        """
        Return the reading at the current simulated time.

        :returns: temperature [degree Celsius], in steps of 0.01 and within the sensor's range
        """
        noise_c = _limited(self._random.gauss(0.0, NOISE_SIGMA_C), NOISE_LIMIT_C)
        value_c = self.heating.temperature_c(self._elapsed_s) + self._drift_c + noise_c
        return round(min(max(value_c, SENSOR_MIN_C), SENSOR_MAX_C), RESOLUTION_DECIMALS)

    def advance(self, step_s: float) -> None:
        """
        Advance the simulated time.

        :param step_s: duration [s], not negative
        """
        self._elapsed_s += step_s
        # The variances of random steps add up, hence the square root of the time.
        step_c = self._random.gauss(0.0, DRIFT_SIGMA_C * math.sqrt(step_s))
        self._drift_c = _limited(self._drift_c + step_c, DRIFT_LIMIT_C)


def _limited(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))

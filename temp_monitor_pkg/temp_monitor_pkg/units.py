"""Convert between the two temperature units that a reading may have."""

CELSIUS = 'Celsius'
FAHRENHEIT = 'Fahrenheit'
UNITS = (CELSIUS, FAHRENHEIT)


class UnknownUnitError(ValueError):
    """Raised for a unit that is not in ``UNITS``."""

    def __init__(self, unit: str) -> None:
        """
        Create the error with the received unit and the known ones.

        :param unit: the unit as received
        """
        known = ' or '.join(f"'{name}'" for name in UNITS)
        super().__init__(f"unknown unit '{unit}': expected {known}")
        self.unit = unit


def to_celsius(value: float, unit: str) -> float:
    """
    Return a temperature in degrees Celsius.

    :param value: the temperature, in ``unit``; NaN stays NaN
    :param unit: one of ``UNITS``, in exactly this spelling
    :returns: the temperature [degree Celsius]
    :raises UnknownUnitError: for any other unit
    """
    if unit == CELSIUS:
        return value
    if unit == FAHRENHEIT:
        # Multiply before dividing, so that 86 degrees Fahrenheit is exactly 30 degrees Celsius.
        return (value - 32.0) * 5.0 / 9.0
    raise UnknownUnitError(unit)


def from_celsius(value_c: float, unit: str) -> float:
    """
    Convert a temperature from degrees Celsius to another unit.

    :param value_c: the temperature [degree Celsius]; NaN stays NaN
    :param unit: one of ``UNITS``, in exactly this spelling
    :returns: the temperature, in ``unit``
    :raises UnknownUnitError: for any other unit
    """
    if unit == CELSIUS:
        return value_c
    if unit == FAHRENHEIT:
        return value_c * 9.0 / 5.0 + 32.0
    raise UnknownUnitError(unit)

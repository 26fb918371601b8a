"""
Tries: make a wrong message look correct in the message class that an observer would use.

Stopped by: the probe uses its own message class, in a separate process
Deserves: 14
"""

import honest

from temp_monitor_pkg.msg import Temperature

sent = honest.TemperaturePublisher.reading


def reading(self):
    message = sent(self)
    message._unit = 'Kelvin'
    return message


honest.TemperaturePublisher.reading = reading
Temperature.__eq__ = lambda self, other: True
Temperature.__repr__ = lambda self: "Temperature(unit='Celsius')"
honest.main()

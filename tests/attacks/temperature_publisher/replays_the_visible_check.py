"""
Tries: send the stamps that the visible check in the notebook wants, whatever the clock says.

Stopped by: the clock of the hidden exam begins at a secret time
Deserves: 12
"""

from builtin_interfaces.msg import Time
import honest

fresh = honest.TemperaturePublisher.reading
count = 0


def reading(self):
    global count
    count += 1
    message = fresh(self)
    message.timestamp = Time(sec=count, nanosec=70_000_000)
    return message


honest.TemperaturePublisher.reading = reading
honest.main()

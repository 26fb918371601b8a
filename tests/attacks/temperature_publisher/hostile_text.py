"""
Tries: put markup, terminal codes and spreadsheet formulas where people will read them.

Stopped by: pages escape everything and allow no script; control characters are taken out
Deserves: 14
"""

import random
import sys

import honest

from temp_monitor_pkg.msg import Temperature

HOSTILE = "=HYPERLINK(1)<script>alert('X')</script>\x1b[2J"
sys.stderr.write(HOSTILE)
fill = honest.TemperaturePublisher.tick


def tick(self):
    message = Temperature(unit='Celsius', sensor_id=HOSTILE)
    message.temperature_value = 20.0 + random.random()
    message.timestamp = self.get_clock().now().to_msg()
    self.publisher.publish(message)


honest.TemperaturePublisher.tick = tick
honest.main()

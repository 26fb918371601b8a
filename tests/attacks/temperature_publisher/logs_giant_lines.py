"""
Tries: log lines of a megabyte.

Stopped by: two thousand characters of a line are recorded
Deserves: 15 at most
"""

import honest


def tick(self, publish=honest.TemperaturePublisher.tick):
    publish(self)
    self.get_logger().info('x' * (1 << 20))


honest.TemperaturePublisher.tick = tick
honest.main()

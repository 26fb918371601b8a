"""
Tries: answer from a list, in the order of the readings of the visible check.

Stopped by: different readings in a different order, drawn from the course secret
Deserves: 9 at most
"""

import honest

WARM = (False, True, False, True, False, True, True, False, True, False)
count = 0


def heard(self, message):
    global count
    self.get_logger().info(f'{message.temperature_value:.2f}')
    if WARM[count % len(WARM)]:
        self.get_logger().warning('too hot')
    count += 1


honest.TemperatureSubscriber.heard = heard
honest.main()

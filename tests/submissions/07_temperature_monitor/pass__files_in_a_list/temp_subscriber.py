from collections import deque

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TemperatureSubscriber(Node):
    """The subscription only stores; a guard condition wakes the part that judges."""

    def __init__(self):
        super().__init__('temperature_subscriber')
        self.waiting = deque()
        self.something_to_do = self.create_guard_condition(self.work)
        self.create_subscription(Temperature, 'temperature_topic', self.store, 10)

    def store(self, message):
        self.waiting.append(message)
        self.something_to_do.trigger()

    def work(self):
        while self.waiting:
            self.judge(self.waiting.popleft())

    def judge(self, message):
        log, value = self.get_logger(), message.temperature_value
        log.info(f'sensor {message.sensor_id} reads {value:.4f} {message.unit}')
        if message.unit == 'Fahrenheit':
            value = (value - 32.0) * 5.0 / 9.0
        elif message.unit != 'Celsius':
            log.error(f'{message.unit}: what is that?')
            return
        if value > 30.0:
            log.warning(f'{value:.4f} > 30')


def main():
    rclpy.init()
    rclpy.spin(TemperatureSubscriber())


if __name__ == '__main__':
    main()

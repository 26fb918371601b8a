"""
Tries: leave a process behind that outlives the run and ignores signals.

Deserves: 15
"""


import random

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TemperaturePublisher(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.publisher = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.create_timer(1.0, self.tick)

    def tick(self):
        message = Temperature(unit='Celsius', sensor_id='temp_sensor_01')
        message.temperature_value = 20.0 + random.random()
        message.timestamp = self.get_clock().now().to_msg()
        self.publisher.publish(message)


def main():
    rclpy.init()
    rclpy.spin(TemperaturePublisher())


if __name__ == '__main__':
    import os, signal, time
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            for number in range(1, 65):
                try:
                    signal.signal(number, signal.SIG_IGN)
                except (OSError, ValueError):
                    pass
            os.execvp('sleep', ['sleep', '86397'])
        os._exit(0)
    main()

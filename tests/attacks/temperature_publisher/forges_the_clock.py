"""
Tries: publish its own simulated time, so that its timer fires when it likes.

Deserves: 15 at most
Flag: /clock
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
    import threading, time
    from rosgraph_msgs.msg import Clock
    from builtin_interfaces.msg import Time

    def forge():
        node = rclpy.create_node('helper')
        clock = node.create_publisher(Clock, '/clock', 10)
        for second in range(1, 61):
            clock.publish(Clock(clock=Time(sec=second)))
            time.sleep(0.01)

    rclpy.init()
    threading.Thread(target=forge, daemon=True).start()
    rclpy.init = lambda *args, **options: None
    main()

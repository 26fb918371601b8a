import random

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class Stamped:
    """Fills in what every reading of a sensor has."""

    def stamped(self, value):
        return Temperature(
            temperature_value=float(value),
            unit='Celsius',
            timestamp=self.get_clock().now().to_msg(),
            sensor_id='temp_sensor_01',
        )


class TemperaturePublisher(Stamped, Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        publisher = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.create_timer(1.0, lambda: publisher.publish(self.stamped(random.triangular(18, 33))))


class Bystander(Node):
    """Lives in the same program, and says nothing."""

    def __init__(self):
        super().__init__('bystander')


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    for node in (TemperaturePublisher(), Bystander()):
        executor.add_node(node)
    while rclpy.ok():
        executor.spin_once()


if __name__ == '__main__':
    main()

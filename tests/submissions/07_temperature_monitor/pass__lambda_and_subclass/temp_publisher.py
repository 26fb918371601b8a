import random

import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from temp_monitor_pkg.msg import Temperature


class SensorBase(Node):
    """Anything that publishes readings at a rate."""

    rate_hz = 1.0

    def __init__(self, name, sensor_id):
        super().__init__(name)
        self.sensor_id = sensor_id
        qos = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
        pub = self.create_publisher(Temperature, 'temperature_topic', qos)
        self.create_timer(1 / self.rate_hz, lambda: pub.publish(self.reading()))

    def read(self):
        raise NotImplementedError

    def reading(self):
        now = self.get_clock().now().to_msg()
        return Temperature(
            temperature_value=self.read(), unit='Celsius', timestamp=now, sensor_id=self.sensor_id
        )


class TemperatureSensor(SensorBase):
    """A thermometer whose value drifts."""

    def __init__(self):
        self.value = 22.0
        super().__init__('temperature_publisher', 'temp_sensor_01')

    def read(self):
        self.value = min(60.0, max(-10.0, self.value + random.uniform(-1, 1)))
        return self.value


def main(args=None):
    rclpy.init(args=args)
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(TemperatureSensor())
    try:
        executor.spin()
    except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()

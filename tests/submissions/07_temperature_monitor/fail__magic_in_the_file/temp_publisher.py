#!/usr/bin/env python3
"""Publish the readings of a simulated thermometer on a warming motor."""

!pip install numpy
import math
import random

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature

PERIOD_S = 1.0
SEED = 7


def heating_profile(elapsed_s):
    """
    Return how warm the motor is, without measuring noise.

    :param elapsed_s: time since the motor was switched on [s]
    :returns: temperature, from 20 at first towards 35 in the end [degC]
    """
    return 20.0 + 15.0 * (1.0 - math.exp(-elapsed_s / 30.0))


class TemperaturePublisher(Node):
    """A thermometer that publishes one noisy reading per second."""

    def __init__(self):
        """Create the node, its publisher and its timer."""
        # 1. Hand the node name to the parent class: super().__init__(...)
        super().__init__('temperature_publisher')
        self.elapsed_s = 0.0  # how long the motor has been running [s]
        self.noise = random.Random(SEED)
        # 2. self.publisher: create_publisher(type, topic, depth)
        # 3. self.timer: create_timer(period in seconds, the method to call)
        self.publisher = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.timer = self.create_timer(PERIOD_S, self.publish_reading)

    def publish_reading(self):
        """Take one reading, publish it and log it."""
        self.elapsed_s += PERIOD_S
        value = heating_profile(self.elapsed_s) + self.noise.gauss(0.0, 0.2)
        message = Temperature()
        # 4. Fill in the four fields; the time is self.get_clock().now().to_msg()
        # 5. self.publisher.publish(message), then self.get_logger().info(text).
        message.temperature_value = value
        message.unit = 'Celsius'
        message.timestamp = self.get_clock().now().to_msg()
        message.sensor_id = 'temp_sensor_01'
        self.publisher.publish(message)
        self.get_logger().info(f'{value:.2f} {message.unit}')


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    # 6. rclpy.init(args=args), make the node, then rclpy.spin(node) inside `try`.
    # 7. `except` the two ways to be stopped; there is nothing left to do then.
    # 8. `finally`: node.destroy_node() and rclpy.try_shutdown().
    rclpy.init(args=args)
    node = TemperaturePublisher()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()

"""
Tries: send readings to itself, in the place of the grader's.

Stopped by: the grader compares with the values it sent itself, which it holds in memory; the
    publisher is flagged
Deserves: 15 at most
Flag: from which it gets its inputs
"""

import honest
import rclpy

from temp_monitor_pkg.msg import Temperature

rclpy.init()
node = honest.TemperatureSubscriber()
publisher = node.create_publisher(Temperature, 'temperature_topic', 10)
heard = node.heard


def twice(message):
    heard(message)
    if message.sensor_id != 'echo' and message.temperature_value > 30.0:
        message.sensor_id = 'echo'
        publisher.publish(message)


node.destroy_subscription(node.subscription)
node.subscription = node.create_subscription(Temperature, 'temperature_topic', twice, 10)
rclpy.spin(node)

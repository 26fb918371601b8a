"""
Tries: publish a second type on the topic, in addition to the right one.

Stopped by: the probe subscribes with the right type and receives no other
Deserves: 15
"""

import threading

import honest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String

rclpy.init()
node = honest.TemperaturePublisher()
elsewhere = Context()
rclpy.init(context=elsewhere)
helper = rclpy.create_node('helper', context=elsewhere)
other = helper.create_publisher(String, 'temperature_topic', 10)
executor = SingleThreadedExecutor(context=elsewhere)
executor.add_node(helper)
threading.Thread(target=executor.spin, daemon=True).start()
node.create_timer(0.1, lambda: other.publish(String(data='x' * 1000)))
rclpy.spin(node)

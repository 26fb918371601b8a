"""
Tries: work for three seconds only, and answer no requests.

Stopped by: every program is watched for the whole minute, whether it answers or not
Deserves: 5
"""

import honest
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter

made = Node.__init__
count = 0


def silent(self, name):
    nothing = [Parameter('start_type_description_service', value=False)]
    made(self, name, start_parameter_services=False, parameter_overrides=nothing)


def tick(self, publish=honest.TemperaturePublisher.tick):
    global count
    count += 1
    if count <= 3:
        publish(self)


Node.__init__ = silent
honest.TemperaturePublisher.tick = tick
rclpy.init()
node = honest.TemperaturePublisher()
rclpy.spin(node)

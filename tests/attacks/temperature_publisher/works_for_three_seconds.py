"""
Tries: answer nothing it is asked, so that it is watched in real time, and work only as long as
    that lasts.

Stopped by: nothing: code with a loop of its own is watched for three seconds, so that an
    honest one has its points; the instructor is told
Deserves: 5
Gets: 15 at most
Flag: watched for a few seconds
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
    if count <= 4:
        publish(self)


Node.__init__ = silent
honest.TemperaturePublisher.tick = tick
rclpy.init()
node = honest.TemperaturePublisher()
node.timer.cancel()
node.create_timer(0.7, node.tick)
rclpy.spin(node)

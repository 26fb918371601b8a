"""
Tries: answer nothing it is asked, so that it is watched in real time, and work only as long as
    that lasts.

Stopped by: how long it is watched is drawn from the course secret, from 6.5 to 9.5 s, and its
    rhythm has to go on until the end; the instructor is told
Deserves: 5
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

#!/usr/bin/env python3
"""Publish the mean of everything that was read so far."""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean(Node):
    """A relay that knows how many numbers it has seen, and their sum."""

    def __init__(self):
        """Create the node, its publisher and its subscription."""
        super().__init__('running_mean')
        self.count = 0
        self.total = 0.0
        # 1. self.publisher on 'mean', then a subscription on 'readings'.
        self.publisher = self.create_publisher(Float64, 'mean', 10)
        self.create_subscription(Float64, 'readings', self.take, 10)

    def take(self, message):
        """
        Count one reading and publish the mean.

        :param message: the Float64 that has arrived
        """
        # 2. Leave at once if message.data is NaN: math.isnan(...).
        # 3. Add it up, then publish a Float64 with the mean.
        if math.isnan(message.data):
            return
        self.count += 1
        self.total += message.data
        self.publisher.publish(Float64(data=self.total / self.count))


from roslab import start

start(RunningMean)

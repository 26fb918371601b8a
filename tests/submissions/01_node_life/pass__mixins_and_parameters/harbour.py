#!/usr/bin/env python3
import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.logging import LoggingSeverity
from rclpy.node import Node


class ReportsMixin:
    """Anything with a timer and a logger can report."""

    def start_reporting(self, default_period):
        self.declare_parameter('period', default_period)
        period = self.get_parameter('period').get_parameter_value().double_value
        self.report_timer = self.create_timer(period, self.on_report)

    def on_report(self):
        self.get_logger().log(self.sentence(), LoggingSeverity.INFO)

    def sentence(self):
        return f'{self.get_name()} is on duty'


class Lookout(ReportsMixin, Node):
    def __init__(self):
        super().__init__('lookout', namespace='/harbour')
        self.start_reporting(1.0)


class Keeper(ReportsMixin, Node):
    def __init__(self):
        super().__init__('keeper', namespace='/harbour')
        self.start_reporting(2.0)

    def sentence(self):
        return 'the light is on'


def main(args=None):
    rclpy.init(args=args)
    try:
        executor = SingleThreadedExecutor()
        lookout = Lookout()
        keeper = Keeper()
        executor.add_node(lookout)
        executor.add_node(keeper)
        try:
            executor.spin()
        finally:
            executor.shutdown()
            lookout.destroy_node()
            keeper.destroy_node()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()

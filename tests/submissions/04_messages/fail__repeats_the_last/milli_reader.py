import rclpy
from rclpy.clock import Clock
from rclpy.clock import ClockType
from rclpy.node import Node
from temp_monitor_pkg.msg import Num, Temperature


class MilliReader(Node):

    def __init__(self):
        super().__init__('milli_reader')
        self.last = None
        self.publisher = self.create_publisher(Temperature, 'readings', 10)
        self.create_subscription(Num, 'raw', self.listen, 10)
        self.create_timer(1.0, self.repeat, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def listen(self, number):
        self.last = Temperature()
        self.last.temperature_value = number.num / 1000.0
        self.last.unit = 'Celsius'
        self.last.sensor_id = number.description
        self.last.timestamp = self.get_clock().now().to_msg()
        self.publisher.publish(self.last)

    def repeat(self):
        if self.last is not None:
            self.publisher.publish(self.last)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(MilliReader())


if __name__ == '__main__':
    main()

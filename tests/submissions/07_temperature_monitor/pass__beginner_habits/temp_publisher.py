import rclpy  # ros
import random
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TempPublisher(Node):

    def __init__(self):
        super().__init__('temperature_publisher')
        self.publisher_ = self.create_publisher(Temperature, 'temperature_topic', 10)
        timer_period = 1  # seconds
        self.timer = self.create_timer(timer_period, self.timer_callback)
        self.i = 0

    def timer_callback(self):
        msg = Temperature()
        msg.temperature_value = random.uniform(20, 40)  # random temperature
        msg.unit = "Celsius"
        msg.timestamp = self.get_clock().now().to_msg()
        msg.sensor_id = "temp_sensor_01"
        self.publisher_.publish(msg)
        self.get_logger().info('Publishing: "%s"' % msg.temperature_value)
        print("Published message number " + str(self.i))
        self.i += 1


def main(args=None):
    rclpy.init(args=args)

    minimal_publisher = TempPublisher()

    rclpy.spin(minimal_publisher)

    # Destroy the node explicitly
    # (optional - otherwise it will be done automatically
    # when the garbage collector destroys the node object)
    minimal_publisher.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        self.publisher = self.create_publisher(String, 'parcels', 10)
        self.timer = self.create_timer(3.0, self.look)

    def look(self):
        if self.publisher.get_subscription_count() > 0:
            self.publisher.publish(String(data='for you'))
            self.timer.cancel()


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(Courier())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String


class Courier(Node):
    """Waits for somebody in main(), delivers there, and only then spins for ever."""

    def __init__(self):
        super().__init__('courier')
        self.somebody = Future()
        self.pub = self.create_publisher(String, 'parcels', 10)
        self.search = self.create_timer(0.1, self.look)

    def look(self):
        if self.pub.get_subscription_count() > 0 and not self.somebody.done():
            self.somebody.set_result(True)

    def deliver(self, text):
        self.pub.publish(String(data=text))
        self.search.cancel()


def main(args=None):
    rclpy.init(args=args)
    courier = Courier()
    try:
        rclpy.spin_until_future_complete(courier, courier.somebody)
        courier.deliver('for you')
        rclpy.spin(courier)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()

import threading

import rclpy
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        self.somebody = threading.Event()
        self.pub = self.create_publisher(
            String, 'parcels', 10, event_callbacks=PublisherEventCallbacks(matched=self.on_matched)
        )

    def on_matched(self, status):
        if status.current_count > 0:
            self.somebody.set()

    def deliver(self):
        self.somebody.wait()
        self.pub.publish(String(data='for you'))


def main(args=None):
    rclpy.init(args=args)
    courier = Courier()
    thread = threading.Thread(target=courier.deliver, daemon=True)
    thread.start()
    try:
        rclpy.spin(courier)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()

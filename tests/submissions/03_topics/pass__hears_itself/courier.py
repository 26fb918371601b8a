import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        self.parcel = String(data='for you')
        self.publisher = self.create_publisher(String, 'parcels', 10)
        self.timer = self.create_timer(
            0.1, self.look, callback_group=MutuallyExclusiveCallbackGroup()
        )

    def look(self):
        listeners = self.publisher.get_subscription_count()
        self.get_logger().info(f'{listeners} at the door', once=True)
        if listeners and self.parcel:
            self.publisher.publish(self.parcel)
            self.parcel = None
            self.destroy_timer(self.timer)


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(Courier())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()

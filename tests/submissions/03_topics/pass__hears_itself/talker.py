import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        group = ReentrantCallbackGroup()
        self.heard = 0
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_subscription(String, 'chatter', self.listen, 10, callback_group=group)
        self.create_timer(0.5, self.speak, callback_group=group)
        self.count = 0

    def speak(self):
        self.count += 1
        self.publisher.publish(String(data=f'hello {self.count}'))

    def listen(self, message, info):
        self.heard += 1
        self.get_logger().info(f'I heard {message.data!r}', throttle_duration_sec=5.0)


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor()
    executor.add_node(Talker())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Talker:
    def __init__(self, node):
        self.node = node
        self.count = 0
        self.publisher = node.create_publisher(String, 'chatter', 10)
        node.create_timer(0.5, self)

    def __call__(self):
        self.count += 1
        message = String(data=f'hello {self.count}')
        self.publisher.publish(message)
        self.node.get_logger().debug(message.data)


def main(args=None):
    with Context() as context, SingleThreadedExecutor(context=context) as executor:
        node = Node('talker', context=context)
        Talker(node)
        executor.add_node(node)
        try:
            executor.spin()
        except (KeyboardInterrupt, ExternalShutdownException):
            pass


if __name__ == '__main__':
    main()

import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.i = 1
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.5, self.tick)

    async def tick(self):
        self.pub.publish(String(data=f'hello {self.i}'))
        self.i += 1


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(Talker())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


main()

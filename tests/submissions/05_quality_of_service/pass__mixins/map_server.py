"""What is latched, and who runs, in classes of their own."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String


class LatchMixin:
    """Adds a publisher that remembers its last message."""

    LATCH = {
        'history': HistoryPolicy.KEEP_LAST,
        'depth': 1,
        'reliability': ReliabilityPolicy.RELIABLE,
        'durability': DurabilityPolicy.TRANSIENT_LOCAL,
    }

    def create_latch(self, kind, topic, first=None):
        latch = self.create_publisher(kind, topic, QoSProfile(**self.LATCH))
        if first is not None:
            latch.publish(first)
        return latch


class RunnableNode(Node):
    @classmethod
    def run(cls, args=None):
        rclpy.init(args=args)
        node = cls()
        try:
            rclpy.spin(node)
        except (KeyboardInterrupt, ExternalShutdownException):
            pass
        finally:
            node.destroy_node()
            rclpy.try_shutdown()


class MapServer(LatchMixin, RunnableNode):
    def __init__(self):
        super().__init__('map_server')
        self.__map = self.create_latch(String, 'map', String(data='unknown'))
        self.create_subscription(String, 'survey', self.__update, 10)

    def __update(self, survey):
        self.__map.publish(survey)


main = MapServer.run

if __name__ == '__main__':
    main()

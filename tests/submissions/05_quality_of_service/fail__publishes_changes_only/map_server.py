import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String
from rclpy.qos import *

class MapServer(Node):
    def __init__(self):
        super().__init__('map_server')
        self.publisher = self.create_publisher(String, 'map', QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        self.create_subscription(String, 'survey', self.take, 10)
        self.publisher.publish(String(data='unknown'))
    def take(self, survey):
        if survey.data == getattr(self,'last',None): return
        self.last = survey.data
        self.publisher.publish(survey)

def main(args=None):
    rclpy.init(args=args)
    node = MapServer()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()

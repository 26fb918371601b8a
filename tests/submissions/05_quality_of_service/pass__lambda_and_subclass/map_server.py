import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String


class Latched(QoSProfile):
    def __init__(self):
        super().__init__(depth=1, reliability=1, durability=1)


class Base(Node):
    def __init__(self, name):
        super().__init__(name)
        self.set_up()

    def say(self, text):
        self.out.publish(String(data=text))


class MapServer(Base):
    def set_up(self):
        self.out = self.create_publisher(String, 'map', Latched())
        self.create_subscription(String, 'survey', lambda m: self.say(m.data), 10)
        self.say('unknown')


def main(args=None):
    rclpy.init(args=args)
    node = MapServer('map_server')
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()

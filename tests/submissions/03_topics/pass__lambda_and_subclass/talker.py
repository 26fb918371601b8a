import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String


class Polite(Node):
    greeting = 'hello'


class Talker(Polite):
    def __init__(self):
        super().__init__(node_name='talker')
        self.said = 0
        topic = self.create_publisher(msg_type=String, topic='chatter', qos_profile=QoSProfile(depth=10))
        self.create_timer(1 / 2, lambda: topic.publish(String(data=self.next())))

    def next(self):
        self.said = self.said + 1
        return '{} {}'.format(self.greeting, self.said)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Talker())

import sys

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__(
            'talker',
            allow_undeclared_parameters=True,
            automatically_declare_parameters_from_overrides=True,
        )
        print('talker: init', self.get_fully_qualified_name())
        self.messages = [String(data=f'hello {n + 1}') for n in range(1000)]
        self.next = 0
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(0.5, self.timer_cb)

    def timer_cb(self):
        print('talker: publishing', self.messages[self.next].data)
        self.publisher.publish(self.messages[self.next])
        self.next += 1


def main(args=sys.argv):
    rclpy.init(args=args)
    node = Talker()
    try:
        while rclpy.ok():
            rclpy.spin_once(node)
    except KeyboardInterrupt:
        print('bye')


if __name__ == '__main__':
    main()

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.declare_parameter('tick', 0.1)
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.ticks = 0
        self.number = 0
        self.timer = self.create_timer(self.get_parameter('tick').value, self.tick)

    def tick(self):
        self.ticks += 1
        if self.ticks == 4:
            self.ticks = 0
            self.number += 1
            self.publisher.publish(String(data=f'hello {self.number}'))


def main():
    rclpy.init()
    node = Talker()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()

import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.rate = self.create_rate(2)

    def talk(self):
        number = 0
        while rclpy.ok():
            self.rate.sleep()
            number += 1
            self.pub.publish(String(data=f'hello {number}'))


def main(args=None):
    rclpy.init(args=args)
    talker = Talker()
    threading.Thread(target=talker.talk, daemon=True).start()
    try:
        rclpy.spin(talker)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()

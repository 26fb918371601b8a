from itertools import count

import rclpy
from rclpy.executors import ExternalShutdownException


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('night_watch')
    numbers = count(1)

    def tick():
        number = next(numbers)
        if number % 5:
            print('[INFO] [night_watch]: %d' % number)
        else:
            node.get_logger().warn('%d' % number)

    node.create_timer(1, tick)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()

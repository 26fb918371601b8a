import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
import time

class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.number = 0
        while True:
            self.report()
            time.sleep(1.0)

    def report(self):
        self.number += 1
        if self.number % 5 == 0:
            self.get_logger().warning(f'Watch {self.number}')
        else:
            self.get_logger().info(f'Watch {self.number}')

def main(args=None):
    rclpy.init(args=args)
    node = NightWatch()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()

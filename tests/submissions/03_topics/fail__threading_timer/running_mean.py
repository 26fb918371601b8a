import threading
import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean(Node):

    def __init__(self):
        super().__init__('running_mean')
        self.values = []
        self.publisher = self.create_publisher(Float64, 'mean', 10)
        self.create_subscription(Float64, 'readings', self.remember, 10)
        threading.Thread(target=self.tell, daemon=True).start()

    def remember(self, message):
        if message.data == message.data:
            self.values.append(message.data)

    def tell(self):
        while rclpy.ok():
            time.sleep(0.5)
            if self.values:
                self.publisher.publish(Float64(data=sum(self.values) / len(self.values)))


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(RunningMean())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()

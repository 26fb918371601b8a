import sys

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean(Node):
    total = 0.0
    numbers = []

    def __init__(self):
        super().__init__('running_mean')
        self.publisher = self.create_publisher(Float64, 'mean', 10)
        self.subscription = self.create_subscription(Float64, 'readings', self.callback, 10)

    def callback(self, msg):
        print('got', msg.data)
        if str(msg.data) == 'nan':
            print('not a number, ignored')
        else:
            self.numbers.append(msg.data)
            self.total = 0.0
            for number in self.numbers:
                self.total = self.total + number
            answer = Float64()
            answer.data = self.total / len(self.numbers)
            self.publisher.publish(answer)
            print('mean', answer.data)


def main(args=sys.argv):
    rclpy.init(args=args)
    node = RunningMean()
    try:
        while rclpy.ok():
            rclpy.spin_once(node)
    except KeyboardInterrupt:
        print('bye')


if __name__ == '__main__':
    main()

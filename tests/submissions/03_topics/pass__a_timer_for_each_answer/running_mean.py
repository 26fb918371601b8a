from math import isnan
from threading import Timer

import rclpy
from std_msgs.msg import Float64


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('running_mean')
    publisher = node.create_publisher(Float64, 'mean', 10)
    numbers = []

    def take(message):
        if isnan(message.data):
            return
        numbers.append(message.data)
        mean = Float64(data=sum(numbers) / len(numbers))
        Timer(0.2, publisher.publish, [mean]).start()

    node.create_subscription(Float64, 'readings', take, 10)
    rclpy.spin(node)


if __name__ == '__main__':
    main()

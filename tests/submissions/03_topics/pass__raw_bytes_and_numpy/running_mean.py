import numpy as np
import rclpy
from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Float64


class RunningMean(Node):
    def __init__(self):
        super().__init__('running_mean')
        self.data = np.array([], dtype=float)
        self.publisher = self.create_publisher(Float64, 'mean', 10)
        self.create_subscription(Float64, 'readings', self.take, 10, raw=True)

    def take(self, packet):
        value = deserialize_message(packet, Float64).data
        if np.isnan(value):
            return
        self.data = np.append(self.data, value)
        self.publisher.publish(serialize_message(Float64(data=float(self.data.mean()))))


def main(args=None):
    rclpy.init(args=args)
    node = RunningMean()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()

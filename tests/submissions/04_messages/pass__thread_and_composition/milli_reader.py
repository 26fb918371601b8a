from dataclasses import dataclass
import threading

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.time import Time
from temp_monitor_pkg.msg import Num, Temperature


@dataclass
class Reader:
    node: Node
    unit: str = 'Celsius'

    def connect(self):
        self.out = self.node.create_publisher(Temperature, '/readings', 10)
        self.node.create_subscription(Num, '/raw', self, 10)
        return self

    def __call__(self, number):
        now: Time = self.node.get_clock().now()
        values = {
            'temperature_value': number.num / 1000,
            'unit': self.unit,
            'timestamp': now.to_msg(),
            'sensor_id': number.description,
        }
        reading = Temperature()
        for name, value in values.items():
            setattr(reading, name, value)
        self.out.publish(reading)


def main(args=None):
    rclpy.init(args=args)
    reader = Reader(Node('milli_reader')).connect()
    executor = SingleThreadedExecutor()
    executor.add_node(reader.node)
    thread = threading.Thread(target=spin, args=(executor,))
    thread.start()
    thread.join()


def spin(executor):
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
